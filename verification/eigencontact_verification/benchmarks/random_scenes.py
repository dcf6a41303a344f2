"""Random scenes of all physics: bundled scenes with other loads, constants, sizes and cells, and finer runs of them."""

from __future__ import annotations

from collections.abc import Mapping
from random import Random
from typing import Any

__all__ = ["KINDS", "finer", "random_scene"]

#: Bundled scenes by physics, with the cells per contact radius that they are solved on; below 2 it is the part of the
#: cells each way that a scene gives.
KINDS: dict[str, dict[str, float]] = {
    "elastic": {"hertz": 20, "hertz-ellipse": 14, "dissimilar-spheres": 16, "tilted-punch": 16},
    "friction": {"cattaneo-mindlin": 14, "fretting-mode-1": 12, "rotating-shear": 12, "gross-slip": 12},
    "layers": {"coated-sphere": 14, "soft-coating": 14, "coated-fretting": 10},
    "inclusions": {"inclusion-under-contact": 10, "void-under-contact": 12, "sphere-near-surface": 0.3},
    "yield": {"plastic-hertz": 5, "plastic-indentation": 4, "plastic-inclusion": 0.45},
    "damage": {"concrete-bars-damage": 0.5, "bone-indentation": 0.35},
    "wear": {"wear-gross-sliding": 0.5, "fretting-wear-gross-slip": 0.5},
}
#: Least cells per contact radius in `KINDS`.
_PER_RADIUS = 2.0
_LOADS = ("normal-load", "approach", "moment-y", "tangential-load-x", "tangential-load-y", "shift-x", "shift-y")
#: Keys of components, and the factors between which their values are drawn.
_FACTORS = {
    "coefficient": (0.7, 1.2),
    "thickness": (0.7, 1.4),
    "yield-stress": (0.9, 1.3),
    "modulus": (0.5, 1.5),
    "B": (0.9, 1.3),
    "threshold": (0.8, 1.3),
    "saturation": (0.7, 1.1),
    "radius": (0.85, 1.0),
    "young-modulus": (0.7, 1.4),
}
#: Tables of a scene in which they are drawn: the radius of an inclusion, but not of the sphere that presses.
_TABLES = ("friction", "wear", "inclusions")


def random_scene(name: str, cells: float, random: Random) -> dict[str, Any]:
    """Tables of a bundled scene with other loads, constants, sizes and cells."""
    from eigencontact import app

    tables = app.load_scene(name).resolved()
    factor = random.uniform(0.7, 1.3)
    tables["steps"] = [_loaded(step, factor) for step in tables["steps"]]
    ratio = random.uniform(0.1, 0.4)
    body, share = tables["body1"], random.uniform(0.8, 1.3)
    if "poisson-ratio" in body and not body.get("law"):
        body["poisson-ratio"] = ratio
    for table in (value for value in (tables.get(name) for name in _TABLES) if value):
        _draw(table, random)
    for table in (body[name] for name in ("medium", "law") if body.get(name)):
        _draw(table, random)
    tables["numerics"] |= {"threads": 1, "allow-coarse": True}
    if cells >= _PER_RADIUS:
        grid, numerics = tables["grid"], tables["numerics"]
        if numerics.get("inclusion-pitch"):
            numerics["inclusion-pitch"] *= grid["cells-per-contact-radius"] / (share * cells)
        grid["cells-per-contact-radius"] = share * cells
    else:
        _resize(tables, share * cells)
    tables["output"] = {"pictures": False, "vtk": False}
    return tables


def _loaded(step: Mapping[str, Any], factor: float) -> dict[str, Any]:
    if step.get("cycle") is not None:
        return {**step, "cycle": [_loaded(inner, factor) for inner in step["cycle"]]}
    return {name: factor * value if name in _LOADS and value else value for name, value in step.items()}


def _draw(table: Any, random: Random) -> None:
    """Multiply the values of keys with factors, in all tables inside."""
    if isinstance(table, list):
        for inner in table:
            _draw(inner, random)
    if not isinstance(table, dict):
        return
    for name, value in table.items():
        if name in _FACTORS and isinstance(value, str | int | float):
            table[name] = _times(value, random.uniform(*_FACTORS[name]))
        else:
            _draw(value, random)


def _times(value: str | float, factor: float) -> str | float:
    """Multiply a number, or a text with a unit.

    Examples
    --------
    >>> _times("2 um", 1.5)
    '3.0 um'
    """
    if not isinstance(value, str):
        return factor * value
    number, _, unit = value.partition(" ")
    return f"{factor * float(number)} {unit}"


def _resize(tables: dict[str, Any], share: float) -> None:
    """Give a grid of stated cells `share` times as many each way, at the same size."""
    grid, numerics = tables["grid"], tables["numerics"]
    before = grid["cells"]
    grid["cells"] = [max(5, round(share * count)) for count in before]
    if grid.get("spacing"):
        pairs = zip(grid["spacing"], before, grid["cells"], strict=True)
        grid["spacing"] = [edge * old / new for edge, old, new in pairs]
    if numerics.get("inclusion-pitch"):
        numerics["inclusion-pitch"] /= share


def finer(plan: Any, factor: float = 2.0) -> dict[str, Any]:
    """Tables of the judge of a run: finer in everything.

    It has `factor` times the cells each way, twice the increments and the points of regions, half as much room of a
    law again, and every step size of another setting divided by its stride. It takes all settings, those without a
    source of error as well, so that it does not inherit what the bars leave out.
    """
    from eigencontact.accuracy.changes import changed, refined_grid, refined_steps
    from eigencontact.accuracy.settings import finer_settings

    tables, settings = plan.scene.resolved(), finer_settings(plan)
    return changed(
        tables,
        {
            **settings,
            "grid": refined_grid(plan, factor, keep_parity=True)[0],
            "steps": refined_steps(tables["steps"], 2.0)[0],
            "stress": [_more_points(request) for request in tables["stress"]],
            "numerics": {**settings.get("numerics", {}), "law-room": 1.5 * plan.numerics.law_room},
        },
    )


def _more_points(request: Mapping[str, Any]) -> dict[str, Any]:
    """Twice the steps along a line, or in depth."""
    if request["shape"] == "line":
        return {**request, "count": 2 * request["count"] - 1}
    return {**request, "depth-cells": 2 * request.get("depth-cells", 48)} if request.get("depth-max") else {**request}
