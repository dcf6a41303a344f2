"""Error of a run of a line contact from a run of the same scene with coarser cells, strips and cells of bodies alike.

Second differences of the values underestimate the error of cells that yield: when the cells of 'plastic-line-contact'
are halved, stress and plastic strain near the edge change by four times the estimate.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator

from eigencontact_verification.audit.bodies import NotJudged
from eigencontact_verification.audit.line_scene import StoredLine
from eigencontact_verification.audit.stored_profile import StoredProfile
from eigencontact_verification.audit.two_grids import ratio_of_cells, with_index

__all__ = ["run_coarser", "values_at", "with_coarser"]

FloatArray = NDArray[np.float64]

#: Factor of the cells of the second run.
_FACTOR = 2.0
_FIELDS = {"pressure": ("pressure", -1.0), "shear": ("shear_x", 1.0), "slip": ("slip_x", 1.0)}


def run_coarser(text: str, stored: StoredLine, folder: Path) -> Path:
    """Run the scene of a run with cells twice as wide and high, into a folder.

    Raises
    ------
    NotJudged
        The coarser scene was refused.
    """
    import eigencontact as ec
    from eigencontact.errors import EigencontactError

    tables = tomllib.loads(text)
    height = max(float(np.diff(z).max()) for _, z in stored.middles.values())
    numerics = {**tables.get("numerics", {}), "inclusion-pitch": _FACTOR * height, "allow-coarse": True}
    output = {**tables.get("output", {}), "pictures": False, "errors": False}
    strips, odd = len(stored.x), len(stored.x) % 2  # the middle of the window keeps or lacks a strip
    grid = {
        "length": "infinite",
        "cells": max(2 - odd, 2 * round((strips / _FACTOR - odd) / 2) + odd),
        "size": strips * stored.cell,
        "center": [float(stored.x[0] + stored.x[-1]) / 2, 0.0],
        **{key: value for key, value in tables["grid"].items() if key == "datum-depth"},
    }
    try:
        coarse = {**tables, "grid": grid, "numerics": numerics, "output": output, "observers": [], "fatigue": []}
        ec.run(coarse, folder).dataset.close()
    except EigencontactError as problem:
        raise NotJudged(f"the scene with coarser cells was refused: {' '.join(str(problem).split())}") from problem
    return folder


def with_coarser(lines: Sequence[StoredProfile], stored: StoredLine, coarser: StoredLine) -> tuple[StoredProfile, ...]:
    """Lines with the errors of `eigencontact_verification.audit.two_grids.with_index`.

    The error of the half width, which follows from the number of strips, does not change.

    Raises
    ------
    NotJudged
        The second run has other loads, or cells that are not coarser by a fifth.
    """
    ratio = ratio_of_cells(coarser.cell / stored.cell, stored.load, coarser.load)
    return tuple(_widened(line, coarser, ratio) for line in lines)


def values_at(run: StoredLine, lines: Sequence[StoredProfile]) -> dict[str, FloatArray | None]:
    """Values of another run at the points of lines, by their names; None of half widths."""
    return {line.profile.name: _values(run, line) for line in lines}


def _widened(line: StoredProfile, coarser: StoredLine, ratio: float) -> StoredProfile:
    values = _values(coarser, line)
    return line if values is None else with_index(line, values, ratio)


def _values(run: StoredLine, line: StoredProfile) -> FloatArray | None:
    """Values (n, components) of a run at the points of a line, nan outside what it stores; None of half widths."""
    if line.kind in _FIELDS:
        name, sign = _FIELDS[line.kind]
        columns = Akima1DInterpolator(run.x, sign * run.fields[name][line.moments[0]])(line.profile.points[:, 0])
        return np.asarray(columns[:, None])
    number = run.scene["bodies"][line.body - 1]["number"]
    points = line.profile.points
    if line.kind == "plastic strain":
        (strain,) = (region for region in run.strains if region.body == number)
        return _within(strain.x, strain.z, strain.values[:, :, None], points)
    if line.kind not in ("stress", "history of stress"):
        return None
    stored = [
        next(region for region in run.regions[k] if region.body == number and line.profile.name.endswith(region.name))
        for k in line.moments
    ]
    columns = [
        _within(region.points[0, :, 0], region.points[:, 0, 2], region.stress[:, :, [0, 1, 2, 4]], points)
        for region in stored
    ]
    return columns[0] if len(columns) == 1 else np.stack([column[k] for k, column in enumerate(columns)])


def _within(x: FloatArray, z: FloatArray, field: FloatArray, points: FloatArray) -> FloatArray:
    """Field (nz, nx, components) at points (n, 3) of one column."""
    column = Akima1DInterpolator(x, field, axis=1)(points[0, 0])
    return np.asarray(Akima1DInterpolator(z, column, axis=0)(points[:, 2]))
