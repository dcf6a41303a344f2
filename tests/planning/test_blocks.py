"""From outputs backwards to blocks: chains, choices, gaps, cycles."""

import pytest

from eigencontact.errors import PlanError
from eigencontact.planning.blocks import Block, Cost, resolve


def block(name, requires="", provides=""):
    return Block(name=name, runner=name, requires=frozenset(requires.split()), provides=frozenset(provides.split()))


CHAIN = [block("c", "b", "c"), block("a", "", "a"), block("b", "a", "b"), block("spare", "c", "spare")]

# (blocks, outputs, names of the groups in order)
CASES = {
    "a chain, whatever the order of declaration": (CHAIN, "c", [["a"], ["b"], ["c"]]),
    "what nobody asks for is left out": (CHAIN, "a", [["a"]]),
    "nothing": (CHAIN, "", []),
    "one block of many outputs": ([block("a", "", "x y z")], "x y z", [["a"]]),
    "a diamond": (
        [block("top", "", "t"), block("left", "t", "l"), block("right", "t", "r"), block("end", "l r", "e")],
        "e",
        [["top"], ["left"], ["right"], ["end"]],
    ),
    "a cycle is one group": ([block("a", "y", "x"), block("b", "x", "y")], "x", [["a", "b"]]),
    "a cycle between blocks that stand alone": (
        [block("in", "", "i"), block("a", "i y", "x"), block("b", "x", "y"), block("out", "y", "o")],
        "o",
        [["in"], ["a", "b"], ["out"]],
    ),
    "a ring of three": (
        [block("a", "z", "x"), block("b", "x", "y"), block("c", "y", "z")],
        "z",
        [["a", "b", "c"]],
    ),
    "two cycles that share a block are one group": (
        [block("a", "y", "x"), block("b", "x z", "y"), block("c", "y", "z")],
        "x",
        [["a", "b", "c"]],
    ),
    "two cycles apart are two groups": (
        [block("a", "b", "a"), block("b", "a", "b"), block("c", "b d", "c"), block("d", "c", "d")],
        "d",
        [["a", "b"], ["c", "d"]],
    ),
    "a block that needs itself": ([block("a", "x", "x")], "x", [["a"]]),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("backwards", [False, True])
def test_resolve(case, backwards):
    blocks, outputs, expected = CASES[case]
    wanted = dict.fromkeys(outputs.split(), "the test")
    groups = resolve(blocks[::-1] if backwards else blocks, wanted)
    assert [[item.name for item in group] for group in groups] == expected


@pytest.mark.parametrize(
    ("blocks", "output", "words"),
    [
        (CHAIN, "d", "'d' must be provided by a block (the test asked for it; provided are: a, b, c, spare)"),
        (CHAIN, "spar", "did you mean 'spare'?"),
        ([block("a", "missing", "x")], "x", "'missing' must be provided by a block (block 'a' asked for it"),
        (
            [block("a", "", "x"), block("b", "", "x")],
            "x",
            "'x' must be provided by one block (the test asked for it, candidates are 'a', 'b'); choose one",
        ),
    ],
)
def test_what_cannot_be_resolved(blocks, output, words):
    with pytest.raises(PlanError) as caught:
        resolve(blocks, {output: "the test"})
    assert words in str(caught.value)


def test_two_providers_of_what_nobody_wants_are_no_trouble():
    assert resolve([block("a", "", "x"), block("b", "", "x"), block("c", "", "y")], {"y": "the test"})[0][0].name == "c"


def test_costs_add_up():
    assert Cost(1.0, 2.0, 3.0) + Cost(10.0, 20.0, 30.0) == Cost(11.0, 22.0, 33.0)
