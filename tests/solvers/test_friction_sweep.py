"""Random frictional contacts converge, all of them; judged from outside by the tractions alone."""

import os

import pytest

from solvers.friction_scenes import errors, follow, hardened, make_scene

TOLERANCE = 1e-6
#: All of them, as after a change of the solvers: RANDOM_SCENES=500.
SCENES = int(os.environ.get("RANDOM_SCENES", "150"))
#: Each solve of a coupled increment is right to a fifth of the tolerance; in contact the two agree to all of it.
ALLOWED = {"gap": 1.2, "overlap": 1.2, "stick": 1.0, "across": 1.0, "along": 1.0, "bound": 1.0}


def failures(seeds, change=lambda scene: scene):
    """Scenes that do not converge or violate a condition, in words."""
    said = []
    for seed in seeds:
        scene = change(make_scene(seed))
        try:
            found = errors(scene, follow(scene, tolerance=TOLERANCE))
        except Exception as error:  # noqa: BLE001 - told with the scene
            said.append(f"{scene}: {type(error).__name__}: {error}")
            continue
        wrong = {name: value for name, value in found.items() if not value <= ALLOWED[name] * TOLERANCE}
        if wrong:
            said.append(f"{scene}: {wrong}")
    return said


@pytest.mark.parametrize("seed", [3, 17, 78, *(pytest.param(s, marks=pytest.mark.slow) for s in (41, 137, 190))])
def test_some_random_scenes_converge(seed):
    assert failures([seed]) == []


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, SCENES, 25))
def test_hundreds_of_random_scenes_converge(first):
    assert failures(range(first, first + 25)) == []


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, SCENES // 8, 10))
def test_strongly_coupled_scenes_converge(first):
    assert failures(range(first, first + 10), hardened) == []
