"""Which fidelities of a scene are worth comparing: this follows from what the scene holds.

One setting is changed at a time against the scene as it stands; the reference has the finest of each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["KEYS", "Fidelities", "Variant", "keys_of", "tables_of", "variants"]

#: What can be varied, in the order of the table.
KEYS = ("grid", "precision", "tolerance", "coupling", "half-space", "inclusion-cells", "inclusion-resolution")

_HALF_SPACES = ("exact", "image-pressure", "periodic")
_COUPLINGS = ("full", "one-way", "partial", "none")
_TOLERANCES = (1e-4, 1e-2)
#: The reference is solved to the scene's tolerance times this, and no further than the second number.
_TIGHTER, _TIGHTEST = 0.1, 1e-10


@dataclass(frozen=True, kw_only=True, slots=True)
class Fidelities:
    """How far to vary.

    Attributes
    ----------
    coarser : tuple of float
        Factors on the number of cells each way, below `base`.
    base, reference : float
        Factors of the variants that change something else, and of the reference.
    """

    coarser: tuple[float, ...] = (0.25, 0.5)
    base: float = 1.0
    reference: float = 2.0


@dataclass(frozen=True, kw_only=True, slots=True)
class Variant:
    """One fidelity of a scene.

    Attributes
    ----------
    key : str
        What is changed, one of `KEYS`; ``"scene"`` and ``"reference"`` for the two that others are compared with.
    words : str
        Its value in words.
    changes : mapping
        Tables of the scene by name, with the values that change.
    """

    key: str
    words: str
    changes: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


def tables_of(resolved: Mapping[str, Any], variant: Variant) -> dict[str, Any]:
    """Tables of the scene with the changes of a variant; pictures are left out."""
    out = {**resolved, "output": {**resolved.get("output", {}), "pictures": False, "vtk": False}}
    for name, changes in variant.changes.items():
        # a grid that is given is given anew as a whole
        out[name] = dict(changes) if name == "grid" else {**out.get(name, {}), **changes}
    return out


def keys_of(plan: Plan) -> tuple[str, ...]:
    """What can be varied in a scene."""
    from eigencontact.model.sources import Patch

    scene, numerics = plan.scene, plan.scene.numerics
    contact, strained, half_space = bool(plan.geometries), bool(plan.sources), numerics.half_space
    cut = [source for source in plan.sources if source.lattice is not None]
    foreign = any(_material(table) is not None for table in scene.inclusions)
    wanted = {
        "grid": True,
        "precision": (contact or bool(cut)) and numerics.precision == "double",
        "tolerance": (contact or foreign) and numerics.tolerance < max(_TOLERANCES),
        "coupling": plan.friction is not None,
        # an inhomogeneity and a periodic contact take one treatment alone
        "half-space": strained and not foreign and numerics.boundary != "periodic" and half_space in _HALF_SPACES,
        # a patch has layers of its own, inhomogeneities share the columns of the grid
        "inclusion-cells": any(not isinstance(source.shape, Patch) and source.material is None for source in cut),
        "inclusion-resolution": foreign and "inclusion_resolution" in type(numerics).model_fields,
    }
    return tuple(key for key in KEYS if wanted[key])


def variants(plan: Plan, fidelities: Fidelities, only: Sequence[str] = ()) -> tuple[Variant, ...]:
    """Reference, scene as it stands (at the factor `base`), then one change at a time.

    Parameters
    ----------
    plan : Plan
        Of the scene as it stands.
    fidelities : Fidelities
        How far to vary.
    only : sequence of str
        Keys to vary, of `keys_of`; by default all.
    """
    keys = keys_of(plan)
    finest: dict[str, Any] = {}
    found: list[Variant] = []
    base_grid, base_words = _grid(plan, fidelities.base)
    for key in keys:
        tried: list[Variant] = _grids(plan, fidelities) if key == "grid" else _values(plan, key)
        if key != "grid":
            finest |= _finest(plan, key)
            tried = [Variant(key=key, words=v.words, changes={**v.changes, "grid": base_grid}) for v in tried]
        if not only or key in only:
            found += tried
    fine_grid, fine_words = _grid(plan, fidelities.reference)
    reference = Variant(
        key="reference",
        words=", ".join([fine_words, *(f"{name} {_text(value)}" for name, value in finest.items())]),
        changes={"grid": fine_grid, "numerics": finest},
    )
    return (reference, Variant(key="scene", words=base_words, changes={"grid": base_grid}), *found)


def _grids(plan: Plan, fidelities: Fidelities) -> list[Variant]:
    found = []
    for factor in fidelities.coarser:
        grid, words = _grid(plan, factor)
        if grid.get("cells-per-contact-radius", 2.0) >= 2.0:
            found.append(Variant(key="grid", words=words, changes={"grid": grid}))
    return found


def _grid(plan: Plan, factor: float) -> tuple[dict[str, Any], str]:
    """Table of a grid with so many times the cells each way, and its resolution in words."""
    spec, grid = plan.scene.grid, plan.grid
    center = list(spec.center)
    if spec.automatic and plan.geometries:
        cells = factor * spec.cells_per_contact_radius
        table: dict[str, Any] = {"center": center, "cells-per-contact-radius": max(1.0, cells), "margin": spec.margin}
        return table, f"{cells:g} cells per contact radius"
    nx, ny = (max(1, round(factor * count)) for count in (grid.nx, grid.ny))
    size = [grid.nx * grid.dx, grid.ny * grid.dy]
    # the centre of the plan: an automatic window around inclusions has its own
    return {"cells": [nx, ny], "size": size, "center": list(grid.center)}, f"{nx} x {ny} cells"


def _values(plan: Plan, key: str) -> list[Variant]:
    """Other values of a setting of the numerics."""
    numerics = plan.scene.numerics
    values: dict[str, list[Any]] = {
        "precision": ["single"],
        "tolerance": [value for value in _TOLERANCES if value > numerics.tolerance],
        "coupling": [value for value in _COUPLINGS if value != numerics.coupling],
        "half-space": [value for value in _HALF_SPACES if value != numerics.half_space],
        "inclusion-cells": sorted({max(1, numerics.inclusion_cells // 4), max(1, numerics.inclusion_cells // 2)}),
        "inclusion-resolution": [
            value for value in ("cells", "whole") if value != getattr(numerics, "inclusion_resolution", value)
        ],
    }
    return [
        Variant(key=key, words=f"{key} {_text(value)}", changes={"numerics": {key: value}}) for value in values[key]
    ]


def _finest(plan: Plan, key: str) -> dict[str, Any]:
    numerics = plan.scene.numerics
    values: dict[str, Any] = {
        "precision": "double",
        "tolerance": max(_TIGHTER * numerics.tolerance, min(_TIGHTEST, numerics.tolerance)),
        "coupling": "full",
        "half-space": "exact",
        "inclusion-cells": 2 * numerics.inclusion_cells,
        "inclusion-resolution": "cells",
    }
    return {key: values[key]}


def _material(inclusion: Any) -> Any:
    return getattr(inclusion, "material", None) or (inclusion.model_extra or {}).get("material")


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
