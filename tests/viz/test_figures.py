from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image

from close import close
from eigencontact.viz.figures import draw_all
from eigencontact.viz.history import load_history
from eigencontact.viz.lines import middle
from eigencontact.viz.profile import stress_profile
from eigencontact.viz.section import drawable, stress_section
from eigencontact.viz.smooth import smooth_border
from eigencontact.viz.style import save, scale_for
from eigencontact.viz.surface import pressure_map, pressure_profiles, relative_difference
from eigencontact.viz.window import DOTS, _sampled
from results import synthetic


@pytest.fixture(scope="module")
def stored():
    """Make up the dataset of a run, once; the pressure may be replaced."""

    @cache
    def build(*, loads=(synthetic.LOAD,), regions=(), reference=True, pressure=None, **window):
        info = synthetic.info(steps=len(loads), **window)
        records = [synthetic.step(info, n, load, regions, reference=reference) for n, load in enumerate(loads, 1)]
        y, x = info.grid.axes()
        for record in records if pressure is not None else ():
            record.fields["pressure"] = pressure(x, y)
        return synthetic.opened(info, records)

    return build


def ellipse(a, b):
    return lambda x, y: 1e9 * np.sqrt(np.maximum(0, 1 - (x / a) ** 2 - (y / b) ** 2))


WINDOWS = {
    "16x16": {"nx": 16, "ny": 16},
    "1024x1024, contact a fifth": {"nx": 1024, "ny": 1024, "size_x": 60e-6, "size_y": 60e-6},
    "10:1": {"nx": 160, "ny": 16, "size_x": 160e-6, "size_y": 16e-6, "pressure": ellipse(70e-6, 7e-6)},
    "1:10": {"nx": 16, "ny": 160, "size_x": 16e-6, "size_y": 160e-6, "pressure": ellipse(7e-6, 70e-6)},
    "one row": {"nx": 30, "ny": 1},
    "one cell": {"nx": 1, "ny": 1},
    "no pressure": {"loads": (0.0,)},
    "contact to the edge": {"pressure": lambda x, y: 1e6 + 0 * x + 0 * y},
    "adhesive": {"pressure": lambda x, y: 1e6 * np.cos(1e6 * x) + 0 * y},
    "rough": {"nx": 64, "ny": 64, "pressure": lambda x, y: np.maximum(0, np.sin(6e6 * x) * np.sin(7e6 * y) - 0.6)},
}


def boxes(figure):
    """Drawn extents of all visible texts, in pixels."""
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    texts = [text for text in figure.findobj(mpl.text.Text) if text.get_visible() and text.get_text().strip()]
    found = [(text, text.get_window_extent(renderer)) for text in texts]
    ticks = {
        label
        for axes in figure.axes
        for axis, box in ((axes.xaxis, axes.get_window_extent().x0), (axes.yaxis, axes.get_window_extent().y0))
        for tick in axis.get_major_ticks()
        for label in (tick.label1, tick.label2)
        if not tick.label1.get_window_extent(renderer).width or not _inside(axis, tick)
    }
    return [(text.get_text(), box) for text, box in found if text not in ticks]


def _inside(axis, tick):
    low, high = sorted(axis.get_view_interval())
    return low - 1e-9 * (high - low) <= tick.get_loc() <= high + 1e-9 * (high - low)


def overlaps(figure):
    drawn = boxes(figure)
    return [
        (one, other)
        for n, (one, a) in enumerate(drawn)
        for other, b in drawn[n + 1 :]
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 1 and min(a.y1, b.y1) - max(a.y0, b.y0) > 1
    ]


@pytest.mark.parametrize("draw", [pressure_map, pressure_profiles])
@pytest.mark.parametrize("window", WINDOWS)
def test_surface_pictures_have_labels_with_units_and_no_overlap(stored, window, draw):
    figure = draw(stored(**WINDOWS[window]))
    assert overlaps(figure) == []
    main = figure.axes[0]
    assert main.get_xlabel()[:3] == "x ["
    if draw is pressure_map:
        assert main.get_ylabel()[:3] == "y ["
        assert main.get_aspect() == 1.0
        assert [axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes[1:]] != [""]
    else:
        assert main.get_ylabel().startswith("Pressure [")
    ticks = np.abs([t for t in main.get_xticks() if main.get_xlim()[0] <= t <= main.get_xlim()[1]])
    assert 1 <= ticks.max() < 1000


def test_map_is_cut_to_the_contact(stored):
    main = pressure_map(stored(**WINDOWS["1024x1024, contact a fifth"])).axes[0]
    a = synthetic.hertz(synthetic.LOAD)[0] * 1e6
    for low, high in (main.get_xlim(), main.get_ylim()):
        assert -1.8 * a < low < -1.2 * a
        assert 1.2 * a < high < 1.8 * a


def test_outline_follows_the_cells_of_one_contact_and_not_of_many(stored):
    def lines(window):
        return pressure_map(stored(**WINDOWS[window])).axes[0]

    (border,) = lines("16x16").patches
    path = border.get_path()
    cells = stored(**WINDOWS["16x16"])["pressure"][-1].values != 0
    x, y = path.vertices[:-1].T
    area = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    edge = 1e6 * np.atleast_1d(stored(**WINDOWS["16x16"]).attrs["cell_size"])
    assert area == close(np.count_nonzero(cells) * edge.prod(), rel=0.04)
    assert np.hypot(x, y).std() < 0.02 * np.hypot(x, y).mean()  # no steps of cells
    assert lines("16x16").images[0].get_clip_path() is not None
    for window in ("rough", "no pressure"):
        assert len(lines(window).patches) == len(lines(window).collections) == 0


def test_few_cells_keep_their_edges():
    region = np.zeros((9, 9), dtype=bool)
    region[3:6, 3:6] = True
    assert smooth_border(region, np.arange(10.0), np.arange(10.0)) is None
    wide = np.kron(region, np.ones((3, 3), dtype=bool))
    wide[13, 13] = False
    assert smooth_border(wide, np.arange(28.0), np.arange(28.0)) is None  # the hole would be lost


def test_low_pressure_of_a_rough_contact_is_palest(stored):
    image = pressure_map(stored(**WINDOWS["rough"])).axes[0].images[0]
    low, high = (image.get_cmap()(end)[:3] for end in (0.0, 1.0))
    assert sum(low) > sum(high)
    assert sum(low) < 3 * 0.93  # darker than the ground


def test_signed_pressure_takes_a_diverging_map_centred_on_zero(stored):
    image = pressure_map(stored(**WINDOWS["adhesive"])).axes[0].images[0]
    assert image.get_cmap().name == "RdBu_r"
    assert image.get_clim()[0] == -image.get_clim()[1]
    assert pressure_map(stored()).axes[0].images[0].get_cmap().name == "viridis"


def test_profiles_show_every_cell_and_the_closed_form(stored):
    dataset = stored(nx=16, ny=12)
    figure = pressure_profiles(dataset)
    reference, computed = (line for line in figure.axes[0].get_lines() if line.get_label() != "_contact")
    assert (reference.get_marker(), computed.get_marker()) == ("None", "o")
    np.testing.assert_allclose(computed.get_ydata() * 1e9, dataset["pressure"][-1, 6].values, rtol=1e-12)
    np.testing.assert_allclose(reference.get_ydata() * 1e9, dataset["reference_pressure"][-1, 6].values, rtol=1e-12)
    np.testing.assert_allclose(computed.get_xdata() * 1e-6, dataset["x"].values, rtol=1e-12)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words[0] == "computed cells"
    assert words[1].startswith("closed form (relative difference: ")


def test_middle_of_a_symmetric_pressure_and_of_one_that_lies_or_leans_aside():
    y, x = np.ogrid[-10:11, -20:21]
    bump = np.maximum(0.0, 25.0 - x**2 - y**2)
    assert middle(bump) == (10, 20)
    assert middle(np.zeros((4, 6))) == (2, 3)
    assert middle(np.roll(bump, 3, axis=1)) == (10, 23)
    leaning = bump.copy()
    leaning[10, 24] = 60.0
    assert middle(leaning) == (10, 24)


def test_a_map_of_many_cells_is_drawn_by_evenly_spread_ones():
    side = 2.5 * DOTS
    x, y = np.meshgrid(np.arange(int(side)), np.arange(700))
    drawn = _sampled(x + 1e4 * y)
    assert drawn.shape == (700, DOTS)
    assert np.array_equal(drawn[:, 0], 1.0 + 1e4 * np.arange(700))
    assert np.all(np.abs(drawn[0] - (np.arange(DOTS) + 0.5) * 2.5) <= 1.0)
    few = y[:, :DOTS]
    assert _sampled(few) is few


def test_profiles_pass_through_the_middle_of_one_contact_and_the_largest_pressure_of_many(stored):
    def title(pressure):
        return pressure_profiles(stored(nx=32, ny=32, reference=False, pressure=pressure)).axes[0].get_title()

    leaning = title(lambda x, y: 1e9 * (np.hypot(x - 1e-6, y + 1.8e-6) < 3e-6) * (10e-6 + x + y))
    assert leaning == "along x, middle at y = -1.75 µm, the same along y"
    assert title(WINDOWS["rough"]["pressure"]).startswith("along x at y = ")


def test_the_ends_of_the_contact_are_marked_at_edges_of_cells(stored):
    dataset = stored(nx=16, ny=12)
    figure = pressure_profiles(dataset)
    ends = sorted(line.get_xdata()[0] for line in figure.axes[0].get_lines() if line.get_label() == "_contact")
    touched = np.flatnonzero(dataset["pressure"][-1, 6].values)
    cell, x = float(dataset.attrs["cell_size"][0]), dataset["x"].values
    assert np.array(ends) == close(1e6 * np.array([x[touched[0]] - cell / 2, x[touched[-1]] + cell / 2]), rel=1e-12)


def test_equal_profiles_are_drawn_once(stored):
    round_, long = (pressure_profiles(stored(**more)) for more in ({"nx": 32, "ny": 32}, WINDOWS["10:1"]))
    assert [axes.get_title() for axes in round_.axes] == ["along x, the same along y"]
    assert [axes.get_title() for axes in long.axes] == ["along x", "along y"]


@pytest.mark.slow
def test_pictures_of_a_page_have_one_width(stored, tmp_path):
    dataset = stored(regions=("line", "plane"), **WINDOWS["16x16"])
    figures = [draw(dataset) for draw in (pressure_map, pressure_profiles)]
    figures += [stress_section(dataset, "plane_1"), stress_profile(dataset, "line_0")]
    widths = set()
    for n, figure in enumerate(figures):
        save(figure, tmp_path / f"{n}.png", 50, "What it shows.")
        with Image.open(tmp_path / f"{n}.png") as picture:
            widths.add(picture.width)
            assert picture.text["Description"] == "What it shows."
    assert max(widths) - min(widths) <= 1


def test_titles_name_a_step_that_is_not_the_last(stored):
    dataset = stored(loads=(0.1, 0.65))
    titles = [pressure_map(dataset, step).axes[0].get_title() for step in (0, 1)]
    assert titles[0].endswith(" mN, step 1")
    assert titles[1].endswith(" mN")


def test_relative_difference():
    reference = np.array([[3.0, 4.0]])
    assert relative_difference(reference * 1.1, reference) == close((0.1, 0.1), rel=1e-12)
    assert np.isnan(relative_difference(reference, 0 * reference)).all()


def test_section_has_z_down_and_marks_the_maximum(stored):
    dataset = stored(regions=("plane",))
    main, bar = stress_section(dataset, "plane_0").axes
    assert main.get_ylim()[0] > main.get_ylim()[1] == 0
    assert main.get_aspect() == 1.0
    assert (main.get_xlabel(), main.get_ylabel()) == ("x [µm]", "z [µm]")
    assert bar.get_ylabel() == "Von Mises stress [GPa]"
    field = dataset["plane_0_von_mises"][-1]
    at = field.argmax(...)
    cross = next(line for line in main.get_lines() if line.get_marker() == "+")
    assert cross.get_ydata()[0] == close(1e6 * float(dataset["plane_0_z"][at["plane_0_z"]]), rel=1e-12)
    place = 1e6 * float(dataset["plane_0_z"][at["plane_0_z"]])
    assert main.get_title().endswith(f"{float(field.max()) / 1e9:.3g} GPa at z = {place:.3g} µm (cross)")
    assert len(main.texts) == 0  # words beside the cross would hide what it marks


@pytest.mark.parametrize("shape", ["depth", "volume"])
def test_other_sections(stored, shape):
    main = stress_section(stored(regions=(shape,)), f"{shape}_0").axes[0]
    assert main.get_ylabel() == ("y [µm]" if shape == "depth" else "z [µm]")
    assert main.yaxis.get_inverted() == (shape == "volume")
    assert (", z = 3.03 µm" if shape == "depth" else ", y = 0") in main.get_title()


def test_line_is_a_profile_with_depth(stored):
    dataset = stored(regions=("line",))
    stress = dataset["line_0_stress"].values.copy()
    stress[:, 3] = 0.005 * np.abs(stress).max()  # round-off of a solver
    figure = stress_profile(dataset.assign(line_0_stress=(dataset["line_0_stress"].dims, stress)), "line_0")
    main = figure.axes[0]
    assert (main.get_xlabel(), main.get_ylabel()) == ("Stress [GPa]", "z [µm]")
    assert main.yaxis.get_inverted()
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words[0] == "Von Mises stress"
    assert len(words) == 5  # two scalars and the normal components; shear vanishes on the axis


@pytest.mark.parametrize("load", [0.0, synthetic.LOAD])
@pytest.mark.parametrize("shape", ["plane", "depth", "volume", "line"])
def test_texts_of_sub_surface_pictures_do_not_overlap(stored, shape, load):
    dataset = stored(regions=(shape,), loads=(load,))
    draw = stress_profile if shape == "line" else stress_section
    assert overlaps(draw(dataset, f"{shape}_0")) == []


def test_only_what_the_results_hold_is_drawable(stored):
    regions = ("plane", "line", "points", "volume")
    assert drawable(stored(regions=regions)) == {"plane_0": "section", "line_1": "profile", "volume_3": "section"}
    assert drawable(stored()) == {}


def test_history_axes(stored):
    figure = load_history(stored(loads=(0.1, 0.4, 0.65, 0.3)))
    assert [axes.get_xlabel() for axes in figure.axes] == ["Approach [nm]", "Normal load [mN]"]
    assert [axes.get_ylabel() for axes in figure.axes] == ["Normal load [mN]", "Contact area [µm²]"]
    assert overlaps(figure) == []


@pytest.mark.parametrize(
    ("loads", "regions", "names"),
    [
        ((0.65,), (), ["pressure.png", "pressure-profiles.png"]),
        (
            (0.2, 0.65),
            ("plane", "line", "points"),
            ["pressure.png", "pressure-profiles.png", "plane_0.png", "line_1.png", "history.png"],
        ),
    ],
)
def test_all_pictures_are_written_and_not_empty(stored, tmp_path, loads, regions, names):
    before = dict(mpl.rcParams)
    described = draw_all(stored(loads=loads, regions=regions), tmp_path)
    assert dict(mpl.rcParams) == before
    assert list(described) == names
    assert sorted(path.name for path in tmp_path.glob("*.png")) == sorted(names)
    for name, sentence in described.items():
        assert sentence.endswith(".")
        with Image.open(tmp_path / name) as picture:
            pixels = np.asarray(picture.convert("L"), dtype=float)
        assert min(pixels.shape) > 300
        assert pixels.std() > 10
        edge = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
        assert edge.min() > 250, "something is cut off at the edge of the picture"


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (105e-6, "m", "105 µm"),
        (999.9999999e-9, "m", "1 µm"),
        (1.0, "m", "1 m"),
        (2500.0, "m", "2500 m"),
        (8.4696e9, "Pa", "8.47 GPa"),
        (0.65, "N", "650 mN"),
        (1.15e-10, "m2", "115 µm²"),
        (0.0, "Pa", "0 Pa"),
        (-3e6, "Pa", "-3 MPa"),
        (12.0, "1", "12"),
    ],
)
def test_engineering_units(value, unit, text):
    assert scale_for([value, 0.0, np.nan], unit).text(value) == text


@pytest.mark.parametrize(
    ("load", "names"),
    [(synthetic.LOAD, {"pressure.png", "pressure-profiles.png", "plane_0.png", "line_1.png"}), (0.0, set())],
    ids=["loaded", "without load"],
)
def test_fields_that_are_zero_everywhere_have_no_picture(stored, monkeypatch, load, names):
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda *_: None)
    assert set(draw_all(stored(loads=(load,), regions=("plane", "line")), Path())) == names
