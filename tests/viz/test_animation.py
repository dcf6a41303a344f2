"""Animations: how many frames, of what size, with colours and axes that stay; who may be replaced; what is refused."""

import json
import sys
from functools import cache

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from PIL import Image

import eigencontact as ec
from close import close
from eigencontact.postprocess.stored_run import draw
from eigencontact.results.ownership import is_ours
from eigencontact.viz.animation import FRAMES, frames, jumps, subject_of, thinned
from eigencontact.viz.frame import Film, Frame
from eigencontact.viz.friction import shear_map
from eigencontact.viz.friction_history import fretting_loops
from eigencontact.viz.movie import LAST, LONGEST, write_movie
from eigencontact.viz.section import stress_section
from eigencontact.viz.style import new_figure
from results import synthetic
from viz.test_friction_pictures import CYCLE
from viz.test_friction_pictures import record as sheared

LOADS = (0.2, 0.65, 0.0)
#: Dots above the middle of the contact at which colours are read: the words "no contact" are in the middle.
BESIDE = 20
AGAIN = [
    "stress=[]",
    "grid.cells-per-contact-radius=6",
    "output.pictures=false",
    "output.vtk=false",
    "output.animation=true",
]


@pytest.fixture(scope="module")
def stored():
    """Made-up runs: presses and lets go, over a section where wanted; rolls; frets."""

    @cache
    def build(kind):
        count = len(CYCLE) if kind == "frets" else len(LOADS)
        info = synthetic.info(steps=count, nx=24, ny=24)
        if kind == "frets":
            records = [sheared(info, n, *point) for n, point in enumerate(CYCLE, 1)]
        else:
            regions = ("plane",) if kind != "presses" else ()
            records = [synthetic.step(info, n, load, regions, reference=False) for n, load in enumerate(LOADS, 1)]
        for n, record in enumerate(records if kind == "rolls" else (), 1):
            record.scalars.update(travel_x=1e-6 * n, travel_y=0.0)
        return synthetic.opened(info, records)

    return build


def test_long_histories_are_thinned_evenly_from_the_first_to_the_last():
    def steps(count):
        return xr.Dataset(coords={"step": range(count)})

    assert thinned(steps(7)) == tuple(range(7))
    chosen = thinned(steps(1001))
    assert len(chosen) == FRAMES == 80
    assert (chosen[0], chosen[-1]) == (0, 1000)
    assert set(np.diff(chosen)) <= {12, 13}


@pytest.mark.parametrize(
    ("kind", "sentence", "stacked"),
    [
        ("presses", "Contact pressure through the load history.", True),
        ("over a section", "Contact pressure, over the stress on 'plane_0'.", True),
        ("rolls", "Contact pressure as the geometry travels, over the stress on 'plane_0'.", True),
        ("frets", "Shear over stick and slip, beside the loop.", False),
    ],
)
def test_what_a_history_shows(stored, kind, sentence, stacked):
    subject = subject_of(stored(kind))
    assert (subject.sentence, subject.stacked, len(subject.pictures)) == (sentence, stacked, 2)
    assert subject_of(stored(kind).isel(step=[0])) is None


def test_a_history_of_what_yields_shows_load_and_depth(stored):
    dataset = stored("over a section").assign(equivalent_plastic_strain_1=0.0)
    assert subject_of(dataset).sentence == "Load against depth, beside the stress on 'plane_0'."


@pytest.mark.parametrize(("kind", "label"), [("rolls", "Contact pressure [GPa]"), ("frets", "Shear traction [")])
def test_frames_of_one_row_of_cells_have_a_curve_on_one_scale(stored, kind, label):
    """A map of one row would be a hairline."""
    dataset = stored(kind).isel(y=[12])
    film, draw = Film(dataset, tuple(range(dataset.sizes["step"]))), subject_of(dataset).pictures[0]
    panels = [draw(step=step, on=Frame(film)).axes[0] for step in film.steps]
    assert all(not axes.images and axes.get_ylabel().startswith(label) for axes in panels)
    assert len({(*axes.get_xlim(), *axes.get_ylim()) for axes in panels}) == 1
    low, high = panels[0].get_ylim()
    drawn = [np.max(np.abs(line.get_ydata())) for axes in panels for line in axes.lines]
    assert low <= 0.0 < max(drawn) < high


@pytest.fixture(scope="module")
def filmed(stored, tmp_path_factory):
    """GIF of a load that rises and goes, and what its frames were when they were drawn."""
    dataset = stored("presses")
    seen, places = [], []

    def watched():
        for figure in frames(dataset, subject_of(dataset)):
            yield figure
            main, bar, *_ = [axes for part in figure.subfigs for axes in part.axes]
            numbers = (*main.images[0].get_clim(), *main.get_xlim(), *main.get_ylim(), *main.get_position().bounds)
            seen.append((*numbers, *bar.get_ylim(), *figure.get_size_inches(), main.get_xlabel(), bar.get_ylabel()))
            assert main.get_aspect() == 1.0
            places.append(main.transData.transform((0.0, 0.0)) + np.array([0.0, BESIDE]))

    path = tmp_path_factory.mktemp("film") / "animation.gif"
    write_movie(watched(), path)
    return path, seen, places


@pytest.mark.slow
def test_all_frames_have_one_window_and_one_scale(stored, filmed):
    """Those of the largest pressure and contact, although the last frame has none."""
    dataset, (_, seen, _) = stored("presses"), filmed
    assert len(seen) == len(LOADS)
    assert set(seen) == {seen[0]}
    assert 1e9 * seen[0][1] == close(float(dataset["pressure"].max()), rel=1e-12)
    assert seen[0][-2:] == ("x [µm]", "Pressure [GPa]")
    widest = dataset["x"].values[(dataset["pressure"].values > 0).any(axis=(0, 1))]
    assert seen[0][2] < 1e6 * widest[0]
    assert seen[0][3] > 1e6 * widest[-1]


@pytest.mark.slow
def test_a_gif_has_every_step_and_true_colours(stored, filmed):
    """The middle of the contact has in each frame the colour that its pressure has on the common scale."""
    pressure, (path, _, places) = stored("presses")["pressure"].values, filmed
    with Image.open(path) as film:
        assert film.n_frames == len(LOADS)
        assert film.info["loop"] == 0
        size = film.size
        for n, (x, y) in enumerate(places):
            film.seek(n)
            assert film.size == size
            drawn = film.convert("RGB").getpixel((round(x), size[1] - 1 - round(y)))
            middle = float(pressure[n, 11:13, 11:13].max()) / pressure.max()
            wanted = np.array(mpl.colormaps["viridis"](middle)[:3]) if middle else np.array([0.93] * 3)
            np.testing.assert_allclose(np.array(drawn) / 255, wanted, atol=0.03)
        assert film.info["duration"] == LAST


def test_labels_stay_inside_of_the_frames(stored):
    """The layout is found with the fonts of the frames, and not with those that matplotlib begins with."""
    with mpl.rc_context({"font.size": 4, "ytick.labelsize": 3, "axes.labelsize": 4}):
        drawn = frames(stored("frets"), subject_of(stored("frets")))
        figure = next(drawn)
        figure.canvas.draw()
        renderer = figure.canvas.get_renderer()
        for axes in (axes for part in figure.subfigs for axes in part.axes):
            box = axes.get_tightbbox(renderer)
            assert box.x0 > 0
            assert box.x1 < figure.bbox.x1
        drawn.close()


def test_frames_say_what_they_leave_out():
    cycles = np.array([0.0, 1.0, 2.0, 2.0, 500.0, 1000.0])
    worn = xr.Dataset({"cycles": ("step", cycles), "max_worn_depth": ("step", cycles)}, {"step": range(1, 7)})
    assert jumps(worn, (2, 4, 5)) == "Up to 500 cycles from one frame to the next"
    assert jumps(worn, (0, 1, 2)) == "3 of 6 steps have a frame"
    assert jumps(worn.drop_vars("cycles"), tuple(range(6))) == ""


def test_contours_of_stress_are_those_of_all_frames(stored):
    dataset = stored("rolls")
    film, levels = Film(dataset, thinned(dataset)), []
    for step in film.steps:
        drawn = stress_section(dataset, "plane_0", step, Frame(film)).axes[0].collections
        (filled,) = [item for item in drawn if isinstance(item, mpl.contour.ContourSet) and item.filled]
        levels.append(tuple(filled.levels))
    assert len(levels) == len(LOADS)
    assert set(levels) == {levels[0]}
    assert levels[0][-1] == close(1e-9 * float(dataset["plane_0_von_mises"].max()), rel=0.1)


@pytest.mark.slow
def test_the_loop_is_drawn_as_far_as_the_step_and_arrows_have_one_scale(stored):
    dataset = stored("frets")
    shift, load, shear = (dataset[name].values for name in ("shift_x", "tangential_load_x", "shear_x"))
    film, lengths = Film(dataset, thinned(dataset)), []
    for n in film.steps:
        *_, way, dot = fretting_loops(dataset, n, Frame(film)).axes[0].get_lines()
        np.testing.assert_allclose(1e-9 * way.get_xdata(), shift[: n + 1], rtol=1e-12)
        here = [1e-9 * dot.get_xdata()[0], 1e-3 * dot.get_ydata()[0]]
        np.testing.assert_allclose(here, [shift[n], load[n]], rtol=1e-12)
        for item in shear_map(dataset, n, Frame(film)).axes[0].collections:
            if isinstance(item, mpl.quiver.Quiver) and item.U.size:
                places = {axis: 1e-6 * item.XY[:, k] - 1e-9 for k, axis in enumerate("xy")}
                row, column = (np.searchsorted(dataset[axis], places[axis]) for axis in "yx")
                lengths.extend(item.U / shear[n, row, column])
    assert len(lengths) > 500
    np.testing.assert_allclose(lengths, lengths[0], rtol=1e-9)


def test_a_run_lists_its_animation_and_replaces_no_file_of_others(tmp_path):
    scene = ec.load_scene("hertz", [*AGAIN, "steps.increments=2"])
    (tmp_path / "animation.gif").write_bytes(b"mine")
    with pytest.raises(ec.EigencontactError, match=r"animation\.gif must be a file that eigencontact wrote"):
        ec.run(scene, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["animation.gif"]
    (tmp_path / "animation.gif").unlink()
    ec.run(scene, tmp_path)
    assert "animation.gif" in json.loads((tmp_path / "summary.json").read_text())["files"]
    (tmp_path / "summary.json").unlink()
    assert is_ours(tmp_path / "animation.gif")
    with Image.open(tmp_path / "animation.gif") as film:
        assert film.n_frames == 2


def test_what_cannot_be_shown_is_refused_before_the_run(tmp_path, monkeypatch):
    with pytest.raises(ec.EigencontactError, match=r"output\.animation must be false where .* load steps of 1\)"):
        ec.run(ec.load_scene("hertz", AGAIN), tmp_path / "one")
    monkeypatch.setattr("shutil.which", lambda _name: None)
    changes = [*AGAIN, "steps.increments=2", "output.animation='mp4'"]
    with pytest.raises(ec.EigencontactError, match=r"output\.animation must be 'gif' where the program ffmpeg is not"):
        ec.run(ec.load_scene("hertz", changes), tmp_path / "none")
    assert not list(tmp_path.iterdir())
    with pytest.raises(ec.EigencontactError, match=r"output.animation must be one of .* did you mean 'gif'"):
        ec.load_scene("hertz", ["output.animation='git'"])


def test_plot_refuses_one_step_before_anything_is_drawn(tmp_path):
    ec.run(ec.load_scene("hertz", AGAIN[:-1]), tmp_path)
    before = sorted(tmp_path.iterdir())
    with pytest.raises(ec.EigencontactError, match="animation must be of several load steps"):
        draw(tmp_path, animation=True)
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("fails", [False, True])
def test_mp4_is_what_ffmpeg_makes_of_the_frames(tmp_path, monkeypatch, fails):
    """A program in its place answers with its arguments and the number of bytes that it was given."""
    program = tmp_path / "ffmpeg"
    ending = "sys.exit('no such codec')" if fails else ""
    program.write_text(
        f"#!{sys.executable}\nimport sys\nprint(' '.join(sys.argv[1:]), len(sys.stdin.buffer.read()))\n{ending}\n"
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    film, path = [new_figure(0.2, 0.1)] * 4, tmp_path / "animation.mp4"
    if fails:
        with pytest.raises(ec.EigencontactError, match=r"ffmpeg must write the animation \(got: no such codec\)"):
            write_movie(film, path)
        assert not path.exists()
        return
    write_movie(film, path)
    said = path.read_text().split()
    assert said[said.index("-s") + 1] == "20x10"
    assert int(said[-1]) == 3 * 20 * 10 * (len(film) + LAST // LONGEST)
    assert is_ours(path)
