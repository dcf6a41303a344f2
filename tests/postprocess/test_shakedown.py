"""Shakedown and ratchetting of a sphere on a plastic body, and the words about it."""

import json

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.core.shakedown import STATES, cycle_response

LAW = {"type": "j2", "hardening": {"type": "perfect", "yield-stress": "7.344 GPa"}}


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    """Twice to one load, then to a larger one."""
    folder = tmp_path_factory.mktemp("pressed")
    scene = ec.load_scene("plastic-hertz").resolved()
    turns = [{"normal-load": load, "increments": count} for load, count in ((9.0, 4), (2.0, 1))]
    steps = [*turns, *turns, {"normal-load": 12.0, "increments": 2}, {"normal-load": 2.0}]
    changes = {"steps": steps, "stress": [], "grid": {"cells-per-contact-radius": 4}}
    return ec.run({**scene, **changes, "output": {"pictures": False, "history": "all"}}, folder)


def test_states_of_the_three_cycles(pressed):
    """The first pressing leaves a net increment, the second is elastic (the load is the same), the third is not."""
    states = {}
    for name, cycle in {"first": (1, 5), "second": (5, 10), "third": (10, 13)}.items():
        states[name] = ec.shakedown(pressed, cycle=cycle).summary
    assert states["first"]["state"] == states["third"]["state"] == "ratchetting"
    assert states["second"]["state"] == "elastic shakedown"
    assert states["second"]["net_increment"] < 1e-3 * states["first"]["net_increment"]


def test_increments_are_those_of_the_stored_strain(pressed):
    answer = ec.shakedown(pressed, cycle=(10, 13))
    stored = pressed.dataset["plastic_strain_1"]
    net = stored.sel(history_step=13) - stored.sel(history_step=10)
    expected = np.sqrt(2 / 3) * np.sqrt((net.values**2).sum(axis=0))
    np.testing.assert_allclose(answer.dataset.net_increment.values, expected, rtol=1e-12, atol=1e-18)
    volumes = answer.summary["volume"]
    cells = answer.dataset.state.values
    cell = np.prod(pressed.dataset.attrs["cell_size"]) * float(np.diff(answer.dataset.z.values[:2])[0])
    assert abs(volumes["ratchetting"] / (cell * np.count_nonzero(cells == 3)) - 1) < 1e-9


def test_a_closed_loop_is_plastic_shakedown():
    """A path of plastic strain that returns: growth without a net increment; one more percent of it ratchets."""
    loop = np.zeros((2, 6, 2))
    loop[1, 0, 1] = 1e-2
    response = cycle_response(np.array([[1.0, 1.0], [1.4, 1.4]]), loop, 1e-3)
    assert [STATES[state] for state in response.state] == ["plastic shakedown", "ratchetting"]


def test_command_stores_map_and_volumes(pressed, command):
    done = command("shakedown", pressed.folder, "--cycle", "10:13")
    assert done.code == 0
    assert "ratchetting" in done.out
    stored = json.loads((pressed.folder / "shakedown-body1.json").read_text(encoding="utf-8"))
    assert stored["volume"]["ratchetting"] > 0.0
    assert {path.suffix for path in pressed.folder.glob("shakedown-body1.*")} == {".nc", ".json", ".png"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [({"body": 2}, "body must be one whose law"), ({"tolerance": 0.0}, "tolerance must be between 0 and 1"),
     ({"cycle": (3, 3)}, "cycle must have at least two steps")],
)  # fmt: skip
def test_refusals(pressed, arguments, words):
    with pytest.raises(ec.EigencontactError, match=words):
        ec.shakedown(pressed, **{"cycle": (1, 5), **arguments})


def test_a_run_without_its_histories_is_refused():
    scene = ec.load_scene("plastic-hertz").resolved()
    steps = [{"normal-load": 9.0}, {"normal-load": 2.0}]
    changes = {"steps": steps, "stress": [], "grid": {"cells-per-contact-radius": 4}, "output": {"pictures": False}}
    with pytest.raises(ec.EigencontactError, match=r'output\.history = "all"'):
        ec.shakedown(ec.run({**scene, **changes}), cycle="all")
