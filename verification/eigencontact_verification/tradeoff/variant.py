"""Variants of a scene: its grid and the fidelities that make a difference in it.

One setting is changed at a time against the scene as it stands; the reference has the finest of each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from eigencontact.accuracy.changes import Changes, refined_grid, refined_window
from eigencontact.accuracy.settings import FIDELITIES, Fidelity, finest

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["KEYS", "Fidelities", "Variant", "keys_of", "variants"]

#: Keys of all variations, in the order of the table.
KEYS = ("grid", *(fidelity.key for fidelity in FIDELITIES))


@dataclass(frozen=True, kw_only=True, slots=True)
class Fidelities:
    """Extent of the variation."""

    coarser: tuple[float, ...] = (0.25, 0.5)  #: factors on the number of cells each way, below `base`
    base: float = 1.0  #: factor of the variants that change something else
    reference: float = 2.0  #: factor of the reference


@dataclass(frozen=True, kw_only=True, slots=True)
class Variant:
    """One fidelity of a scene."""

    #: Key of the change, one of `KEYS`; ``"scene"`` and ``"reference"`` for the two that others are compared with.
    key: str
    words: str  #: its value in words
    changes: Changes = field(default_factory=dict)  #: tables of the scene by name, with the values that change
    fidelity: Fidelity | None = None  #: changed setting, where it is not the grid


def keys_of(plan: Plan) -> tuple[str, ...]:
    """Keys that can vary in a scene."""
    return ("grid", *(fidelity.key for fidelity in FIDELITIES if fidelity.has(plan)))


def variants(plan: Plan, fidelities: Fidelities, only: Sequence[str] = ()) -> tuple[Variant, ...]:
    """Reference, scene as it stands (at the factor `base`), then one change at a time, of all keys or only of some."""
    base_grid, base_words = refined_grid(plan, fidelities.base)
    variants_found = _grids(plan, fidelities) if not only or "grid" in only else []
    for fidelity in FIDELITIES:
        if not fidelity.has(plan) or (only and fidelity.key not in only):
            continue
        grid = refined_window(plan, fidelities.base)[0] if fidelity.keeps_window else base_grid
        variants_found += [
            Variant(
                key=fidelity.key,
                words=fidelity.words(value),
                changes={**fidelity.of(plan, value), "grid": grid},
                fidelity=fidelity,
            )
            for value in fidelity.others(plan)
        ]
    changes, words = finest(plan, fidelities.reference)
    reference = Variant(key="reference", words=", ".join(words), changes=changes)
    return (reference, Variant(key="scene", words=base_words, changes={"grid": base_grid}), *variants_found)


def _grids(plan: Plan, fidelities: Fidelities) -> list[Variant]:
    grids = []
    for factor in fidelities.coarser:
        grid, words = refined_grid(plan, factor)
        if grid.get("cells-per-contact-radius", 2.0) >= 2.0:
            grids.append(Variant(key="grid", words=words, changes={"grid": grid}))
    return grids
