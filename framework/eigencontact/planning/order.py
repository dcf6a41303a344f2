"""Required blocks of a plan in order of execution, determined backwards from the requested quantities."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter

from eigencontact.errors import PlanError, nearest
from eigencontact.execution.blocks.block import Block

__all__ = ["in_order"]


def in_order(blocks: Iterable[Block]) -> list[Block]:
    """Requested blocks and their requirements in order of execution; independent blocks keep their order.

    Parameters
    ----------
    blocks : iterable of Block
        Everything the scene could use.

    Raises
    ------
    PlanError
        A quantity that nothing, or more than one block, provides; names who asked and the candidates. Blocks that
        require each other.
    """
    candidates = list(blocks)
    providers: dict[str, list[Block]] = {}
    for block in candidates:
        for quantity in block.provides:
            providers.setdefault(quantity, []).append(block)
    required: dict[str, Block] = {}
    open_ends = {quantity: requester for block in candidates for quantity, requester in block.requesters.items()}
    while open_ends:
        quantity, requester = open_ends.popitem()
        block = _only_provider(providers, quantity, requester)
        if block.name not in required:
            required[block.name] = block
            open_ends.update(dict.fromkeys(sorted(block.requires), f"block {block.name!r}"))
    places = {block.name: place for place, block in enumerate(candidates)}
    before = {name: {providers[item][0].name for item in block.requires} for name, block in required.items()}
    sorter = TopologicalSorter(before)
    try:
        sorter.prepare()
    except CycleError as problem:
        names = " -> ".join(map(repr, problem.args[1]))
        raise PlanError(f"blocks must not require each other (got {names}); join them in one block") from None
    ordered: list[Block] = []
    ready: list[str] = []
    while sorter.is_active():
        ready = sorted([*ready, *sorter.get_ready()], key=lambda name: places[name])
        first = ready.pop(0)
        ordered.append(required[first])
        sorter.done(first)
    return ordered


def _only_provider(providers: Mapping[str, list[Block]], quantity: str, requester: str) -> Block:
    candidates = providers.get(quantity, [])
    if len(candidates) == 1:
        return candidates[0]
    if not candidates:
        names = ", ".join(sorted(providers))
        raise PlanError(
            f"{quantity!r} must be provided by a block ({requester} asked for it; provided are: {names})"
            f"{nearest(quantity, providers)}"
        )
    names = ", ".join(repr(block.name) for block in candidates)
    raise PlanError(
        f"{quantity!r} must be provided by one block ({requester} asked for it, candidates are {names}); choose one"
    )
