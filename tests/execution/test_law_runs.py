"""Laws of materials in scenes: memory from step to step, halved steps, laws side by side, rigid and turned solids."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import NotConverged, PluginError, SceneError
from eigencontact.execution.interiors.swept_cells import SweptCells
from eigencontact.execution.run.driver import drive
from eigencontact.solvers.cell_sweeps import CellSweeps
from hz_1 import FRICTION, LOAD, NU, P0, RADIUS, A, E

YIELD = 0.3 * P0
STEEL = {
    "type": "yielding", "young-modulus": E, "poisson-ratio": NU, "yield-stress": YIELD, "hardening-modulus": 0.05 * E,
}  # fmt: skip
RUBBER = {"type": "stiffening", "shear-modulus": 0.3 * E, "growth": 100.0}
UP_AND_DOWN = [{"normal-load": LOAD}, {"normal-load": 0.0}]


@pytest.fixture
def laws(install):
    """Toy laws, installed as those of a stranger; a class of one's own may be put in the place of one."""

    def package(source="", classes="Yielding, Stiffening, Fibred"):
        head = "from toy_laws import *\nfrom eigencontact.errors import NotConverged\n"
        hook = f"\n@hookimpl\ndef eigencontact_register():\n    return [{classes}]\n"
        install(head + source + hook, name="eigencontact-toy-laws", entry="toy-laws")

    return package


def ball(material, radius=0.4, depth=0.45, x=0.0, **more):
    """A ball of a material, places in contact radii."""
    return {"type": "sphere", "center": [x * A, 0.0, depth * A], "radius": radius * A, "material": material, **more}


def scene(*inclusions, cells=12, window=3.2, tolerance=1e-6, **tables):
    return {
        "body1": {"young-modulus": E, "poisson-ratio": NU},
        "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": cells, "size": [window * A, window * A]},
        "steps": {"normal-load": LOAD},
        "numerics": {"tolerance": tolerance, **tables.pop("numerics", {})},
        "inclusions": list(inclusions),
    } | tables


def steps_of(*inclusions, **tables):
    """Accepted steps of a scene, none of them stored."""
    return list(drive(ec.plan(scene(*inclusions, **tables))))


def pressure_of(*inclusions, **tables):
    return steps_of(*inclusions, **tables)[-1].fields["pressure"]


@pytest.mark.slow
def test_a_law_that_acts_by_a_mean_is_told_that_of_its_own_cells(laws):
    """What is lost in every cell follows from the bell-shaped mean of what the cells of the ball remember."""
    laws(classes="Waning")
    waning = {"type": "waning", "young-modulus": 0.5 * E, "poisson-ratio": NU, "strain": 0.04}
    runs = [
        ec.run(
            scene(
                ball(waning | {"radius": width * A}, 0.8, 0.9),
                numerics={"allow_coarse": True},
                output={"pictures": False},
            )
        )
        for width in (0.6, 0.01)
    ]
    for data, width in zip((run.dataset for run in runs), (0.6, 0.01), strict=True):
        strained, lost = (data[f"{name}_1"].values[0] for name in ("strained", "lost"))
        inside = np.argwhere(strained > 0)
        places = np.stack([data[f"cells_1_{axis}"].values[inside[:, n]] for n, axis in enumerate("zyx")], axis=-1)
        squared = np.sum((places[:, None] - places[None]) ** 2, axis=-1)
        weight = np.maximum(1 - squared / (width * A) ** 2, 0.0) ** 2
        mean = weight @ strained[strained > 0] / weight.sum(axis=1)
        np.testing.assert_allclose(lost[strained > 0], 0.5 * (1 - np.exp(-mean / 0.04)), rtol=1e-4)
        assert not lost[strained == 0].any()
    wide, narrow = (run.dataset["lost_1"].values for run in runs)
    assert 0.05 < wide.max() < 0.97 * narrow.max() < 0.45
    told = [[warning["code"] for warning in run.summary["warnings"]] for run in runs]
    assert ["law-length" in codes for codes in told] == [False, True]


def test_a_body_that_yields_keeps_what_it_has_yielded(laws):
    laws()
    region = {"name": "cut", "shape": "plane", "depth-max": A, "depth-cells": 6}
    result = ec.run(scene(ball(STEEL), cells=10, steps=UP_AND_DOWN, stress=region, output={"history": "all"}))
    data = result.dataset
    strain, hardening = data["plastic_strain_1"], data["hardening_1"]
    assert (strain.attrs["units"], hardening.attrs["units"]) == ("1", "Pa")
    assert strain.attrs["long_name"] == "plastic strain, Mandel components"
    assert strain.dims[:2] == ("history_step", "mandel")
    loaded = strain.values[0]
    assert np.abs(loaded).max() > 1e-3
    np.testing.assert_allclose(loaded[:3].sum(axis=0), 0.0, atol=1e-12)
    first, second = hardening.values
    assert first.min() == 0.0
    assert np.all(second >= first)
    # Mises' stress is at most the yield stress, which has grown in each cell by what is stored.
    flowed = np.sqrt(2 / 3) * np.linalg.norm(loaded, axis=0)
    np.testing.assert_allclose(first, 0.05 * E * flowed, rtol=0, atol=1e-6 * first.max())
    assert data["pressure"][0].values.max() < 0.99 * pressure_of(cells=10).max()
    # A dent and a residual stress are left without load.
    assert float(data["pressure"][1].max()) == 0.0
    assert result.summary["max_sink"] > 1e-3 * A
    assert float(data["cut_von_mises"][1].max()) > 0.05 * YIELD


@pytest.mark.slow
def test_halves_begin_from_what_is_stored(laws):
    """A law that goes no further than half a step at once: the run is that of two increments."""
    laws("""
class Patient(Yielding):
    key = "patient"
    def update(self, strain, before, step):
        if step.duration > 0.5:
            raise NotConverged("in haste")
        return super().update(strain, before, step)
""", "Patient")  # fmt: skip
    patient = STEEL | {"type": "patient"}
    tables = {"tolerance": 1e-9, "cells": 10}
    halved = steps_of(ball(patient), steps=UP_AND_DOWN, **tables)
    slow = steps_of(ball(patient), steps=[{**step, "increments": 2} for step in UP_AND_DOWN], **tables)
    assert [step.scalars["substeps"] for step in halved] == [2, 2]
    assert [step.scalars["substeps"] for step in slow] == [1, 1, 1, 1]
    for name in ("plastic_strain_1", "hardening_1", "equivalent_eigenstrain_1"):
        one, other = (steps[-1].history[name].values for steps in (halved, slow))
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-6 * np.abs(other).max(), err_msg=name)


def test_within_an_increment_a_law_is_asked_with_what_was_stored_before(laws):
    """Whatever the attempts, variables before are those of the last accepted increment."""
    laws("""
asked = []
class Watched(Yielding):
    key = "watched"
    def update(self, strain, before, step):
        times = step.time - step.duration, step.time
        asked.append((times, hasattr(step, "fraction"), before["hardening"].sum()))  # whole and cut cells
        if step.duration > 0.5:
            raise NotConverged("in haste")
        return super().update(strain, before, step)
""", "Watched")  # fmt: skip
    (step,) = steps_of(ball(STEEL | {"type": "watched"}), cells=10)
    import eigencontact_toy_laws as module

    sums = {}
    for times, cut, total in module.asked:
        sums.setdefault(times, {}).setdefault(cut, set()).add(float(total))
    assert set(sums) == {(0.0, 0.0), (0.0, 1.0), (0.0, 0.5), (0.5, 1.0)}
    for times in ((0.0, 0.0), (0.0, 1.0), (0.0, 0.5)):
        assert set.union(*sums[times].values()) == {0.0}
    assert set(sums[0.5, 1.0]) == {False, True}
    middle = 0.0
    for totals in sums[0.5, 1.0].values():
        (total,) = totals
        middle += total
    assert 0.0 < middle < step.history["hardening_1"].values.sum()


def test_a_run_continues_from_what_is_stored(laws, tmp_path, monkeypatch):
    laws()
    tables = scene(ball(STEEL), cells=8, steps=[{"normal-load": LOAD}, {"normal-load": 1.2 * LOAD}])
    tables["output"] = {"pictures": False, "vtk": False}
    whole = list(drive(ec.plan(tables)))[-1]

    class Interrupted(Exception):
        pass

    class Watcher:
        def step_started(self, point, total):  # noqa: ARG002
            if point.index == 2:
                raise Interrupted

        def iterated(self, text, residual, tolerance):
            pass

        def step_finished(self, record, total):
            pass

    with pytest.raises(Interrupted):
        ec.run(tables, tmp_path / "out", watcher=Watcher())
    again = ec.run(tables, tmp_path / "out", resume=True).dataset
    for name in ("pressure", "residual_displacement_z"):
        np.testing.assert_array_equal(again[name][-1], whole.fields[name], err_msg=name)
    for name in ("plastic_strain_1", "hardening_1", "equivalent_eigenstrain_1"):
        np.testing.assert_array_equal(again[name][-1], np.squeeze(whole.history[name].values), err_msg=name)


ELASTIC = {"young-modulus": E, "poisson-ratio": NU}
LOADED = {
    "normal": {},
    "friction": FRICTION,
    "body 2": {"body2": ELASTIC},
    "prestrain alone": {"geometry": None, "steps": None, "grid": {"cells": 12, "spacing": [0.25 * A, 0.25 * A]}},
}


@pytest.mark.parametrize(
    "case", [*(pytest.param(case, marks=pytest.mark.slow) for case in ("normal", "friction")), *list(LOADED)[2:]]
)
def test_a_law_that_happens_to_be_linear_gives_what_the_linear_law_gives(laws, case):
    """Hooke's law with ν = 0, asked point by point, and by its factors; whole cells, as the block fills them."""
    laws()
    tables = {"tolerance": 1e-8, "window": 3.0, **LOADED[case]}
    block = {"type": "cuboid", "center": [0.0, 0.0, 0.75 * A], "edges": [1.5 * A, 1.5 * A, A], "eigenstrain": 1e-3}
    block |= {"body": 2 if case == "body 2" else 1}
    asked = {"type": "stiffening", "shear-modulus": 0.2 * E, "growth": 0.0}
    known = {"young-modulus": 0.4 * E, "poisson-ratio": 0.0}

    def last(material):
        built = scene(block | {"material": material}, **tables)
        found = list(drive(ec.plan({name: table for name, table in built.items() if table is not None})))[-1]
        return found.fields, found.history[f"equivalent_eigenstrain_{block['body']}"].values

    (one, cells), (other, expected) = last(asked), last(known)
    np.testing.assert_allclose(cells, expected, rtol=0, atol=1e-6 * np.abs(expected).max())
    assert expected.any()
    for name in ("pressure", "shear_x", "residual_displacement_z"):
        if name in other:
            size = np.abs(other[name]).max()
            np.testing.assert_allclose(one[name], other[name], rtol=0, atol=2e-6 * size, err_msg=name)


def test_laws_side_by_side_are_stored_in_one_field(laws):
    laws()
    other = STEEL | {"yield-stress": 10 * YIELD}
    balls = ball(STEEL, 0.3, 0.4, -0.4), ball(other, 0.3, 0.4, 0.4), ball(RUBBER, 0.3, 1.2)
    hardening = steps_of(*balls)[-1].history["hardening_1"]
    left = hardening.coords["x"] < 0.0
    assert hardening.values[..., left].max() > 1e6
    assert hardening.values[..., ~left].max() == 0.0


CLASHES = {
    "unit": ('Variable(unit="1", meaning="a number")', r"equals that of 'yielding' of 'one', \[Pa\] with 1"),
    "components": ('Variable(unit="Pa", meaning="two", components=2)', r"\(got \"'clashing': \[Pa\] with 2\"\)"),
}


@pytest.mark.parametrize("case", CLASHES)
def test_variables_of_one_name_and_other_units_or_components_are_refused(laws, case):
    variable, message = CLASHES[case]
    laws(f"""
class Clashing(Stiffening):
    key = "clashing"
    variables = {{"hardening": {variable}}}
""", "Yielding, Clashing")  # fmt: skip
    clashing = RUBBER | {"type": "clashing"}
    both = ball(STEEL, 0.2, name="one"), ball(clashing, 0.2, x=0.5, name="two")
    where = r"material of inclusion 'two' \(second\)"
    with pytest.raises(SceneError, match=f"{where} must be of a law whose variable .*{message}"):
        ec.plan(scene(*both))
    elastic = {"body2": {"young-modulus": E, "poisson-ratio": NU}}
    ec.plan(scene(both[0], both[1] | {"body": 2}, **elastic))


def test_a_variable_by_the_name_of_what_is_stored_anyway_is_refused(laws):
    laws("""
class Bold(Stiffening):
    key = "bold"
    variables = {"equivalent_eigenstrain": Variable(unit="1", meaning="mine", components=6)}
""", "Bold")  # fmt: skip
    words = r"inclusions.material must be of a law with another name for its variable.* \(got 'bold'\)"
    with pytest.raises(SceneError, match=words):
        ec.plan(scene(ball(RUBBER | {"type": "bold"})))


def test_a_region_whose_law_fills_no_cell_is_refused_by_name(laws):
    laws()
    film = {"type": "cuboid", "center": [0.0, 0.0, 0.5 * A], "edges": [A, A, 0.1 * A]}
    with pytest.raises(SceneError, match="cells must be fine enough for 'film' to fill half of a cell"):
        ec.run(
            scene(
                film | {"name": "film", "material": STEEL}, numerics={"inclusion-pitch": 0.3 * A, "allow-coarse": True}
            )
        )


@pytest.mark.parametrize(
    ("body", "message"),
    [("return Response(stress=strain[:3], tangent=np.eye(6))", r"stress of constitutive law 'broken' must be of shape"),
     ("return Response(stress=np.nan * strain, tangent=np.eye(6))", r"'broken' must answer with finite numbers"),
     ("raise KeyError('mine')", r"update of constitutive law 'broken' .* exception \(got KeyError: 'mine', line")],
    ids=["shape", "NaN", "error"],
)  # fmt: skip
def test_a_broken_law_is_named_and_nothing_is_halved(laws, body, message):
    laws(f"""
class Broken(Stiffening):
    key = "broken"
    def update(self, strain, before, step):
        {body}
""", "Broken")  # fmt: skip
    with pytest.raises(PluginError, match=message):
        ec.run(scene(ball(RUBBER | {"type": "broken"})))


def test_a_law_that_finds_no_stress_ends_the_run_by_name(laws):
    laws("""
class Stubborn(Stiffening):
    key = "stubborn"
    def update(self, strain, before, step):
        if step.time > 0.0:
            raise NotConverged("constitutive law 'stubborn' found no stress")
        return super().update(strain, before, step)
""", "Stubborn")  # fmt: skip
    with pytest.raises(NotConverged, match="constitutive law 'stubborn' found no stress"):
        ec.run(scene(ball(RUBBER | {"type": "stubborn"})))


def test_a_rigid_ball_is_the_limit_of_stiff_ones():
    rigid, stiff = (
        pressure_of(ball(law, 0.3, 0.6))
        for law in ({"type": "rigid"}, {"young-modulus": 1e5 * E, "poisson-ratio": 0.2})
    )
    np.testing.assert_allclose(rigid, stiff, rtol=0, atol=1e-4 * stiff.max())
    assert rigid.max() > 1.02 * pressure_of().max()


def test_three_planes_of_symmetry_turn_with_their_axes():
    """Turned by a right angle about z, everything is transposed; with equal constants it is isotropic."""
    ply = {
        "type": "orthotropic", "moduli": [3 * E, 0.3 * E, 0.5 * E], "poisson-ratios": [0.25, 0.2, 0.3],
        "shear-moduli": [0.4 * E, 0.3 * E, 0.2 * E],
    }  # fmt: skip
    turned = {"x-axis": [0.0, 1.0, 0.0], "y-axis": [1.0, 0.0, 0.0]}
    one, other = (pressure_of(ball(law)) for law in (ply, ply | turned))
    np.testing.assert_allclose(other, one.T, rtol=0, atol=1e-5 * P0)
    assert np.abs(one - one.T).max() > 1e-3 * P0
    alike = {"moduli": [0.5 * E] * 3, "poisson-ratios": [NU] * 3, "shear-moduli": [0.25 * E / (1 + NU)] * 3}
    plain = {"young-modulus": 0.5 * E, "poisson-ratio": NU}
    one, other = (pressure_of(ball(law)) for law in (ply | alike, plain))
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-6 * P0)


@pytest.fixture
def lost(monkeypatch):
    """Sweeps that lose their way at the fifth, eigenstrain and all; counts of sweeps, and of solves as a whole."""
    sweep, solve, calls = CellSweeps.sweep, SweptCells.solve, {"sweeps": 0, "solves": 0}

    def swept(self, *arguments):
        calls["sweeps"] += 1
        if calls["sweeps"] == 5:
            arguments[0][:] = np.nan
            raise NotConverged("lost")
        return sweep(self, *arguments)

    def solved(self, *arguments):
        calls["solves"] += 1
        return solve(self, *arguments)

    monkeypatch.setattr(CellSweeps, "sweep", swept)
    monkeypatch.setattr(SweptCells, "solve", solved)
    return calls


def test_where_sweeps_lose_their_way_linear_cells_are_solved_as_a_whole(lost, monkeypatch):
    soft = {"young-modulus": 0.5 * E, "poisson-ratio": NU}
    (found,) = steps_of(ball(soft), tolerance=1e-8)
    assert lost["sweeps"] == 5
    assert lost["solves"] >= 2
    assert found.scalars["substeps"] == 1
    monkeypatch.undo()
    expected = pressure_of(ball(soft), tolerance=1e-8)
    np.testing.assert_allclose(found.fields["pressure"], expected, rtol=0, atol=1e-6 * P0)


@pytest.mark.slow
def test_beside_a_law_that_is_swept_again_it_begins_anew(lost, laws, monkeypatch):
    """Body 1 yields and is swept in both attempts, body 2 is solved as a whole in the second."""
    laws()
    tables = {"body2": {"young-modulus": E, "poisson-ratio": NU}, "tolerance": 1e-8, "cells": 10}
    balls = ball(STEEL), ball({"young-modulus": 0.5 * E, "poisson-ratio": NU}, body=2)
    (found,) = steps_of(*balls, **tables)
    assert lost["solves"] >= 2
    assert found.scalars["substeps"] == 1
    monkeypatch.undo()
    (swept,) = steps_of(*balls, **tables)
    hardest, expected = (step.history["hardening_1"].values.max() for step in (found, swept))
    assert hardest == close(expected, rel=1e-5)
    np.testing.assert_allclose(found.fields["pressure"], swept.fields["pressure"], rtol=0, atol=1e-6 * P0)
