"""Messages of solvers about a step name its table and key in the scene; loads of line contacts are per length."""

import pytest

import eigencontact as ec

COARSE = ["grid.cells-per-contact-radius=8", "stress=[]", "observers=[]", "output.pictures=false"]


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        (["steps.2.tangential-load-x=-400e3", "steps.2.increments=2"], "steps.2.tangential-load-x, at load step 12,"),
        (["steps.1.increments=1", "steps.1.tangential-load-x=400e3"], "steps.1.tangential-load-x, at load step 2,"),
        (
            ["steps=[{normal-load=400e3},{cycle=[{tangential-load-x=100e3},{tangential-load-x=400e3}],repeat=2}]"],
            "steps.1.cycle.1.tangential-load-x, at load step 3,",
        ),
    ],
)  # fmt: skip
def test_more_than_friction_carries(changes, place):
    with pytest.raises(ec.EigencontactError) as caught:
        ec.run(ec.load_scene("cylinder-fretting", [*COARSE, "steps.1.increments=9", *changes]))
    message = str(caught.value)
    assert message.startswith(f"{place} must be below what friction carries together (got tangential-load-x ")
    assert message.endswith("of at most 320000 N/m); lower it, or prescribe shift-x to slide")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("steps.0.normal-load=-1", "steps.0.normal-load must be zero or positive, and finite [N/m] (got -1)"),
        ("steps.1.tangential-load-x=nan", "steps.1.tangential-load-x must be finite [N/m] (got nan)"),
        (
            "steps.1.tangential-load-x=1e290",
            "steps.1.tangential-load-x must be of a size up to 1e+30 [N/m] (got 1e+290)",
        ),
    ],
)
def test_loads_of_a_line_are_per_length(change, words):
    with pytest.raises(ec.EigencontactError) as caught:
        ec.load_scene("cylinder-fretting", [change])
    assert words in str(caught.value)
    assert "[N]" not in str(caught.value)
