"""Measured surfaces: reading, missing points, interpolation, the bundled sample, refusals."""

import dataclasses
import importlib.util
import pickle
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.plugin import Grid, HasNativeGrid, SceneError
from eigencontact_plugins.geometries.repair import fitted_plane, harmonic_fill
from eigencontact_plugins.geometries.topography import Topography

DX, DY = 0.5e-6, 0.8e-6
HEIGHTS = 1e-8 * np.random.default_rng(7).standard_normal((6, 9))
SEPARATION = HEIGHTS.max() - HEIGHTS


METRES = {"height_unit": 1.0, "lateral_unit": 1.0}


def xyz_rows(heights=HEIGHTS, dx=DX, dy=DY, origin=(3e-3, -1e-3)):
    iy, ix = np.indices(heights.shape)
    return np.column_stack([origin[0] + ix.ravel() * dx, origin[1] + iy.ravel() * dy, heights.ravel()])


def save_npy(path):
    np.save(path, HEIGHTS)
    return {"spacing": (DX, DY), "height_unit": 1.0}


def save_npz(path):
    np.savez(path, heights=HEIGHTS, dx=DX, dy=DY, note="made up")
    return {}


def save_npz_unnamed(path):
    np.savez(path, scan=HEIGHTS)
    return {"spacing": (DX, DY), "height_unit": 1.0}


def save_xyz(path):
    np.savetxt(path, xyz_rows(), fmt="%.12g", header="x y z")
    return METRES


def save_shuffled(path):
    rows = np.random.default_rng(3).permutation(xyz_rows())
    np.savetxt(path, rows, fmt="%.12g", header="x [m], y [m], z [m]", comments="")
    return {}


def save_commas(path):
    np.savetxt(path, np.random.default_rng(3).permutation(xyz_rows()), fmt="%.12g", delimiter=", ", header="units: m")
    return {}


def save_semicolons_in_micrometres(path):
    np.savetxt(path, 1e6 * xyz_rows(), fmt="%.12g", delimiter=";")
    return {"height_unit": 1e-6, "lateral_unit": 1e-6}


def save_gwyddion(path):
    head = f"# Channel: Topography\n# Width: {9e6 * DX:g} µm\n# Height: {6e6 * DY:g} µm\n# Value units: m\n"
    rows = "\n".join("\t".join(f"{h:.12g}" for h in row) for row in HEIGHTS)
    path.write_text(head + rows + "\n", encoding="utf-8")
    return {}


def save_spreadsheet(path):
    """Decimal commas between semicolons, and a byte-order mark: as spreadsheets of half Europe write."""
    head = "Probe;A 17\nSpacing x;0,5 um\nSpacing y;0,8 um\nHeight unit;nm\n"
    rows = "\n".join(";".join(f"{1e9 * h:.9f}".replace(".", ",") for h in row) + ";" for row in HEIGHTS)
    path.write_text(head + rows + "\n", encoding="utf-8-sig")
    return {}


def save_instrument(path):
    head = '"Date","2026-11-23"\n"XY calibration","500.0","nm"\n"y step","0.8","um"\n"Unit","µm"\n\n"Height"\n'
    rows = "\n".join(",".join(f'"{1e6 * h:.12f}"' for h in row) for row in HEIGHTS)
    path.write_text(head + rows + "\n", encoding="latin-1")
    return {}


def save_blanks(path):
    np.savetxt(path, 1e6 * HEIGHTS, fmt="%.12f", header="units = um\nsize = 4.5 x 4.8")
    return {}


def save_bare_matrix(path):
    np.savetxt(path, 1e9 * HEIGHTS, fmt="%.9f", delimiter="\t")
    return {"spacing": (DX, DY), "height_unit": 1e-9}


def save_coordinates_of_unknown_unit(path):
    np.savetxt(path, 1e6 * xyz_rows(), fmt="%.12g")
    return {"spacing": (DX, DY), "height_unit": 1e-6}


FORMATS = [
    ("s.npy", save_npy),
    ("s.npz", save_npz),
    ("s2.npz", save_npz_unnamed),
    ("s.xyz", save_xyz),
    ("s.txt", save_shuffled),
    ("s.csv", save_commas),
    ("s.dat", save_semicolons_in_micrometres),
    ("gwyddion.txt", save_gwyddion),
    ("spreadsheet.csv", save_spreadsheet),
    ("instrument.csv", save_instrument),
    ("blanks.asc", save_blanks),
    ("matrix.tsv", save_bare_matrix),
    ("unknown.xyz", save_coordinates_of_unknown_unit),
]


def measured(tmp_path, heights, **table):
    np.savez(tmp_path / "m.npz", heights=heights, dx=DX, dy=DY)
    return Topography(file=str(tmp_path / "m.npz"), **table)


def on_native_grid(topography):
    y, x = topography.native_grid().axes()
    return topography.separation(x, y)


# reading ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "save"), FORMATS, ids=[name for name, _ in FORMATS])
def test_every_format_gives_the_same_surface(tmp_path, name, save):
    table = save(tmp_path / name)
    topography = Topography(file=str(tmp_path / name), **table)
    grid = topography.native_grid()
    assert (grid.nx, grid.ny, grid.center) == (9, 6, (0.0, 0.0))
    assert (grid.dx, grid.dy) == close((DX, DY), rel=1e-6)
    assert on_native_grid(topography) == close(SEPARATION, rel=1e-9, abs=1e-19)
    assert on_native_grid(topography).min() == 0.0


def test_it_offers_a_native_grid_around_its_centre(tmp_path):
    topography = measured(tmp_path, HEIGHTS, center=(1e-5, -2e-5))
    assert isinstance(topography, HasNativeGrid)
    assert topography.native_grid() == Grid(nx=9, ny=6, dx=DX, dy=DY, center=(1e-5, -2e-5))
    assert np.array_equal(on_native_grid(topography), SEPARATION)


def test_the_archive_may_give_one_spacing_for_both(tmp_path):
    np.savez(tmp_path / "m.npz", heights=HEIGHTS, dx=np.array([DX]))
    grid = Topography(file=str(tmp_path / "m.npz")).native_grid()
    assert (grid.dx, grid.dy) == (DX, DX)


def test_coordinates_rounded_in_the_file_are_still_a_raster(tmp_path):
    rows = xyz_rows(np.zeros((3, 1200)) + np.arange(1200.0), dx=1 / 3, dy=1 / 3, origin=(0, 0))
    np.savetxt(tmp_path / "m.xyz", rows, fmt="%.3f")
    grid = Topography(file=str(tmp_path / "m.xyz"), **METRES).native_grid()
    assert (grid.nx, grid.ny) == (1200, 3)
    assert grid.dx == close(1 / 3, rel=1e-5)


@pytest.mark.parametrize("axis", [0, 1])
def test_an_absent_line_of_the_raster_is_missing_points(tmp_path, axis):
    rows = xyz_rows()
    levels = np.unique(rows[:, axis])
    np.savetxt(tmp_path / "m.xyz", rows[rows[:, axis] != levels[2]], fmt="%.12g")
    topography = Topography(file=str(tmp_path / "m.xyz"), missing="far", **METRES)
    found = on_native_grid(topography)
    absent = np.zeros(HEIGHTS.shape, dtype=bool)
    absent[(slice(None), 2) if axis == 0 else 2] = True
    assert np.array_equal(found > 1e-6, absent)


def test_the_file_is_read_once_at_construction(tmp_path):
    topography = measured(tmp_path, HEIGHTS)
    (tmp_path / "m.npz").unlink()
    assert np.array_equal(on_native_grid(topography), SEPARATION)


def test_it_stays_a_plain_frozen_dataclass(tmp_path):
    topography = measured(tmp_path, HEIGHTS)
    assert set(dataclasses.asdict(topography)) == {field.name for field in dataclasses.fields(Topography)}
    assert topography == measured(tmp_path, HEIGHTS)
    assert hash(topography) == hash(measured(tmp_path, HEIGHTS))
    assert np.array_equal(on_native_grid(pickle.loads(pickle.dumps(topography))), SEPARATION)
    with pytest.raises(dataclasses.FrozenInstanceError):
        topography.file = "other"


def test_height_unit_and_invert(tmp_path):
    assert on_native_grid(measured(tmp_path, HEIGHTS * 1e9, height_unit=1e-9)) == close(SEPARATION, abs=1e-22)
    assert np.array_equal(on_native_grid(measured(tmp_path, HEIGHTS, invert=True)), HEIGHTS - HEIGHTS.min())


@pytest.mark.parametrize("known", [slice(None), slice(1, None)], ids=["all points", "one row missing"])
def test_detrend_removes_a_plane_exactly(tmp_path, known):
    iy, ix = np.indices(HEIGHTS.shape)
    bumpy = HEIGHTS - fitted_plane(HEIGHTS)
    heights = np.full(HEIGHTS.shape, np.nan)
    heights[known] = (bumpy - fitted_plane(np.where(np.isin(iy, np.arange(6)[known]), bumpy, np.nan)))[known]
    flat = on_native_grid(measured(tmp_path, heights, missing="far"))
    tilted = on_native_grid(measured(tmp_path, heights + 3e-9 * ix - 2e-8 * iy, missing="far", detrend="plane"))
    assert tilted[known] == close(flat[known], abs=1e-21)


def test_fitted_plane_is_the_least_squares_plane():
    residual = HEIGHTS - fitted_plane(HEIGHTS)
    iy, ix = np.indices(HEIGHTS.shape)
    moments = [np.sum(residual), np.sum(residual * ix), np.sum(residual * iy)]
    assert moments == close([0, 0, 0], abs=1e-21)


# interpolation ------------------------------------------------------------------------------------------------------


def test_bilinear_between_points_is_exact_for_a_bilinear_surface(tmp_path):
    iy, ix = np.indices((6, 9))
    topography = measured(tmp_path, -1e-8 * (2 * ix + 3 * iy + 0.5 * ix * iy))
    column, row = np.meshgrid(np.linspace(0, 8, 37), np.linspace(0, 5, 23))
    found = topography.separation((column - 4) * DX, (row - 2.5) * DY)
    assert found == close(1e-8 * (2 * column + 3 * row + 0.5 * column * row), rel=1e-7, abs=1e-16)


def test_outer_half_cell_is_constant_and_beyond_is_far(tmp_path):
    topography = measured(tmp_path, HEIGHTS)
    x = np.array([4.49, 4.5, 4.51]) * DX
    found = topography.separation(x, 0.5 * DY)
    assert found[:2].tolist() == [SEPARATION[3, 8]] * 2
    assert found[2] == close(SEPARATION.max() + np.hypot(9 * DX, 6 * DY), rel=1e-12)
    assert np.isfinite(topography.separation(1.0, 1.0))


def test_a_mirrored_surface_goes_on_without_a_step(tmp_path):
    topography = measured(tmp_path, HEIGHTS, outside="mirror")
    iy, ix = np.indices((18, 27))
    found = topography.separation((ix - 13) * DX, (iy - 8.5) * DY)
    assert found == close(np.pad(SEPARATION, ((6, 6), (9, 9)), mode="symmetric"), abs=1e-22)


def test_a_repeated_surface_is_periodic(tmp_path):
    topography = measured(tmp_path, HEIGHTS, outside="repeat")
    x, y = np.linspace(-4, 4, 33) * DX, np.linspace(-2, 2, 21)[:, None] * DY
    found = topography.separation(x[None] + 5 * 9 * DX, y - 3 * 6 * DY)
    assert found == close(topography.separation(x[None], y), abs=1e-20)
    assert topography.separation(4.5 * DX, 0.5 * DY) == close(0.5 * (SEPARATION[3, 8] + SEPARATION[3, 0]), rel=1e-9)


def test_missing_points_are_mirrored_too(tmp_path):
    topography = measured(tmp_path, PIERCED, missing="far", outside="mirror")
    assert topography.separation(-5.0 * DX, -3.5 * DY) > 1e-6
    assert topography.separation(-6.0 * DX, -2.5 * DY) < 1e-6


def test_points_broadcast(tmp_path):
    topography = measured(tmp_path, HEIGHTS)
    assert topography.separation(np.zeros((1, 4)), np.zeros((3, 1))).shape == (3, 4)


# missing points -----------------------------------------------------------------------------------------------------

HOLES = np.zeros(HEIGHTS.shape, dtype=bool)
HOLES[2:4, 3:6] = HOLES[0, 0] = HOLES[5, 7:] = True
PIERCED = np.where(HOLES, np.nan, HEIGHTS)


def test_missing_points_are_refused_by_default(tmp_path):
    with pytest.raises(SceneError) as caught:
        measured(tmp_path, PIERCED)
    file = str(tmp_path / "m.npz")
    assert str(caught.value) == (
        f"topography.file must be without missing points (got {file!r} with 9 of 54 missing); set missing = 'far'"
        " (no contact there) or 'interpolate' (filled from their neighbours)"
    )


def test_far_points_never_touch_and_leave_the_others_alone(tmp_path):
    topography = measured(tmp_path, PIERCED, missing="far")
    found = on_native_grid(topography)
    assert np.array_equal(found[~HOLES], np.nanmax(PIERCED) - PIERCED[~HOLES])
    assert (found[HOLES] > np.hypot(9 * DX, 6 * DY)).all()


def test_far_takes_whole_cells_of_the_interpolation(tmp_path):
    topography = measured(tmp_path, PIERCED, missing="far")
    assert topography.separation((2.01 - 4) * DX, (2 - 2.5) * DY) > 1e-6
    assert topography.separation((2.00 - 4) * DX, (2.4 - 2.5) * DY) < 1e-6


def test_interpolated_points_are_the_mean_of_their_neighbours(tmp_path):
    """Discrete harmonic: the weighted differences to the four neighbours sum to zero; the border has no neighbour."""
    found = on_native_grid(measured(tmp_path, PIERCED, missing="interpolate"))
    assert np.array_equal(found[~HOLES], np.nanmax(PIERCED) - PIERCED[~HOLES])
    padded = np.pad(found, 1, mode="edge")
    second_x = (padded[1:-1, :-2] - 2 * found + padded[1:-1, 2:]) / DX**2
    second_y = (padded[:-2, 1:-1] - 2 * found + padded[2:, 1:-1]) / DY**2
    assert (second_x + second_y)[HOLES] == close(np.zeros(9), abs=1e-12 * 1e-8 / DX**2)
    assert found[HOLES].min() > 0


def test_harmonic_fill_restores_a_plane_and_a_saddle():
    iy, ix = np.indices((8, 11)).astype(float)
    holes = np.zeros((8, 11), dtype=bool)
    holes[2:6, 3:8] = True
    for surface in (1 + 2 * ix - 3 * iy, (2.0 * ix) ** 2 - (0.5 * iy) ** 2):
        assert harmonic_fill(np.where(holes, np.nan, surface), 2.0, 0.5) == close(surface, rel=1e-12)


# the bundled sample -------------------------------------------------------------------------------------------------


def rough_heights():
    """Heights of gallery/rough_surface.npz [m]: self-affine, 128 x 128 points of 0.5 um, not periodic.

    Spectrum of heights constant up to 2π/16 um, falling as q^-(2 + 2H) with H = 0.8 up to 2π/2 um, zero beyond; random
    phases on a period twice as wide, of which a quarter is kept; mean plane removed; 50 nm root mean square. Among
    the first seeds this one has the slope of spectrum of the ensemble (their scatter is 0.18).
    """
    number, step, hurst = 256, 0.5e-6, 0.8
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(number, step)[:, None], np.fft.fftfreq(number, step)[None, :])
    roll_off, cut_off = 2 * np.pi / 16e-6, 2 * np.pi / 2e-6
    amplitude = np.where(q <= cut_off, np.maximum(q, roll_off) ** -(1 + hurst), 0.0)
    amplitude[0, 0] = 0.0
    noise = np.random.default_rng(7).standard_normal((number, number))
    heights = np.fft.ifft2(amplitude * np.fft.fft2(noise)).real[:128, :128]
    heights -= fitted_plane(heights)
    return heights * (50e-9 / np.sqrt(np.mean(heights**2)))


def test_the_bundled_surface_is_what_its_recipe_makes():
    topography = Topography(file="gallery:rough_surface.npz")
    assert topography.native_grid() == Grid(nx=128, ny=128, dx=0.5e-6, dy=0.5e-6)
    expected = rough_heights()
    assert on_native_grid(topography) == close(expected.max() - expected, abs=1e-13)


def test_the_bundled_surface_has_the_spectrum_it_promises():
    """Slope of the windowed, ring-averaged spectrum of heights is -2 (1 + H) = -3.6, both sides.

    Rings from 7 to 28 waves in the window: the lobe of the Hann window stays off the roll-off (4) and cut-off (32).
    """
    h = -on_native_grid(Topography(file="gallery:rough_surface.npz"))
    h -= h.mean()
    assert np.sqrt(np.mean(h**2)) == close(50e-9, rel=1e-5)
    window = np.hanning(128)
    power = np.abs(np.fft.fft2(h * window[:, None] * window[None, :])) ** 2
    waves = 128 * np.hypot(np.fft.fftfreq(128)[:, None], np.fft.fftfreq(128)[None, :])
    edges = np.geomspace(7, 28, 7)
    rings = [(waves > low) & (waves < high) for low, high in pairwise(edges)]
    slope = np.polyfit([np.log(waves[r]).mean() for r in rings], [np.log(power[r].mean()) for r in rings], 1)[0]
    assert slope == close(-3.6, abs=0.1)


def test_the_bundled_surface_is_small():
    package = Path(importlib.util.find_spec("eigencontact").submodule_search_locations[0])
    assert (package / "gallery" / "rough_surface.npz").stat().st_size < 150_000


# refusals -----------------------------------------------------------------------------------------------------------


def text(content):
    return lambda path: path.write_text(content, encoding="utf-8")


def array(values):
    return lambda path: np.save(path, values)


def archive(**arrays):
    return lambda path: np.savez(path, **arrays)


def raw(content):
    return lambda path: path.write_bytes(content)


RASTER = "0 0 1\n1 0 2\n0 1 3\n1 1 4\n"
SP = {"spacing": (1.0, 1.0)}
READABLE = "a readable .npy, .npz, NetCDF or text (.txt, .csv, .tsv, .dat, .xyz, .asc) file"


@pytest.mark.parametrize(
    ("name", "write", "table", "rule", "reason"),
    [
        ("a.npy", None, SP, "an existing file", "a relative path counts from the folder of the scene"),
        ("a.npy", raw(b"nonsense"), SP, READABLE, None),
        ("a.npy", raw(b""), SP, READABLE, None),
        ("a.npz", raw(b"PK\x03\x04 broken"), SP, READABLE, None),
        ("a.npy", array(np.array([[1, None]], dtype=object)), SP, "an array of real numbers", "its type is object"),
        ("a.npy", array(np.ones((2, 2), complex)), SP, "an array of real numbers", "its type is complex128"),
        ("a.npy", array(np.ones(5)), SP, "heights on a raster of at least 2 x 2 points", "its shape is (5,)"),
        ("a.npy", array(np.ones((1, 5))), SP, "heights on a raster of at least 2 x 2 points", "its shape is (1, 5)"),
        (
            "a.npy",
            array(np.array([[1, np.inf], [2, 3]])),
            SP,
            "finite heights",
            "1 are infinite; mark missing points with NaN",
        ),
        ("a.npy", array(np.full((2, 2), np.nan)), SP, "a measurement with heights", "every point is missing"),
        (
            "a.npz",
            archive(z=np.ones((2, 2)), x=np.ones(2), dx=1.0),
            {},
            "an archive with the array 'heights', or with one array",
            "it holds z, x, dx",
        ),
        (
            "a.npz",
            archive(heights=np.ones((2, 2)), dx=np.ones(3)),
            {},
            "an archive with one number each for dx and dy",
            "their shapes are (3,) and (3,)",
        ),
        ("a.xyz", text("# nothing\n\n"), {}, "a text file with rows of numbers", "no line holds two numbers or more"),
        ("a.txt", text("1 2\n3 x\n"), {}, "a text file with rows of 2 numbers", "line 2 holds 'x'"),
        ("a.txt", text("1 2 3 4\n1 2 3\n"), {}, "a text file with rows of 4 numbers", "line 2 holds 3"),
        (
            "a.txt",
            text("units: V\n1 2\n3 4\n"),
            {},
            "a text file whose header gives lengths in m, mm, um, nm, pm, angstrom or inch",
            "it says 'V'",
        ),
        (
            "a.txt",
            text("# Width: 1 um\n1 2 3 4\n\n# Width: 1 um\n1 2 3 4\n"),
            {},
            "a text file with one matrix",
            "its headers give 'width' twice; keep one channel",
        ),
        (
            "a.csv",
            text(",0,1,2,3\n0,5,5,5,5\n1,5,5,5,5\n"),
            {},
            "a matrix of heights alone",
            "its first row and column are coordinates; remove them",
        ),
        (
            "a.xyz",
            text("0 0 1\n1 0 2\n2.5 0 3\n0 1 3\n1 1 4\n2.5 1 1\n"),
            {},
            "a regular raster",
            "steps along x go from 1 to 1.5; resample it to equal steps first",
        ),
        ("a.xyz", text(RASTER + "1 1 5\n"), {}, "a raster with one height a point", "1 rows repeat a point"),
        ("a.xyz", text("0 0 1\n1 0 2\n"), {}, "heights on a raster of at least 2 x 2 points", "all y are equal"),
        ("a.xyz", text(RASTER + "nan 1 5\n"), {}, "a raster with finite coordinates", "x holds 1 others"),
        (
            "a.xyz",
            text("".join(f"{n} {n} 0\n" for n in range(40))),
            {},
            "a regular raster",
            "40 points lie scattered over 40 x 40 places",
        ),
    ],
)
def test_wrong_files_are_refused_in_one_line(tmp_path, name, write, table, rule, reason):
    file = tmp_path / name
    if write is not None:
        write(file)
    with pytest.raises(SceneError) as caught:
        Topography(file=str(file), **table)
    start = f"topography.file must be {rule} (got {str(file)!r}); "
    assert str(caught.value).startswith(start)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) > len(start)
    if reason is not None:
        assert str(caught.value) == start + reason


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"height_unit": 0.0}, "topography.height_unit must be positive and finite [m] (got 0.0)"),
        ({"lateral_unit": float("nan")}, "topography.lateral_unit must be positive and finite [m] (got nan)"),
        (
            {"spacing": (1.0, -1.0)},
            "topography.spacing must be two positive and finite lengths (dx, dy) (got (1.0, -1.0))",
        ),
        ({"spacing": (1.0,)}, "topography.spacing must be two positive and finite lengths (dx, dy) (got (1.0,))"),
        (
            {"spacing": (5e-7, 7e-7)},
            "topography.spacing must be that of the file, (5e-07, 8e-07) m, or left out (got (5e-07, 7e-07))",
        ),
        ({"missing": "skip"}, "topography.missing must be 'error', 'far' or 'interpolate' (got 'skip')"),
        ({"detrend": "curve"}, "topography.detrend must be 'none' or 'plane' (got 'curve')"),
        ({"outside": "flat"}, "topography.outside must be 'far', 'mirror' or 'repeat' (got 'flat')"),
        ({"center": (0.0, float("inf"))}, "topography.center must be two finite lengths (x, y) (got (0.0, inf))"),
    ],
)
def test_wrong_tables_are_refused(tmp_path, table, message):
    with pytest.raises(SceneError) as caught:
        measured(tmp_path, HEIGHTS, **table)
    assert str(caught.value) == message


def test_spacing_that_agrees_with_the_file_is_accepted(tmp_path):
    assert measured(tmp_path, HEIGHTS, spacing=(DX, DY)) is not None


SILENT = [
    (
        lambda path: np.save(path, HEIGHTS),
        "a.npy",
        {},
        "spacing and height_unit",
        "the distance of its points or the unit of its heights",
        'spacing = "0.5 um", height-unit = "1 nm"',
    ),
    (
        lambda path: np.savez(path, HEIGHTS),
        "a.npz",
        {"height_unit": 1.0},
        "spacing",
        "the distance of its points",
        'spacing = "0.5 um"',
    ),
    (
        lambda path: np.savetxt(path, xyz_rows()),
        "a.xyz",
        {},
        "lateral_unit and height_unit",
        "the unit of its coordinates or the unit of its heights",
        'lateral-unit = "1 um", height-unit = "1 nm"',
    ),
    (
        lambda path: np.savetxt(path, HEIGHTS, header="width: 5 um\nheight: 5 um"),
        "a.txt",
        {},
        "height_unit",
        "the unit of its heights",
        'height-unit = "1 nm"',
    ),
    (
        lambda path: np.savetxt(path, HEIGHTS, header="height unit: um\ndx: 5"),
        "a.txt",
        {},
        "lateral_unit",
        "the unit of its coordinates",
        'lateral-unit = "1 um"',
    ),
]


@pytest.mark.parametrize(("write", "name", "table", "asked", "words", "example"), SILENT)
def test_what_the_file_does_not_tell_is_asked_for_in_one_line(tmp_path, write, name, table, asked, words, example):
    write(tmp_path / name)
    file = str(tmp_path / name)
    with pytest.raises(SceneError) as caught:
        Topography(file=file, **table)
    assert str(caught.value) == (
        f"topography.{asked} must be given (got None): {file!r} does not state {words}; for example {example}"
    )
    given = dict(one.replace("-", "_").replace('"', "").split(" = ") for one in example.split(", "))
    ec.make("topography", kind="geometry", file=file, **table, **given)  # the example would do


def test_a_unit_that_the_file_tells_may_be_repeated_and_not_changed(tmp_path):
    np.savetxt(tmp_path / "a.txt", HEIGHTS, header="units: um\nspacing: 1")
    file = str(tmp_path / "a.txt")
    assert Topography(file=file, height_unit=1e-6) is not None
    with pytest.raises(SceneError, match=r"height_unit must be left out: .*carries its own units \(got 1e-09\)"):
        Topography(file=file, height_unit=1e-9)


@pytest.mark.parametrize("word", ["", "NaN", "bad", "--", "***"])
def test_cells_of_text_that_hold_nothing_are_missing_points(tmp_path, word):
    rows = [[f"{1e9 * h:.9f}" for h in row] for row in HEIGHTS]
    rows[2][3] = rows[0][0] = rows[5][8] = word
    (tmp_path / "a.csv").write_text("\n".join(",".join(row) for row in rows))
    table = {"file": str(tmp_path / "a.csv"), "spacing": (DX, DY), "height_unit": 1e-9}
    with pytest.raises(SceneError, match="3 of 54 missing"):
        Topography(**table)
    found = on_native_grid(Topography(**table, missing="far"))
    assert np.argwhere(found > 1e-6).tolist() == [[0, 0], [2, 3], [5, 8]]
    assert found[3] == close((np.delete(HEIGHTS, [0, 21, 53]).max() - HEIGHTS)[3], abs=1e-18)


def test_unusable_spacing_in_the_file_is_refused(tmp_path):
    np.savez(tmp_path / "a.npz", heights=HEIGHTS, dx=0.0, dy=1.0)
    with pytest.raises(SceneError, match=r"spacing must be positive and finite in .*a\.npz', as dx and dy"):
        Topography(file=str(tmp_path / "a.npz"))


@pytest.mark.parametrize("name", ["nope.npz", "../errors.py", ""])
def test_the_gallery_names_what_it_holds(name):
    with pytest.raises(SceneError) as caught:
        Topography(file=f"gallery:{name}")
    start = f"topography.file must be a file of the gallery (got 'gallery:{name}'); the gallery holds "
    assert str(caught.value).startswith(start)
    assert "rough_surface.npz" in str(caught.value)


# SurfaceTopography --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "content"), [("a.gwy", "x"), ("a.sdf", "aBCR-1.0"), ("a.txt", "Wyko ASCII Data File Format 0 1 1\n")]
)
def test_other_formats_say_what_to_install(tmp_path, monkeypatch, name, content):
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    (tmp_path / name).write_text(content)
    with pytest.raises(SceneError) as caught:
        Topography(file=str(tmp_path / name))
    assert str(caught.value) == (
        "topography.file must be a .npy, .npz or text file (.txt, .csv, .tsv, .dat, .xyz, .asc) (got"
        f" {str(tmp_path / name)!r}); for formats of instruments: pip install eigencontact[topography]"
    )


def test_surface_topography_reads_its_own_file_with_units(tmp_path):
    library = pytest.importorskip("SurfaceTopography")
    extent = (9 * DX * 1e6, 6 * DY * 1e6)
    library.Topography(HEIGHTS.T * 1e6, extent, unit="um").to_netcdf(tmp_path / "a.nc")
    topography = Topography(file=str(tmp_path / "a.nc"))
    assert (topography.native_grid().dx, topography.native_grid().dy) == close((DX, DY), rel=1e-6)
    assert on_native_grid(topography) == close(SEPARATION, rel=1e-6, abs=1e-15)
    with pytest.raises(SceneError, match=r"height_unit must be left out: .*a\.nc' carries its own units \(got 2\.0\)"):
        Topography(file=str(tmp_path / "a.nc"), height_unit=2.0)


def test_text_agrees_with_surface_topography(tmp_path):
    """Its reader of Gwyddion's matrices, which shares no line with ours."""
    library = pytest.importorskip("SurfaceTopography")
    save_gwyddion(tmp_path / "a.txt")
    other = library.read_topography(str(tmp_path / "a.txt")).to_unit("m")
    ours = Topography(file=str(tmp_path / "a.txt"))
    assert ours.native_grid().size == close(other.physical_sizes, rel=1e-9)
    assert on_native_grid(ours) == close((other.heights().max() - other.heights()).T, abs=1e-18)


def test_surface_topography_refuses_in_one_line(tmp_path):
    pytest.importorskip("SurfaceTopography")
    (tmp_path / "a.gwy").write_bytes(b"no such format")
    with pytest.raises(SceneError) as caught:
        Topography(file=str(tmp_path / "a.gwy"))
    assert str(caught.value).startswith("topography.file must be a format that SurfaceTopography reads (got ")
    assert "\n" not in str(caught.value)


def test_a_surface_data_file_of_iso_25178_71_carries_its_units(tmp_path):
    pytest.importorskip("SurfaceTopography")
    head = {
        "ManufacID": "made up", "CreateDate": "231120260000", "ModDate": "231120260000", "NumPoints": 9,
        "NumProfiles": 6, "Xscale": DX, "Yscale": DY, "Zscale": 1e-9, "Zresolution": -1, "Compression": 0,
        "DataType": 7, "CheckType": 0,
    }  # fmt: skip
    rows = "\n".join(f"{1e9 * height:.9f}" for height in HEIGHTS.ravel())
    keys = "\n".join(f"{key} = {value}" for key, value in head.items())
    (tmp_path / "a.sdf").write_text(f"aISO-1.0\n{keys}\n*\n{rows}\n*\n", encoding="ascii")
    topography = Topography(file=str(tmp_path / "a.sdf"))
    assert (topography.native_grid().dx, topography.native_grid().dy) == close((DX, DY), rel=1e-9)
    assert on_native_grid(topography) == close(SEPARATION, abs=1e-17)
