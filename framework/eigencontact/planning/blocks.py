"""Blocks: pieces of a computation that say what they require, provide and cost, without being built."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from eigencontact.errors import PlanError, nearest
from eigencontact.planning.kernels import KernelUse

__all__ = ["Block", "Cost", "resolve"]


@dataclass(frozen=True, slots=True)
class Cost:
    """Predicted price of a block.

    Attributes
    ----------
    memory : float
        Held as long as the run [bytes].
    seconds_once, seconds_per_step : float
        Wall time per run and per step [s].
    transient : float
        Held only while the block works [bytes]: of several blocks the largest counts.
    """

    memory: float = 0.0
    seconds_once: float = 0.0
    seconds_per_step: float = 0.0
    transient: float = 0.0

    @property
    def peak(self) -> float:
        """Memory at its peak [bytes]."""
        return self.memory + self.transient

    def __add__(self, other: Cost) -> Cost:
        return Cost(
            self.memory + other.memory,
            self.seconds_once + other.seconds_once,
            self.seconds_per_step + other.seconds_per_step,
            max(self.transient, other.transient),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Block:
    """Declaration of one piece of work.

    Attributes
    ----------
    name : str
        Unique in the plan; the driver finds the code that runs it by ``runner``.
    runner : str
        Name under which `eigencontact.execution` knows how to build it.
    requires, provides : frozenset of str
        Quantities, by name.
    why : str
        What asked for it, in words.
    kernels : sequence of KernelUse
        Influence coefficients it builds.
    cost : Cost
        Prediction.
    settings : mapping
        Whatever the runner needs from the scene.
    """

    name: str
    runner: str
    requires: frozenset[str] = frozenset()
    provides: frozenset[str] = frozenset()
    why: str = ""
    kernels: Sequence[KernelUse] = ()
    cost: Cost = Cost()
    settings: Mapping[str, object] = field(default_factory=dict)


def resolve(blocks: Iterable[Block], outputs: Mapping[str, str]) -> list[tuple[Block, ...]]:
    """Chain backwards from the outputs to the blocks needed, and put them in order.

    Parameters
    ----------
    blocks : iterable of Block
        Everything the scene could use.
    outputs : mapping of str to str
        Quantities wanted, and who asked for each.

    Returns
    -------
    list of tuples of Block
        In order of execution; blocks that need each other's results form one tuple and are solved together.

    Raises
    ------
    PlanError
        A quantity that nothing, or more than one block, provides; names who asked and the candidates.
    """
    providers: dict[str, list[Block]] = {}
    for block in blocks:
        for quantity in block.provides:
            providers.setdefault(quantity, []).append(block)
    needed: dict[str, Block] = {}
    open_ends = dict(outputs)
    while open_ends:
        quantity, who = open_ends.popitem()
        block = _only_provider(providers, quantity, who)
        if block.name not in needed:
            needed[block.name] = block
            open_ends.update(dict.fromkeys(sorted(block.requires), f"block {block.name!r}"))
    return _in_order(needed, providers)


def _only_provider(providers: Mapping[str, list[Block]], quantity: str, who: str) -> Block:
    candidates = providers.get(quantity, [])
    if len(candidates) == 1:
        return candidates[0]
    if not candidates:
        known = ", ".join(sorted(providers))
        raise PlanError(
            f"{quantity!r} must be provided by a block ({who} asked for it; provided are: {known})"
            f"{nearest(quantity, providers)}"
        )
    names = ", ".join(repr(block.name) for block in candidates)
    raise PlanError(
        f"{quantity!r} must be provided by one block ({who} asked for it, candidates are {names}); choose one"
    )


def _in_order(needed: Mapping[str, Block], providers: Mapping[str, list[Block]]) -> list[tuple[Block, ...]]:
    """Order by dependence; mutual dependence makes a group. Plans are small: reachability is computed outright."""
    before = {name: {providers[quantity][0].name for quantity in block.requires} for name, block in needed.items()}
    reach = {name: set(direct) for name, direct in before.items()}
    changed = True
    while changed:
        changed = False
        for name, known in reach.items():
            more = set().union(*(reach[other] for other in known)) - known if known else set()
            if more:
                reach[name] = known | more
                changed = True
    groups: list[tuple[Block, ...]] = []
    done: set[str] = set()
    while len(done) < len(needed):
        for name in sorted(needed):
            together = {name} | {other for other in reach[name] if name in reach.get(other, set())}
            if name not in done and reach[name] <= done | together:
                groups.append(tuple(needed[other] for other in sorted(together)))
                done |= together
                break
    return groups
