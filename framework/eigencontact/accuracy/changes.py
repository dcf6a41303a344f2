"""Changes of the tables of a scene for a coarser or finer discretisation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["Changes", "changed", "refined_grid", "refined_steps", "refined_window"]

#: Tables of a scene by name, with the values that change (None removes one); a list replaces that of the scene.
Changes = Mapping[str, Any]

#: Keys of the output that cost time beside the results.
_FILES = ("pictures", "vtk", "animation", "errors")


def changed(tables: Mapping[str, Any], changes: Changes) -> dict[str, Any]:
    """Tables of a scene with changes, without pictures, other files and a target of accuracy.

    Examples
    --------
    >>> tables = {"numerics": {"tolerance": 1e-6, "threads": 2}}
    >>> out = changed(tables, {"numerics": {"tolerance": 1e-4, "threads": None}})
    >>> out["numerics"], out["output"]["pictures"]
    ({'tolerance': 0.0001}, False)
    """
    out = {**tables, "output": {**tables.get("output", {}), **dict.fromkeys(_FILES, False)}}
    out.pop("accuracy", None)
    for name, change in changes.items():
        # a grid is replaced as a whole: two of its keys exclude the others
        if name == "grid" or not isinstance(change, Mapping):
            out[name] = change
            continue
        merged = {**out.get(name, {}), **change}
        out[name] = {key: value for key, value in merged.items() if value is not None}
    return out


def refined_grid(plan: Plan, factor: float, *, keep_parity: bool = False) -> tuple[dict[str, Any], str]:
    """Table of a grid with `factor` times the cells each way, and its resolution in words; see `refined_window`."""
    spec = plan.scene.grid
    if spec.automatic and plan.scene.geometry:
        cells = factor * spec.cells_per_contact_radius
        center = list(spec.center)
        table: dict[str, Any] = {"center": center, "cells-per-contact-radius": max(1.0, cells), "margin": spec.margin}
        strips = {name: value for name, value in _window(plan).items() if name in ("length", "datum-depth")}
        return table | strips, f"{cells:g} cells per contact radius"
    return refined_window(plan, factor, keep_parity=keep_parity)


def refined_window(plan: Plan, factor: float, *, keep_parity: bool = False) -> tuple[dict[str, Any], str]:
    """Table of a grid over the window of a plan with `factor` times the cells each way, and its resolution in words.

    With `keep_parity` the number of cells stays odd or even: the middle of the window keeps or lacks a cell.
    """
    number = _with_parity if keep_parity else _rounded
    counts = [number(factor * count, count) for count in plan.grid.counts]
    if plan.model.periodic:  # no zeros fill the window up to a length that transforms fast
        counts = [n if n == present else _smooth(n) for n, present in zip(counts, plan.grid.counts, strict=True)]
    # the window of the plan: an automatic one around inclusions has its own centre
    cells = {"cells": counts if len(counts) > 1 else counts[0]}
    return _window(plan) | cells, f"{' x '.join(str(count) for count in counts)} cells"


def _window(plan: Plan) -> dict[str, Any]:
    """Table of the cells of a plan; displacements of all grids of a line contact count against its depth."""
    from eigencontact.scene.line import window_keys

    interface = plan.model.interface
    return window_keys(plan.grid, None if interface is None else interface.datum)


def _rounded(cells: float, _: int) -> int:
    return max(1, round(cells))


def _with_parity(cells: float, count: int) -> int:
    """Whole number nearest to `cells` with the parity of `count`.

    Examples
    --------
    >>> _with_parity(22.5, 45), _with_parity(21.3, 64), _with_parity(0.4, 1)
    (23, 22, 1)
    """
    odd = count % 2
    return max(2 - odd, 2 * round(0.5 * (cells - odd)) + odd)


def _smooth(count: int) -> int:
    """Next number of the same parity without prime factors above 7.

    Examples
    --------
    >>> _smooth(274), _smooth(33), _smooth(64)
    (280, 35, 64)
    """
    cofactor = count
    for prime in (2, 3, 5, 7):
        while cofactor % prime == 0:
            cofactor //= prime
    return count if cofactor == 1 else _smooth(count + 2)


def refined_steps(steps: list[dict[str, Any]], factor: float) -> tuple[list[dict[str, Any]], float]:
    """Tables of the steps with `factor` times the increments, at least one each, and the ratio of all increments.

    Examples
    --------
    >>> refined_steps([{"normal-load": 1.0, "increments": 3}, {"cycle": [{"shift-x": 1e-6}], "repeat": 9}], 0.5)
    ([{'normal-load': 1.0, 'increments': 2}, {'cycle': [{'shift-x': 1e-06, 'increments': 1}], 'repeat': 9}], 0.75)
    """
    old_count = new_count = 0
    out = []
    for step in steps:
        if step.get("cycle") is not None:
            inner, _ = refined_steps(step["cycle"], factor)
            pairs = list(zip(step["cycle"], inner, strict=True))
            out.append({**step, "cycle": inner})
        else:
            single = {**step, "increments": max(1, int(factor * step.get("increments", 1) + 0.5))}
            pairs = [(step, single)]
            out.append(single)
        old_count += sum(old.get("increments", 1) for old, _ in pairs)
        new_count += sum(new["increments"] for _, new in pairs)
    return out, new_count / old_count
