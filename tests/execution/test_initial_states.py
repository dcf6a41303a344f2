"""A run that begins with the state of an earlier one: to the bit in the same cells, by means in others, refusals."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL, perfect, pressed
from close import close
from stopping import Stop, Stopper

PRAGER = [{"type": "linear", "yield-stress": "2 GPa", "modulus": "20 GPa"}, {"type": "prager", "modulus": "10 GPa"}]
LAW = {"type": "j2", "hardening": PRAGER}
PERFECT = perfect("3 GPa")
PRESS, FREE, AGAIN = {"normal_load": "0.65 N"}, {"normal_load": 0.0}, {"normal_load": "0.4 N"}
NAMES = ("plastic_strain_1", "equivalent_plastic_strain_1", "back_stress_1_1", "equivalent_eigenstrain_1")


def scene(steps, law=LAW, cells=10, initial=None, **more):
    body = {**STEEL, **({"law": law} if law else {}), **({"initial": initial} if initial else {})}
    return ec.Scene(
        **{
            **pressed(law, steps, cells),
            "body1": body,
            "numerics": {"allow_coarse": True},
            "output": {"pictures": False, "history": "all"},
            **more,
        }
    )


@pytest.fixture(scope="module")
def earlier(tmp_path_factory):
    """Loaded and unloaded, in a folder, and loaded again in one run."""
    folder = tmp_path_factory.mktemp("earlier")
    whole = ec.run(scene([PRESS, FREE, AGAIN, FREE])).dataset
    ec.run(scene([PRESS, FREE]), folder).dataset.close()
    return folder, whole


@pytest.mark.slow
def test_the_second_half_of_a_history_begins_where_the_first_ended(earlier):
    folder, whole = earlier
    found = ec.run(scene([AGAIN, FREE], initial={"results": str(folder)})).dataset
    for name in ("pressure", "displacement_z", "residual_displacement_z", "approach"):
        np.testing.assert_array_equal(found[name], whole[name][2:])
    for name in NAMES:
        np.testing.assert_array_equal(found[name], whole[name][2:])
    assert float(abs(whole["back_stress_1_1"]).max()) > 1e7


def test_a_state_under_load_is_let_go_first(earlier):
    """The state after step 1 is that of the loaded body; without load it is what unloading left."""
    folder, whole = earlier
    found = ec.run(scene([AGAIN], initial={"results": str(folder), "step": 1})).dataset
    np.testing.assert_allclose(found["pressure"][0], whole["pressure"][2], atol=1e-5 * float(whole["pressure"].max()))


@pytest.mark.slow
def test_a_resumed_run_knows_its_beginning(earlier, tmp_path):
    folder, whole = earlier
    after = scene([AGAIN, FREE], initial={"results": str(folder)})
    with pytest.raises(Stop):
        ec.run(after, tmp_path, watcher=Stopper(1))
    continued = ec.run(after, tmp_path, resume=True).dataset
    np.testing.assert_array_equal(continued["residual_displacement_z"], whole["residual_displacement_z"][2:])


@pytest.mark.parametrize("coupling", [pytest.param("none", marks=pytest.mark.slow), "full"])
def test_friction_does_not_feel_what_was_before(earlier, coupling):
    """The surface is already displaced along itself when contact begins: nothing slips by that."""
    folder, whole = earlier
    friction = {"type": "coulomb", "coefficient": 0.3}
    more = {"numerics": {"coupling": coupling}, "body2": STEEL}
    found = ec.run(
        scene([{"normal_load": "0.1 N"}], friction=friction, initial={"results": str(folder)}, **more)
    ).dataset
    assert float(abs(found["residual_displacement_x"]).max()) > 1e-9
    assert float(abs(found["shear_x"]).max()) < 1e-3 * float(found["pressure"].max())
    left = whole["residual_displacement_z"][1]
    np.testing.assert_allclose(found["residual_displacement_z"][0], left, atol=1e-4 * float(abs(left).max()))


def test_other_cells_take_means_of_a_state(earlier, tmp_path):
    """Another window, finer and to one side: what is remembered keeps its integral; the print moves with it."""
    folder, whole = earlier
    grid = {"cells": [16, 16], "size": ["24 um", "24 um"], "center": ["1 um", 0]}
    found = ec.run(scene([FREE], grid=grid, initial={"results": str(folder)})).dataset
    volumes = []
    for data, step in ((found, 0), (whole, 1)):
        edges = [float(np.diff(data[f"cells_1_{axis}"])[0]) for axis in "zyx"]
        volumes.append(np.prod(edges) * data["plastic_strain_1"][step].values.sum(axis=(1, 2, 3)))
    np.testing.assert_allclose(volumes[0], volumes[1], atol=1e-10 * float(abs(volumes[1]).max()))
    left = [float(data["residual_displacement_z"][step].max()) for data, step in ((found, 0), (whole, 1))]
    assert left[0] == close(left[1], rel=0.05)


def test_a_body_that_stays_elastic_keeps_its_print(earlier):
    folder, whole = earlier
    found = ec.run(scene([{"normal_load": "1 mN"}, FREE], initial={"results": str(folder)})).dataset
    left = whole["residual_displacement_z"][1]
    np.testing.assert_allclose(found["residual_displacement_z"][1], left, atol=1e-6 * float(abs(left).max()))


@pytest.mark.parametrize(
    ("law", "initial", "message"),
    [
        (None, {}, "body1.initial must be used with a history-dependent law"),
        (LAW, {"step": 3}, "body1.initial.step must be one that .* holds, 1 to 2"),
        (PERFECT, {}, "'back_stress_1' of body1.initial must be in cells with a law that has this variable"),
        (
            {"type": "by-depth", "interfaces": ["1 um"], "laws": [LAW, {"type": "elastic"}]},
            {},
            "of body1.initial must be in cells with a law that has this variable",
        ),
    ],
)
def test_states_that_do_not_fit_are_refused(earlier, law, initial, message):
    with pytest.raises(ec.EigencontactError, match=message):
        ec.run(scene([FREE], law=law, initial={"results": str(earlier[0]), **initial}))


def test_results_that_are_not_there_are_refused(tmp_path):
    with pytest.raises(ec.EigencontactError, match="must exist"):
        ec.explain(scene([FREE], initial={"results": str(tmp_path / "nothing")}))
    ec.run(scene([{"normal_load": "1 mN"}], law=None), tmp_path).dataset.close()
    with pytest.raises(ec.EigencontactError, match=r"body1.initial.step must be one whose history is stored"):
        ec.explain(scene([FREE], initial={"results": str(tmp_path)}))
