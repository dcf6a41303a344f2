"""Sections and profiles where the material jumps: each point on its side, nothing joined, no extreme in cut cells."""

import io
import tomllib
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from PIL import Image

import eigencontact as ec
from close import close
from eigencontact.model.model import build_model
from eigencontact.planning.borders import line_borders
from eigencontact.results.borders import line_variables
from eigencontact.viz.cut import StepValues, View
from eigencontact.viz.lines import contact_runs
from eigencontact.viz.profile import line_profile, stress_profile
from eigencontact.viz.section import stress_section
from eigencontact.viz.sides import Plane, line_sides, sides_of
from eigencontact.viz.style import save
from eigencontact.viz.surface import pressure_map, uplift_map
from viz.test_outlines import ring

CONTACT = """
[body2]
rigid = true

[geometry]
type = "sphere"
radius = "105 um"

[steps]
normal-load = "0.65 N"
"""
LAYERED = {"layers": '{"1": [{"name": "layer 1", "top": 0.0, "bottom": 2e-6}]}'}
BALL = f"""{CONTACT}
[body1]
young-modulus = "210 GPa"
poisson-ratio = 0.3

[grid]
cells = [16, 16]
spacing = ["0.5 um", "0.5 um"]

[numerics]
inclusion-pitch = "0.5 um"
allow-coarse = true

[[inclusions]]
type = "sphere"
center = [0, 0, "2 um"]
radius = "1.03 um"
"""
STIFF = 'material = { young-modulus = "420 GPa", poisson-ratio = 0.3 }'
LINE = '[[stress]]\nname = "axis"\nshape = "line"\nstart = [0, 0, "{} um"]\nend = [0, 0, "{} um"]\ncount = {}'
H, V = np.linspace(-4e-6, 4e-6, 41), np.linspace(0.0, 4e-6, 41)
#: Dots per inch at which a band between two of every four points would be some dots high.
DOTS, FEW = 150, {"cut_x": slice(None, None, 4), "cut_z": slice(None, None, 4)}
#: Middles of cells of 0.5 um, as many as hold the ball.
CELLS = {axis: (np.arange(-3, 3) + 0.5) * 0.5e-6 for axis in "xy"} | {"z": (np.arange(2, 8) - 0.5) * 0.5e-6}


def section(values, layers, outline=None, **more):
    """Results with one plane region ``cut``."""
    data = xr.Dataset(
        {"cut_von_mises": (("step", "cut_z", "cut_x"), values[None]), **more},
        coords={"step": [1], "cut_x": H, "cut_z": V, "cut_y": 0.0},
        attrs={
            **layers,
            "regions": '{"cut": {"shape": "plane", "body": 1, "dims": ["z", "x"], "fields": ["von_mises"]}}',
        },
    )
    return data if outline is None else data.assign(cut_outline=(("n", "end", "place"), outline))


def colours_down(figure, axes, x):
    """Colours of the picture along a vertical line at x, from above to below."""
    figure.set_dpi(DOTS)
    stored = io.BytesIO()
    figure.savefig(stored, format="png", dpi=DOTS)
    picture = np.asarray(Image.open(stored).convert("RGB")).astype(int)
    (column, top), (_, bottom) = (axes.transData.transform((x, z)) for z in axes.get_ylim()[::-1])
    rows = picture.shape[0] - np.array([top, bottom])
    return picture[int(rows[0]) + 10 : int(rows[1]) - 10, int(column)]


def bands(colours):
    """Number of bands along a line: runs of three dots of one colour that is not the grey of a line."""
    found = [
        tuple(one)
        for one, after in zip(colours[:-2], colours[2:], strict=True)
        if np.abs(one - after).max() == 0 and np.ptp(one) > 30
    ]
    return len([one for one, after in pairwise([*found, ()]) if one != after])


def test_no_band_lies_between_the_two_sides_of_an_interface():
    values = np.where(V[:, None] < 2e-6 * (1 - 1e-9), 9e9, 1e9) + 0 * H
    figure = stress_section(section(values, LAYERED).isel(FEW), "cut")
    assert bands(colours_down(figure, figure.axes[0], 1.3)) == 2
    joined = stress_section(section(values, {}).isel(FEW), "cut")  # without layers there are bands between
    assert bands(colours_down(joined, joined.axes[0], 1.3)) > 2
    lines = {float(line.get_ydata()[0]) for line in figure.axes[0].get_lines() if line.get_label() == "_interface"}
    assert [*lines] == close([2.0], rel=1e-12)


def test_no_band_lies_across_the_border_of_an_inclusion():
    inside = np.hypot(H, V[:, None] - 2e-6) < 1.03e-6
    outline = ring(0.0, 2e-6, 1.03e-6, 200)
    values = np.where(inside, 9e9, 1e9)
    figure = stress_section(section(values, {}, outline).isel(FEW), "cut")
    assert bands(colours_down(figure, figure.axes[0], 0.1)) == 3
    joined = stress_section(section(values, {}).isel(FEW), "cut")
    assert bands(colours_down(joined, joined.axes[0], 0.1)) > 3


@pytest.mark.parametrize("layers", [{}, LAYERED])
def test_points_lie_within_the_outline_or_outside_and_above_the_interface_or_below(layers):
    data = section(np.ones((41, 41)), layers)
    two = np.concatenate([ring(-1e-6, 2e-6, 1.03e-6, 400), ring(2.2e-6, 1.5e-6, 0.51e-6, 400)])
    sides = sides_of(data, Plane(1, ("z", "x"), V, H), two)
    balls = [np.hypot(H + 1e-6, V[:, None] - 2e-6) < 1.03e-6, np.hypot(H - 2.2e-6, V[:, None] - 1.5e-6) < 0.51e-6]
    owner = balls[0] + 2 * balls[1]
    deep = (V[:, None] >= 2e-6 * (1 - 1e-12)) & bool(layers) | np.zeros_like(balls[0])
    assert np.array_equal(sum(part.points.astype(int) for part in sides.parts), np.ones((41, 41)))
    for part in sides.parts:
        assert np.unique(owner[part.points]).size == np.unique(deep[part.points]).size == 1
    assert len(sides.parts) == len(np.unique(owner + 3 * deep))


def with_cells(values):
    grid = {f"cells_1_{axis}": (f"cells_1_{axis}", places) for axis, places in CELLS.items()}
    return section(values, {}, ring(0.0, 2e-6, 1.03e-6, 400)).assign_coords(grid)


def cut_cells():
    """Points in cells that the circle cuts: the nearest and the farthest point of the cell lie on its two sides."""
    starts = [0.5e-6 * np.floor(np.round(at / 0.5e-6, 9)) for at in (V, H)]
    pairs = zip((V, H), starts, strict=True)
    lower = [np.where(np.abs(at - start) < 1e-12, start - 0.5e-6, start) for at, start in pairs]
    found = np.zeros((41, 41), dtype=bool)
    for z in (starts[0], lower[0]):
        for x in (starts[1], lower[1]):
            spans = [(z - 2e-6, z - 1.5e-6), (x, x + 0.5e-6)]
            near = [np.where(a * b < 0, 0.0, np.minimum(abs(a), abs(b))) for a, b in spans]
            far = [np.maximum(abs(a), abs(b)) for a, b in spans]
            near, far = (np.hypot(part[0][:, None], part[1]) for part in (near, far))
            found |= (near < 1.03e-6 - 1e-12) & (far > 1.03e-6 + 1e-12)
    return found


def test_cells_that_a_border_cuts_are_filled_from_their_side_and_hold_no_extreme():
    cut = cut_cells()
    inside = np.hypot(H, V[:, None] - 2e-6) < 1.03e-6
    values = np.where(inside, 5e9, 2e9)
    values[cut] = 40e9
    data = with_cells(values)
    sides = sides_of(data, Plane(1, ("z", "x"), V, H), data["cut_outline"].values)
    assert np.array_equal(~sides.whole, cut)
    for part, value in zip(sides.parts, (2e9, 5e9), strict=True):
        assert sides.filled(values, part)[part.points] == close(value, rel=1e-9)
    finer = stress_section(data, "cut").axes[0]  # four points to an edge
    assert "5 GPa at" in finer.get_title()
    coarse = {"cut_x": slice(2, None, 3), "cut_z": slice(2, None, 3)}
    axes, bar = stress_section(data.isel(coarse), "cut").axes
    cross = next(line for line in axes.get_lines() if line.get_marker() == "+")
    assert np.hypot(cross.get_xdata()[0], cross.get_ydata()[0] - 2.0) < 0.8
    assert "5 GPa at" in axes.get_title()
    assert bar.get_ylim()[1] < 7


def stored_line(scene, start, end, points):
    """What results store of the inclusions along a line into the depth."""
    loaded = ec.load_scene(tomllib.loads(f"{scene}\n{LINE.format(start, end, points)}"))
    lines = line_borders(build_model(loaded, loaded.known_plugins()))
    return {variable.name: (variable.dims, variable.values) for variable in line_variables(lines)}


def test_curves_along_a_line_break_where_the_material_changes():
    depth = np.linspace(0.0, 4e-6, 33)
    stress = np.where(depth < 2e-6 * (1 - 1e-9), 3e9, 1e9)
    data = xr.Dataset(
        {"axis_von_mises": (("step", "axis_point"), stress[None])},
        coords={"step": [1], "axis_x": ("axis_point", 0 * depth), "axis_y": 0.0, "axis_z": ("axis_point", depth)},
        attrs={
            **LAYERED,
            "regions": '{"axis": {"shape": "line", "body": 1, "dims": ["point"], "fields": ["von_mises"]}}',
        },
    )
    axes = stress_profile(data, "axis").axes[0]
    curve = next(line for line in axes.get_lines() if line.get_label() == "Von Mises stress")
    x, z = curve.get_xdata(), curve.get_ydata()
    gap = np.flatnonzero(np.isnan(x))
    assert gap.tolist() == [16]
    assert (x[:16] == 3.0).all()
    assert (x[17:] == 1.0).all()
    assert z[17] == close(2.0, rel=1e-12)
    marked = next(line for line in axes.get_lines() if line.get_label() == "_interface")
    assert marked.get_ydata()[0] == close(2.0, abs=1e-6)
    # Through a ball instead: the border lies where the sphere is, cells that it cuts are left out.
    del data.attrs["layers"]
    ball = data.assign(stored_line(BALL + STIFF, 0.0, 4.0, 33))
    axes = line_profile(ball, "axis", StepValues("Von Mises stress", "Pa", stress), -1, View()).axes[0]
    marks = sorted(float(line.get_ydata()[0]) for line in axes.get_lines() if line.get_label() == "_interface")
    assert marks == close([0.97, 3.03], abs=1e-6)
    curve = axes.get_lines()[0]
    drawn = curve.get_ydata()[np.isfinite(curve.get_xdata())]
    assert np.array_equal(drawn, [z for z in 1e6 * depth if not (0.5 <= z < 1.5 or 2.5 <= z < 3.5)])


def contact(pressure, **more):
    x = (np.arange(12) - 5.5) * 1e-6
    names = ("step", "y", "x")
    return xr.Dataset(
        {"pressure": (names, pressure[None]), **{name: (names, values[None]) for name, values in more.items()}},
        coords={"step": [1], "x": x, "y": x},
        attrs={"cell_size": [1e-6, 1e-6], "regions": "{}"},
    )


def test_a_layer_that_ends_with_the_model_has_no_frame():
    x = (np.arange(12) - 5.5) * 1e-6
    pressure = 1e9 * (np.hypot(x, x[:, None]) < 3e-6)
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])

    def dashed(reach):
        border = np.stack([reach * corners, reach * np.roll(corners, -1, axis=0)], axis=1)
        axes = pressure_map(contact(pressure).assign(outline=(("segment", "end", "at"), border))).axes[0]
        return [path for item in axes.collections for path in item.get_paths()]

    assert dashed(3e-6)
    assert not dashed(5.7e-6)


def test_the_ends_of_the_contact_are_those_of_the_row_in_the_plane():
    pressure = np.zeros((12, 12))
    pressure[6, 2:5] = pressure[6, 8:9] = 1e9
    data = contact(pressure)
    assert contact_runs(data, -1, "y", 0.3e-6).ravel() == close([-4e-6, -1e-6, 2e-6, 3e-6], rel=1e-12)
    assert contact_runs(data, -1, "y", 2.3e-6).size == 0
    assert contact_runs(data, -1, "x", -3.4e-6).ravel() == close([0.0, 1e-6], rel=1e-12, abs=1e-18)
    assert contact_runs(data, -1, "y", 9e-6).size == contact_runs(data, -1, "z", 0.0).size == 0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_is_lifted_is_red_also_where_all_of_it_goes_one_way(sign):
    sunk = np.zeros((12, 12))
    sunk[5, 4] = sign * 3e-9
    image = uplift_map(contact(0 * sunk, residual_displacement_z=sunk)).axes[0].images[0]
    assert sorted(np.abs(image.get_clim())) == close((0.0, 3.0), rel=1e-12)  # no half of the colours is unused
    red, _, blue, _ = image.to_rgba(image.get_array())[5, 4]
    assert (red > blue) == (sign < 0)
    assert image.to_rgba([[0.0]])[0, 0, :3].min() > 0.95


def test_a_section_is_framed_around_contact_and_large_values(tmp_path):
    x, z = np.linspace(-40e-6, 40e-6, 81), np.linspace(0.0, 60e-6, 61)
    bump = 1e9 * np.exp(-(x**2 + (z[:, None] - 4e-6) ** 2) / (2 * 3e-6**2))
    pressure = np.zeros((12, 12))
    pressure[5:7, 1:11] = 1e9
    data = contact(pressure).assign_coords(cut_x=x, cut_z=z, cut_y=0.0)
    data = data.assign(cut_von_mises=(("step", "cut_z", "cut_x"), bump[None]), normal_load=("step", [1.0]))
    data.attrs["regions"] = '{"cut": {"shape": "plane", "body": 1, "dims": ["z", "x"], "fields": ["von_mises"]}}'
    axes = stress_section(data, "cut").axes[0]
    assert 6.4 < axes.get_xlim()[1] < 12.0
    assert 10.0 < axes.get_ylim()[0] < 16.0
    assert axes.get_ylim()[1] == 0.0
    bar = next(line for line in axes.get_lines() if line.get_label() == "_contact")
    assert bar.get_xdata() == close([-5.0, 5.0], rel=1e-12)
    small = stress_section(data, "cut", view=View(horizontal=(-2e-6, 2e-6), vertical=(1e-6, 6e-6))).axes[0]
    assert (*small.get_xlim(), *small.get_ylim()) == close((-2.0, 2.0, 6.0, 1.0), rel=1e-12)


def test_values_at_the_border_are_continued_without_steps():
    inside = np.hypot(H, V[:, None] - 2e-6) < 1.03e-6
    values = np.where(inside, 5e9, 2e9 + 1e14 * (H + 2 * V[:, None]))
    smooth = values.copy()
    data = with_cells(values)
    sides = sides_of(data, Plane(1, ("z", "x"), V, H), data["cut_outline"].values)
    values[~sides.trusted] = 40e9  # faces of cells
    around = sides.filled(values, sides.parts[0])[sides.parts[0].points]
    # The field itself differs by 0.1 GPa between points; the nearest trusted ones are up to 0.4 GPa away.
    assert np.abs(around - smooth[sides.parts[0].points]).max() < 0.25e9


def test_the_middle_of_a_whole_cell_beside_a_border_is_trusted():
    data = with_cells(np.ones((41, 41)))
    sides = sides_of(data, Plane(1, ("z", "x"), V, H), data["cut_outline"].values)
    assert (sides.whole & ~sides.trusted).any()
    rows, columns = np.nonzero(sides.trusted)
    near = (np.abs(np.hypot(H[columns], V[rows] - 2e-6) - 1.03e-6) < 0.5e-6).sum()
    assert near > 0


def test_a_point_on_a_border_sets_no_colour_and_no_cross():
    inside = np.hypot(H, V[:, None] - 2e-6) < 1.0e-6
    values = np.where(inside, 1e9, 2e9 + 1e8 * (V[:, None] > 3.5e-6))
    values[10, 20] = 9e9  # at (0, 1 um), on a ball of 1 um
    figure = stress_section(section(values, {}, ring(0.0, 2e-6, 1e-6, 200)), "cut")
    assert "9 GPa" not in figure.axes[0].get_title()
    assert figure.axes[0].collections[0].levels[-1] < 3.0


def test_a_plateau_has_no_cross():
    values = np.minimum(1e9, 1e9 * (2e-6 / np.hypot(H, V[:, None] + 1e-9)) ** 2)
    axes = stress_section(section(values, {}), "cut").axes[0]
    assert axes.get_title().endswith("plateau at 1 GPa")
    assert not [line for line in axes.get_lines() if line.get_marker() == "+"]


def test_a_largest_value_beyond_the_colours_is_written_beside_them():
    values = np.full((41, 41), 1e9) * (1 + V[:, None] / 4e-6)
    values[0, 20] = 7e9
    axes, bar = stress_section(section(values, {}), "cut").axes
    assert "7 GPa" in axes.get_title()
    assert axes.collections[0].levels[-1] < 4.0
    assert "7" in [text.get_text() for text in bar.texts]


def test_levels_of_a_field_that_is_mostly_small_grow_by_ratios():
    values = 1e9 * np.exp(-np.hypot(H, V[:, None] - 2e-6) / 0.3e-6)
    axes, bar = stress_section(section(values, {}), "cut", view=View(horizontal=(-4e-6, 4e-6))).axes
    levels = axes.collections[0].levels
    assert levels[0] == 0.0
    assert (levels[2:] / levels[1:-1]).min() > 1.3
    assert bar.get_xlabel().endswith("(nonlinear scale)") or bar.get_ylabel().endswith("(nonlinear scale)")


def test_points_on_a_border_are_left_out_of_a_line():
    z = np.linspace(0.97e-6, 3.03e-6, 5)
    stored = stored_line(BALL + "eigenstrain = 0.001", 0.97, 3.03, 5)
    sides = line_sides(xr.Dataset(stored, attrs={"layers": "{}"}), "axis", 1, z, -1)
    assert sides.whole.tolist() == [False, True, True, True, False]


def test_a_long_title_is_broken_to_stay_inside_the_figure(tmp_path):
    figure = stress_section(section(np.ones((41, 41)) + V[:, None], {}), "cut")
    words = "Von Mises stress in body 1 at 123 mN (step 217 of 1000) beside the words of a long title, and more of them"
    figure.axes[0].set_title(words)
    save(figure, tmp_path / "long.png")
    title = figure.axes[0].title
    box = title.get_window_extent(figure.canvas.get_renderer())
    assert box.x0 > 0
    assert box.x1 < figure.bbox.width
    assert title.get_text().count("\n") >= 1


def test_planes_beside_an_interface_say_that_their_colours_are_their_own():
    """Two pictures of one interface must not be compared by colour."""
    attrs = {
        **LAYERED,
        "regions": '{"cut": {"shape": "plane", "body": 1, "dims": ["y", "x"], "fields": ["von_mises"]}}',
    }
    labels = []
    for depth in (2e-6, 1e-6):
        data = xr.Dataset(
            {"cut_von_mises": (("step", "cut_y", "cut_x"), (1e9 + 1e14 * np.abs(H) + 0.0 * H[:, None])[None])},
            coords={"step": [1], "cut_x": H, "cut_y": H, "cut_z": depth},
            attrs=attrs,
        )
        labels.append(stress_section(data, "cut").axes[1].get_ylabel())
    assert labels == ["Von Mises stress [GPa], scale of this side", "Von Mises stress [GPa]"]


def test_a_narrow_section_has_room_for_its_title():
    narrow = section(np.ones((41, 41)) * 1e9 * (1 + V[:, None] / 1e-5), {})
    narrow = narrow.isel(cut_x=slice(18, 23))
    assert stress_section(narrow, "cut").get_figwidth() >= 4.0
