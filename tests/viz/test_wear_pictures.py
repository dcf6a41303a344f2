"""Pictures of wear, from real runs on few cells: what is drawn when, and that it is what was stored."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL
from close import close
from eigencontact.reports.columns import cards, columns, telling
from eigencontact.results.course import course_table
from eigencontact.viz.animation import subject_of, thinned
from eigencontact.viz.figures import draw_all
from eigencontact.viz.frame import Film, Frame
from eigencontact.viz.friction import dissipation_map
from eigencontact.viz.friction_history import fretting_loops
from eigencontact.viz.style import COLOURS, scale_for
from eigencontact.viz.wear import loop_cycles, wear_history, worn_coating, worn_loops, worn_map, worn_profiles
from eigencontact.viz.worn import course, ends_of_cycles, initial_separation, interfaces, solved_cycles, wears
from viz.test_figures import overlaps

RADIUS = 200e-6
#: Increments of a cycle.
CYCLE = [{"shift_x": 0.5e-6, "increments": 2}, {"shift_x": -0.5e-6, "increments": 3}, {"shift_x": 0.0, "increments": 1}]
CYCLE_STEPS = sum(ramp["increments"] for ramp in CYCLE)
SHARES = {"body1": 0.7, "body2": 0.3}


@pytest.fixture(scope="module")
def worn():
    """Runs in which both bodies wear: fretting of which some cycles are solved; a coated body slid upon."""
    known = {}
    layer = {"type": "bonded-layers", "layers": [{"thickness": 4e-6, **{k: 2 * v for k, v in STEEL.items() if v > 1},
                                                  "poisson_ratio": 0.3}], "substrate": STEEL}  # fmt: skip

    def run(kind):
        if kind not in known:
            scene = {
                "body1": STEEL, "body2": {"rigid": True}, "geometry": {"type": "sphere", "radius": RADIUS},
                "friction": {"type": "coulomb", "coefficient": 0.5},
                "grid": {"cells_per_contact_radius": 6, "margin": 1.7}, "numerics": {"coupling": "partial"},
            }  # fmt: skip
            if kind == "frets":
                scene["wear"] = {
                    "type": "dissipated-energy",
                    "coefficient": 2e-11,
                    "shares": SHARES,
                    "cycles_per_update": 4,
                }
                scene["steps"] = [{"normal_load": 12.307}, {"cycle": CYCLE, "repeat": 12}]
            else:
                del scene["friction"]
                scene["wear"] = {"type": "archard", "coefficient": 2.5e-16, "shares": SHARES}
            if kind == "slides":
                scene["body1"] = {"medium": layer}
                scene["steps"] = [{"normal_load": 12.307, "sliding_distance": 0.4, "increments": 3}]
            if kind == "has a coating of cells":
                scene["inclusions"] = [{"type": "cuboid", "center": [0, 0, 2e-6], "edges": [40e-6, 60e-6, 4e-6],
                                        "material": {**STEEL, "young_modulus": 420e9}}]  # fmt: skip
                scene["steps"] = [{"normal_load": 12.307}, {"normal_load": 12.307, "sliding_distance": 0.4}]
                scene["numerics"] = {"inclusion_pitch": 4e-6}
            if kind == "travels":
                scene["grid"] = {"cells": [20, 14], "spacing": [4e-6, 4e-6]}
                scene["wear"]["coefficient"] = 5e-13
                travel = [{"normal_load": 12.307, "travel_x": x, "increments": n} for x, n in ((-8e-6, 1), (8e-6, 4))]
                scene["numerics"]["allow_coarse"] = True
                scene["steps"] = travel
            known[kind] = ec.run(scene).dataset
        return known[kind]

    return run


@pytest.mark.parametrize("kind", ["frets", "slides", "travels", "has a coating of cells"])
@pytest.mark.parametrize("step", [0, 1, -1])
def test_the_initial_separation_is_that_of_the_sphere_where_it_is(worn, kind, step):
    dataset = worn(kind)
    y, x = np.meshgrid(dataset["y"], dataset["x"], indexing="ij")
    x = x - (float(dataset["travel_x"][step]) if kind == "travels" else 0.0)
    np.testing.assert_allclose(initial_separation(dataset, step), (x**2 + y**2) / (2 * RADIUS), atol=1e-15)
    assert wears(dataset)


def test_solved_cycles_are_found_with_the_number_of_cycles_done(worn):
    """Of 12 cycles the first two and the last are solved, and others one in four."""
    dataset, cycles = worn("frets"), solved_cycles(worn("frets"))
    assert [cycle.last - cycle.first + 1 for cycle in cycles] == [6] * len(cycles)
    assert [cycle.first for cycle in cycles] == list(range(1, dataset.sizes["step"], 6))
    done = [cycle.cycle_count for cycle in cycles]
    assert done[:2] == [1, 2]
    assert done[-1] == 12
    assert done == sorted(set(done))
    assert len(done) < 12
    assert ends_of_cycles(dataset).tolist() == [0, *(cycle.last for cycle in cycles)]
    # Every cycle ends where it is shifted back.
    np.testing.assert_allclose(dataset["shift_x"].values[[cycle.last for cycle in cycles]], 0.0, atol=1e-15)
    assert loop_cycles(dataset) == cycles


def test_what_the_history_goes_by(worn):
    values, words, unit = course(worn("frets"))
    assert (values[-1], words, unit) == (12, "Cycles", "1")
    values, words, unit = course(worn("slides"))
    assert (words, unit) == ("Sliding distance", "m")
    np.testing.assert_allclose(values, np.array([1, 2, 3]) * 0.4 / 3, rtol=1e-12)


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        ("frets", ["worn-depth.png", "worn-profiles.png", "wear-history.png"]),
        pytest.param(
            "has a coating of cells", ["worn-depth.png", "worn-profiles.png", "worn-coating.png"],
            marks=pytest.mark.slow,
        ),
        ("slides", ["worn-depth.png", "worn-profiles.png", "worn-coating.png", "wear-history.png"]),
    ],
)  # fmt: skip
def test_which_pictures_wear_gets(worn, monkeypatch, kind, names):
    seen = []
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda figure, path, *_: seen.append((path.name, figure)))
    assert [name for name in draw_all(worn(kind), Path()) if name.startswith("w")] == names
    for name, figure in seen:
        if name in names:
            assert overlaps(figure) == [], name


def line(axes, label):
    (found,) = [item for item in axes.get_lines() if item.get_label() == label]
    return 1e-6 * found.get_xdata(), found.get_ydata()


@pytest.mark.parametrize("along", ["x", "y"])
def test_profiles_are_the_surfaces_of_both_bodies(worn, along):
    dataset = worn("slides")
    (title, _) = (axes.get_title() for axes in worn_profiles(dataset).axes)
    assert title.endswith(", the same along y")
    dataset = dataset.assign(worn_depth_2=dataset["worn_depth_2"] * (1 + 0.2 * dataset["x"] / dataset["x"].max()))
    above, below = np.reshape(worn_profiles(dataset).axes, (2, 2))[:, "xy".index(along)]
    across = {"x": "y", "y": "x"}[along]
    last = dataset.isel({"step": -1, across: dataset.sizes[across] // 2})
    at, first = line(above, "surface of body 1")
    depth = {body: last[f"worn_depth_{body}"].sel({along: at}, method="nearest").values for body in (1, 2)}
    np.testing.assert_allclose(1e-6 * first, depth[1], rtol=1e-12, atol=1e-18)
    height = (at**2 + float(last[across]) ** 2) / (2 * RADIUS) + depth[2]
    np.testing.assert_allclose(1e-6 * line(above, "surface of body 2")[1], -height, atol=1e-14)
    assert above.get_ylim()[0] > above.get_ylim()[1]
    assert (above.get_ylabel(), below.get_ylabel()) == (("z [µm]", "Worn depth [nm]") if along == "x" else ("", ""))
    for body in (1, 2):
        np.testing.assert_allclose(1e-9 * line(below, f"lost by body {body}")[1], depth[body], rtol=1e-12, atol=1e-18)


def test_the_interface_of_a_coating_stays_where_it_was(worn):
    dataset = worn("slides")
    assert interfaces(dataset, 1) == (close(4e-6, rel=1e-12),)
    assert interfaces(dataset, 2) == ()
    axes = worn_coating(dataset).axes[0]
    np.testing.assert_allclose(line(axes, "interface of layers")[1], 4.0, rtol=1e-12)
    assert axes.get_ylim()[0] > 4.0


def test_the_interface_of_a_coating_of_cells_is_that_of_its_shape(worn):
    """A cuboid of 40 x 60 um, 4 um deep: its bottom and sides, not its face at the surface."""
    dataset = worn("has a coating of cells")
    for axes, reach in zip(worn_coating(dataset).axes, (20e-6, 30e-6), strict=True):
        at, depth = line(axes, "interface of layers")
        assert np.nanmax(depth) == close(4.0, rel=1e-9)
        bottom = depth > 3.999
        assert (at[bottom].min(), at[bottom].max()) == (close(-reach, rel=1e-6), close(reach, rel=1e-6))
        assert np.nanmin(depth) < 0.5
        assert np.count_nonzero(np.abs(at) < 0.9 * reach) == np.count_nonzero(bottom & (np.abs(at) < 0.9 * reach))


def test_the_history_shows_the_ends_of_cycles(worn):
    dataset, figure = worn("frets"), wear_history(worn("frets"))
    ends = ends_of_cycles(dataset)
    units = {"worn_volume": 1e-18, "max_worn_depth": 1e-9, "max_pressure": 1e9, "contact_area": 1e-12}
    for axes, (name, unit) in zip(figure.axes, units.items(), strict=True):
        (curve,) = axes.get_lines()
        np.testing.assert_array_equal(curve.get_xdata(), dataset["cycles"].values[ends])
        np.testing.assert_allclose(unit * curve.get_ydata(), dataset[name].values[ends], rtol=1e-12)
    assert figure.axes[0].get_ylabel() == "Worn volume [µm³]"
    assert figure.axes[2].get_xlabel() == "Cycles"


def test_loops_of_cycles_begin_where_the_last_one_ended_and_are_coloured_by_number(worn):
    dataset, chosen = worn("frets"), loop_cycles(worn("frets"))
    main, bar = worn_loops(dataset).axes
    loops = [item for item in main.get_lines() if len(item.get_xdata()) > 2]
    assert len(loops) == len(chosen)
    for loop, cycle in zip(loops, chosen, strict=True):
        part = slice(cycle.first - 1, cycle.last + 1)
        np.testing.assert_allclose(1e-9 * loop.get_xdata(), dataset["shift_x"].values[part], atol=1e-18)
        np.testing.assert_allclose(loop.get_ydata(), dataset["tangential_load_x"].values[part], rtol=1e-12, atol=1e-12)
    colours = [mpl.colors.to_hex(loop.get_color()) for loop in loops]
    assert len(set(colours)) == len(chosen)
    assert colours[0] == mpl.colors.to_hex(mpl.colormaps["viridis"](0.0))
    numbers = [text.get_text() for text in bar.get_yticklabels()]
    assert set(numbers) <= {f"{cycle.cycle_count:g}" for cycle in chosen}
    assert numbers[-1] == "12"
    assert bar.get_ylabel() == "Cycle"


def test_the_map_says_volume_and_depth(worn):
    dataset = worn("frets")
    figure = worn_map(dataset)
    image = figure.axes[0].images[0].get_array()
    depth = dataset["worn_depth"][-1].values
    assert float(image.max()) * 1e-9 == close(depth.max(), rel=1e-12)
    assert image.count() == np.count_nonzero(depth > 1e-3 * depth.max())
    volume = 1e18 * depth.sum() * float(np.prod(dataset.attrs["cell_size"]))
    title = f"Wear, 12 cycles\n{volume:.3g} µm³ lost, at most {1e9 * depth.max():.3g} nm deep"
    assert figure.axes[0].get_title() == title


def test_the_work_of_friction_counts_the_skipped_cycles(worn):
    """The map is of the solved increments; its title tells their work apart from that of all cycles."""
    dataset = worn("frets")
    solved, whole = float(dataset["dissipated_energy"][-1]), float(dataset["wear_energy"][-1])
    assert whole > 1.2 * solved
    heading, numbers = dissipation_map(dataset).axes[0].get_title().split("\n")
    assert heading.startswith("Work of friction in the solved increments at ")
    texts = [scale_for([value], "J").text(value) for value in (whole, solved)]
    assert numbers == f"{texts[0]} in all, with skipped cycles; {texts[1]} in the solved increments"
    scalars = [name for name, variable in dataset.data_vars.items() if variable.dims == ("step",)]
    rows = [{name: float(dataset[name][n]) for name in scalars} | {"step": n + 1} for n in range(dataset.sizes["step"])]
    assert float(course_table(rows).splitlines()[-1].split()[-2]) == close(1e6 * whole, rel=1e-3)
    assert course_table(rows).splitlines()[1].split()[-2] == "uJ"


def test_the_report_shows_the_work_beside_the_volume_that_it_wore(worn):
    names = [column.name for column in cards(telling(columns(worn("frets"))))]
    assert "wear_energy" in names
    assert "dissipated_energy" not in names


def test_an_animation_has_the_ends_of_cycles_and_scales_that_stay(worn):
    dataset = worn("frets")
    subject, film = subject_of(dataset), Film(dataset, thinned(dataset))
    assert not subject.stacked
    assert subject.sentence == "Worn surfaces over the initial ones, and the contact pressure."
    assert film.steps == tuple(ends_of_cycles(dataset).tolist())
    limits = set()
    for step in (film.steps[0], film.steps[-1]):
        above, below = worn_profiles(dataset, step, Frame(film)).axes
        limits.add((above.get_xlim(), above.get_ylim(), below.get_ylim()))
    assert len(limits) == 1
    most = 1e9 * float(dataset["worn_depth_1"].max())
    assert most < below.get_ylim()[0] < 1.3 * most


def test_what_travels_is_followed_step_by_step_with_scales_that_stay(worn):
    dataset = worn("travels")
    film = Film(dataset, thinned(dataset))
    assert subject_of(dataset).stacked
    assert film.steps == tuple(range(5))
    seen = [axes.get_ylim() for step in film.steps for axes in worn_profiles(dataset, step, Frame(film)).axes]
    assert set(seen) == set(seen[:2])
    assert "nothing lost so far" in worn_profiles(dataset, 0).get_suptitle()


def test_loops_of_few_steps_have_the_colours_of_their_cycles_and_replace_the_chosen_ones(worn):
    dataset = worn("frets")
    loop, bar = fretting_loops(dataset).axes
    cycles = solved_cycles(dataset)
    curves = [line for line in loop.get_lines() if len(line.get_xdata()) == CYCLE_STEPS + 1]
    assert len(curves) == len({mpl.colors.to_hex(line.get_color()) for line in curves}) == len(cycles)
    for curve, cycle in zip(curves, cycles, strict=True):
        loads = dataset["tangential_load_x"].values[cycle.first - 1 : cycle.last + 1]
        assert curve.get_ydata() == close(loads, abs=1e-9)
    assert bar.get_ylabel() == "Cycle"


def test_loops_of_chosen_cycles_are_drawn_of_long_histories(worn, monkeypatch):
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda *_: None)
    monkeypatch.setattr("eigencontact.viz.figures.LONG_HISTORY", 20)
    assert "wear-loops.png" in draw_all(worn("frets"), Path())


def test_what_wears_nothing_has_no_points_in_the_history(worn):
    """Loading at the beginning and unloading at the end: no vertical lines, no fall to zero."""
    dataset = worn("slides").isel(step=[0, 0, 1, 2, 2])
    pressure = dataset["max_pressure"].values.copy()
    pressure[[0, 4]] = 0.5 * pressure[0], 0.0
    changed = dataset.assign(max_pressure=("step", pressure))
    for axes, name in zip(wear_history(changed).axes[2:], ("max_pressure", "contact_area"), strict=True):
        (curve,) = axes.get_lines()
        wanted = changed[name].values[1:4]
        assert curve.get_ydata() / curve.get_ydata()[0] == close(wanted / wanted[0], rel=1e-12)


def test_of_many_steps_the_last_cycle_alone_is_dark(worn, monkeypatch):
    dataset = worn("frets")
    monkeypatch.setattr("eigencontact.viz.friction_history.LONG_HISTORY", 20)
    lines = fretting_loops(dataset).axes[0].get_lines()
    dark = [item for item in lines if item.get_color() == COLOURS[0]]
    assert max(len(item.get_xdata()) for item in dark) < dataset.sizes["step"]
    (faint,) = [item for item in lines if len(item.get_xdata()) == dataset.sizes["step"]]
    np.testing.assert_allclose(1e-9 * faint.get_xdata(), dataset["shift_x"].values, atol=1e-18)


def test_a_run_without_wear_has_no_such_pictures(worn):
    dataset = worn("slides")
    assert not wears(dataset.assign(max_worn_depth=0.0 * dataset["max_worn_depth"]))
    assert not wears(dataset.drop_vars("max_worn_depth"))
