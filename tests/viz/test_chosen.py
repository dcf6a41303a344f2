"""One picture that a user chooses: what is drawn is what is stored, in every format; what is unknown is refused."""

import json
import re

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_hex

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact.results.ownership import is_ours
from eigencontact.viz import figures
from eigencontact.viz.friction import ZONE_COLOURS
from eigencontact.viz.looks import used_look
from eigencontact.viz.profile import stress_profile

REGIONS = (
    '{name="section", shape="plane", normal="y", depth-max="9 um", depth-cells=12}',
    '{name="axis", shape="line", start=[0,0,0], end=[0,0,9e-6], count=19}',
    '{name="level", shape="line", start=[-5e-6,0,3e-6], end=[5e-6,0,3e-6], count=64}',
    '{name="back", shape="line", start=[0,5e-6,3e-6], end=[0,-4e-6,3e-6], count=20}',
    '{name="skew", shape="line", start=[-5e-6,0,1e-6], end=[5e-6,0,3e-6], count=20}',
    '{name="spots", shape="points", points=[[0,0,1e-6]]}',
)
CHANGES = [
    "grid.cells-per-contact-radius=10",
    "output.pictures=false",
    "output.vtk=false",
    f"stress=[{','.join(REGIONS)}]",
    'friction={type="coulomb", coefficient=0.3}',
    'steps=[{normal-load="0.65 N"}, {tangential-load-x="0.1 N"}]',
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("chosen") / "run"
    ec.run(ec.load_scene("hertz", CHANGES), place)
    return place


@pytest.fixture(scope="module")
def data(folder):
    with ec.open_results(folder) as dataset:
        yield dataset.load()


@pytest.fixture(autouse=True)
def _closed():
    """Close the figures of pyplot."""
    yield
    plt.close("all")


def image(axes):
    return np.ma.filled(axes.images[0].get_array(), 0.0)


def unit(label):
    return {"MPa": 1e6, "GPa": 1e9, "nm": 1e-9, "µm": 1e-6}[re.search(r"\[(.+?)\]", label)[1]]


MAPS = {
    ("pressure", None): lambda data: data["pressure"],
    ("shear", None): lambda data: np.hypot(data["shear_x"], data["shear_y"]),
    ("shear", "x"): lambda data: data["shear_x"],
    ("Slip-Distance", None): lambda data: data["slip_distance"],
    ("gap", None): lambda data: data["gap"],
    ("displacement", "y"): lambda data: data["displacement_y"],
    ("displacement", None): lambda data: data["displacement_z"],
}


@pytest.mark.parametrize(("field", "component"), MAPS)
def test_a_map_shows_the_stored_numbers(data, field, component):
    axes = ec.plot(data, field, component=component, zoom="-5 um:5 um,-5 um:3 um")
    wanted = MAPS[field, component](data)[-1].sel(x=slice(-5e-6, 5e-6), y=slice(-5e-6, 3e-6)).values
    shown = image(axes)
    assert shown.shape == wanted.shape
    drawn = shown * unit(axes.figure.axes[1].get_ylabel())
    seen = (wanted != 0) | (field in ("gap", "displacement"))  # the rest lies outside of the border that clips the map
    assert np.abs(drawn - wanted)[seen].max() <= 1e-12 * np.abs(wanted).max()
    assert np.abs(wanted).max() > 0


def plain(component):
    """Numbers that follow from the stress by formulas of their own: von Mises by invariants, principal by numpy."""
    rows = [(0, 5, 4), (5, 1, 3), (4, 3, 2)]
    return {
        "von-mises": lambda s: np.sqrt(
            0.5 * ((s[0] - s[1]) ** 2 + (s[1] - s[2]) ** 2 + (s[2] - s[0]) ** 2) + 3 * (s[3:] ** 2).sum(axis=0)
        ),
        "3": lambda s: np.linalg.eigvalsh(np.stack([np.stack([s[n] for n in row]) for row in rows]).T).T[0],
        "tresca": lambda s: np.ptp(np.linalg.eigvalsh(np.array([[s[n] for n in row] for row in rows]).T), axis=-1).T,
        "zx": lambda s: s[4],
        "zz": lambda s: s[2],
    }[component]


@pytest.mark.parametrize("component", ["von-mises", "tresca", "3", "zx", "zz"])
def test_a_line_shows_the_stress_that_is_asked_for(data, component):
    axes = ec.plot(data, "stress", component=component, region="axis", step=2)
    curve = axes.get_lines()[0]
    wanted = plain(component)(data["axis_stress"][1].values)
    assert curve.get_xdata() * unit(axes.get_xlabel()) == close(wanted, rel=1e-9, abs=1e-3)
    assert curve.get_ydata() == close(1e6 * data["axis_z"].values, rel=1e-12)
    assert np.abs(wanted).max() > 1e8


ACROSS = {
    "level": ("x", lambda data: data["level_x"].values),
    "back": ("y", lambda data: data["back_y"].values),
    "skew": ("distance along skew", lambda data: np.hypot(data["skew_x"].values + 5e-6, data["skew_z"].values - 1e-6)),
}


@pytest.mark.parametrize("rounded", [0.0, 4e-22])
@pytest.mark.parametrize("region", ACROSS)
def test_a_line_that_is_not_steep_is_drawn_across(data, region, rounded):
    name, places = ACROSS[region]
    moved = data.copy()
    moved[f"{region}_z"] = data[f"{region}_z"] + rounded * (np.arange(data.sizes[f"{region}_point"]) % 2)
    axes = ec.plot(moved, "stress", component="xz", region=region)
    curve = axes.get_lines()[0]
    assert axes.get_xlabel() == f"{name} [µm]"
    assert axes.get_ylabel().startswith(r"Stress $\sigma_{xz}$ [")
    assert 1e-6 * curve.get_xdata() == close(places(data), rel=1e-12, abs=1e-18)
    stress = data[f"{region}_stress"][-1, 4].values
    assert curve.get_ydata() * unit(axes.get_ylabel()) == close(stress, rel=1e-9, abs=1.0)
    assert np.ptp(curve.get_ydata()) > 0
    assert not axes.yaxis.get_inverted()
    whole = stress_profile(moved, region).axes[0]
    assert (whole.get_xlabel(), whole.get_ylabel()[:8]) == (f"{name} [µm]", "Stress [")


@pytest.mark.parametrize(
    ("region", "field", "component", "name"),
    [
        ("along-x", "pressure", None, "pressure"),
        ("along-y", "slip-distance", None, "slip_distance"),
        ("along-x", "shear", "x", "shear_x"),
    ],
)
def test_a_profile_on_the_surface_shows_one_row_or_column_of_a_field(data, region, field, component, name):
    axes = ec.plot(data, field, component=component, region=region)
    along, across = region[-1], {"x": "y", "y": "x"}[region[-1]]
    curve = axes.get_lines()[0]
    assert 1e-6 * curve.get_xdata() == close(data[along].values, rel=1e-12)
    wanted = data[name][-1].isel({across: data.sizes[across] // 2}).values
    drawn = curve.get_ydata() * unit(axes.get_ylabel())
    assert np.abs(drawn - wanted).max() <= 1e-9 * np.abs(wanted).max()
    assert np.abs(wanted).max() > 0
    assert axes.get_xlabel() == f"{along} [µm]"


def test_a_standard_picture_can_be_asked_for_by_its_name(data, folder, command, tmp_path):
    axes = ec.plot(data, "pressure-profiles")
    assert axes.get_title().startswith("along x")
    done = command("plot", folder, "--field", "shear_profiles", "--no-vtk", "-o", tmp_path)
    assert (done.code, done.err) == (0, "")
    assert [path.name for path in tmp_path.iterdir()] == ["plot-shear-profiles.png"]


def test_a_line_of_one_depth_is_stored_at_exactly_that(data):
    assert (data["level_z"].values == 3e-6).all()
    assert (data["level_x"].values[0], data["level_x"].values[-1]) == (-5e-6, 5e-6)


def test_what_vanishes_is_drawn_as_zero_and_not_its_round_off(data):
    axes = ec.plot(data, "stress", component="xz", region="axis", step=1)
    assert axes.get_xlabel().endswith("[Pa]")
    assert not axes.get_lines()[0].get_xdata().any()


def test_a_section_has_levels_of_its_component_and_the_cross_at_its_largest_value(data):
    axes = ec.plot(data, "stress", component="xz", region="section")
    stress = data["section_stress"][-1, 4].values
    row, column = np.unravel_index(np.abs(stress).argmax(), stress.shape)
    cross = next(line for line in axes.get_lines() if line.get_marker() == "+")
    at = (1e6 * float(data["section_x"][column]), 1e6 * float(data["section_z"][row]))
    assert np.abs((cross.get_xdata()[0], cross.get_ydata()[0])) == close(np.abs(at), rel=1e-9)
    levels = axes.collections[0].levels * unit(axes.figure.axes[1].get_xlabel())
    assert levels[0] == -levels[-1]
    assert levels[-1] >= np.abs(stress).max() > levels[-2]


def test_zones_are_named_and_a_new_region_is_drawn(data, folder, command, tmp_path):
    axes = ec.plot(data, "contact-zone")
    assert [text.get_text() for text in axes.figure.legends[0].get_texts()] == ["open", "slip", "stick"]
    cells = {int(number) for number in np.unique(data["contact_zone"][-1])}
    colours = {to_hex(patch.get_facecolor()).upper() for patch in axes.patches if patch.get_fill()}
    assert colours == {ZONE_COLOURS[number] for number in cells - {0}}
    table = 'name = "deep", shape = "plane", normal = "z", position = "3 um"'
    words = ["--field", "stress", "--component", "yy", "-o", tmp_path]
    done = command("plot", folder, "--region", table, *words)
    assert (done.code, done.err) == (0, "")
    assert [path.name for path in tmp_path.iterdir()] == ["plot-deep-stress-yy.png"]


@pytest.mark.parametrize("kind", ["pdf", *(pytest.param(kind, marks=pytest.mark.slow) for kind in ("png", "svg"))])
def test_formats_are_written_as_wide_as_a_column_and_own_files_alone_are_replaced(folder, command, tmp_path, kind):
    file = tmp_path / f"figure.{kind}"
    words = ["plot", folder, "--field", "pressure", "--style", "paper", "--dpi", 127, "-o", file]
    assert command(*words).code == command(*words).code == 0
    start, text = file.read_bytes()[:5], file.read_bytes().decode("latin-1")
    assert start == {"png": b"\x89PNG\r", "pdf": b"%PDF-", "svg": b"<?xml"}[kind]
    width = {
        "png": lambda: int.from_bytes(file.read_bytes()[16:20]) / 127,
        "pdf": lambda: float(re.search(r"/MediaBox \[ 0 0 ([\d.]+)", text)[1]) / 72,
        "svg": lambda: float(re.search(r'width="([\d.]+)pt"', text)[1]) / 72,
    }[kind]()
    assert 2.54 * width == close(8.4, abs=0.03)
    assert is_ours(file)
    file.write_bytes(b"of someone else")
    refused = command(*words)
    assert refused.code == 5
    assert "must be a file that eigencontact wrote" in refused.err
    assert file.read_bytes() == b"of someone else"


def test_all_pictures_in_another_format_and_style(folder, command, tmp_path, monkeypatch):
    stored = []
    monkeypatch.setattr(figures, "save", lambda _, path, dpi, _caption: stored.append((path, dpi, used_look().name)))
    words = ["--format", "svg", "--style", "talk", "--dpi", "150", "--no-vtk", "--json", "-o", tmp_path]
    done = command("plot", folder, *words)
    assert (done.code, done.err) == (0, "")
    assert [str(path) for path, *_ in stored] == list(json.loads(done.out))
    assert {path.name for path, *_ in stored} >= {"pressure.svg", "section.svg", "axis.svg", "shear.svg"}
    assert {one[1:] for one in stored} == {(150, "talk")}


REFUSED = {
    ("--field", "presure"): "field must be one that the results hold: .*did you mean 'pressure'?",
    ("--field", "stress", "--region", "sektion"): "must be a stored one .*'section', 'axis', .*'surface'.*'section'",
    ("--field", "stress", "--region", "spots"): "region must be a stored one that can be drawn",
    ("--field", "gap", "--region", "axis"): "must be one that the results hold of region 'axis': stress, von_mises",
    ("--field", "shear", "--component", "w"): "component must be one of magnitude, x, y for 'shear' (got 'w')",
    ("--field", "gap", "--component", "x"): "component must be left out of 'gap'",
    ("--field", "pressure-profiles", "--component", "x"): "component must be left out of 'pressure-profiles'",
    ("--field", "worn-profiles"): "field must be one that the results hold: .*, or a picture: pressure-profiles, .*",
    ("--field", "stress", "--region", "along-x"): "field must be one that the results hold of the surface: .*pressure",
    ("--field", "gap", "--step", "7"): "step must be one that is stored, 1 to 2 (got 7)",
    ("--field", "gap", "--cmap", "viridi"): "cmap must be a colour map .*did you mean 'viridis'?",
    ("--field", "gap", "--format", "pgf"): "format must be one of 'png', 'pdf', 'svg' (got 'pgf'); did you mean 'png'?",
    ("--format", "gif"): "format must be one of",
    ("--style", "papers"): "style must be one of 'screen', 'paper', 'talk' (got 'papers'); did you mean 'paper'?",
    ("--field", "gap", "--dpi", "5"): "dpi must be within 20 and 2400 (got 5)",
    ("--field", "gap", "--zoom", "1:2:3"): "zoom must be one or two ranges of lengths",
    ("--field", "gap", "--zoom", "3 um:1 um"): "each from the smaller to the larger end (got '3 um:1 um')",
    ("--field", "gap", "--zoom", "1 m:2 m"): "zoom must hold cells of the window",
    ("--zoom", "1 um:2 um"): "--zoom must be given with --field, or the name of a region",
    ("--field", "gap", "--animation"): "--animation must be given with all pictures",
    ("--field", "gap", "-o", "x.svg", "--format", "pdf"): "format must be that of the file, 'svg' (got 'pdf')",
}


@pytest.mark.parametrize("words", REFUSED, ids=" ".join)
def test_what_is_unknown_is_refused_in_one_line(folder, command, tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    refused = command("plot", folder, "--no-vtk", *words)
    assert refused.code in (2, 5)
    assert refused.err.count("\n") == 1
    pattern = ".*".join(re.escape(part) for part in REFUSED[words].split(".*"))
    assert re.search(pattern, refused.err), refused.err
    assert list(tmp_path.iterdir()) == []


def test_a_library_call_takes_runs_and_refuses_the_rest(data):
    with pytest.raises(SceneError, match="results must be a folder, a dataset"):
        ec.plot(3, "pressure")
    with pytest.raises(SceneError, match="style must be one of"):
        ec.plot(data, "pressure", style="poster")
    small, large = (ec.plot(data, "pressure", style=name) for name in ("paper", "talk"))
    assert small.title.get_fontsize() == 8
    assert large.title.get_fontsize() == 16
    assert small.figure.get_figwidth() == close(8.4 / 2.54, rel=1e-9)
