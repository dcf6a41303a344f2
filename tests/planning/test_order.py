"""From what is wanted backwards to blocks, in order: chains, choices, gaps, cycles."""

import pytest

from eigencontact.errors import PlanError
from eigencontact.execution.blocks.block import Cost, Stateless
from eigencontact.planning.order import in_order


class Declared(Stateless):
    def __init__(self, name, requires="", provides="", requesters=""):
        self.name, self.requires, self.provides = name, frozenset(requires.split()), frozenset(provides.split())
        self.requesters = dict.fromkeys(requesters.split(), "the test")

    def advance(self, step):
        raise AssertionError(step)


def chain(requesters):
    """Four blocks, declared backwards; one gives what is wanted."""
    declared = {"c": "b", "a": "", "b": "a", "spare": "c"}
    return [Declared(name, needs, name, name if name == requesters else "") for name, needs in declared.items()]


# blocks -> names in order
CASES = {
    "a chain, whatever the order of declaration": (chain("c"), ["a", "b", "c"]),
    "what nobody asks for is left out": (chain("a"), ["a"]),
    "nothing": (chain(""), []),
    "one block of many results": ([Declared("a", "", "x y z", "x y z")], ["a"]),
    "a diamond": (
        [
            Declared("end", "l r", "e", "e"), Declared("right", "t", "r"), Declared("top", "", "t"),
            Declared("left", "t", "l"),
        ],
        ["top", "right", "left", "end"],
    ),
    "else as declared": ([Declared(name, "", name, name) for name in "cab"], ["c", "a", "b"]),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_order(case):
    blocks, expected = CASES[case]
    assert [block.name for block in in_order(blocks)] == expected


@pytest.mark.parametrize(
    ("blocks", "words"),
    [
        (
            [*chain(""), Declared("e", "d", "e", "e")],
            "'d' must be provided by a block (block 'e' asked for it; provided are: a, b, c, e, spare)",
        ),
        ([*chain(""), Declared("e", "spar", "e", "e")], "did you mean 'spare'?"),
        (
            [Declared("a", "", "x", "x"), Declared("b", "", "x")],
            "'x' must be provided by one block (the test asked for it, candidates are 'a', 'b'); choose one",
        ),
        ([Declared("a", "y", "x", "x"), Declared("b", "x", "y")], "blocks must not require each other"),
        ([Declared("a", "x", "x", "x")], "blocks must not require each other (got 'a' -> 'a')"),
    ],
)
def test_what_cannot_be_ordered(blocks, words):
    with pytest.raises(PlanError) as caught:
        in_order(blocks)
    assert words in str(caught.value)


def test_two_providers_of_what_nobody_wants_are_no_trouble():
    blocks = [Declared("a", "", "x"), Declared("b", "", "x"), Declared("c", "", "y", "y")]
    assert [block.name for block in in_order(blocks)] == ["c"]


def test_costs_add_up():
    assert Cost(1.0, 2.0, 3.0) + Cost(10.0, 20.0, 30.0) == Cost(11.0, 22.0, 33.0)
    assert Cost(1.0, 2.0, 3.0, 4.0) + Cost(transient=5.0) == Cost(1.0, 2.0, 3.0, 5.0)
    assert Cost(1.0, 2.0, 3.0, 4.0).once == Cost(0.0, 5.0, 0.0, 5.0)
    assert Cost(1.0, 2.0, 3.0, 4.0).every_step == Cost(0.0, 0.0, 5.0, 5.0)
