"""Error of a run: from a second run of the same scene with coarser cells, or from its own error bars."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isclose
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator

from eigencontact_verification.audit.bodies import NotJudged
from eigencontact_verification.audit.contact_lines import StoredContact
from eigencontact_verification.audit.stored_profile import StoredProfile

if TYPE_CHECKING:
    from eigencontact.core.numbers import ErrorBar, Number

__all__ = ["ratio_of_cells", "with_bars", "with_index", "with_two_grids"]

FloatArray = NDArray[np.float64]

#: Factor of safety of a grid convergence index of two grids whose order is not assumed to be more than 1, and the
#: order.
_SAFETY, _ORDER = 1.25, 1.0
#: Least ratio of the cells.
_RATIO = 1.2
#: Lines that are compared. Counts of cells jump with their places: two of them say nothing about a third. Stress has a
#: kink at every boundary, which no interpolation meets.
_SMOOTH, _WITHOUT_REGIONS = ("approach", "print", "pressure"), ("stress",)
#: Number or field of a line that may have error bars.
_NUMBERS = {
    "approach": "approach", "radius": "contact_radius", "pressure": "pressure", "print": "residual_displacement_z",
}  # fmt: skip
#: Fewest points of a line that is interpolated.
_FEWEST = 4


def with_two_grids(
    lines: Sequence[StoredProfile],
    stored: StoredContact,
    coarser_lines: Sequence[StoredProfile],
    coarser: StoredContact,
    *,
    regions: bool = False,
) -> tuple[StoredProfile, ...]:
    """Lines with the errors of `with_index`; counts, and stress beside regions, stay as they are.

    Parameters
    ----------
    lines, coarser_lines : sequence of StoredProfile
        Of the run that is judged, and of the coarser one.
    stored, coarser : StoredContact
        Both runs.
    regions : bool
        Whether the body has regions of other material.

    Raises
    ------
    NotJudged
        The second run has other loads, or cells that are not coarser by a fifth.
    """
    edges = zip((stored.cell, stored.pitch), (coarser.cell, coarser.pitch), strict=True)
    ratio = ratio_of_cells(min(b / a for a, b in edges if a), stored.load, coarser.load)
    named = {line.profile.name: line for line in coarser_lines}
    kinds = _SMOOTH if regions else _SMOOTH + _WITHOUT_REGIONS
    return tuple(
        line if line.kind not in kinds or line.profile.name not in named
        else _estimated(line, named[line.profile.name], ratio)
        for line in lines
    )  # fmt: skip


def ratio_of_cells(ratio: float, load: FloatArray, coarser_load: FloatArray) -> float:
    """Ratio of the cells of a coarser run to those of a run, checked.

    Their load steps have the loads `load` and `coarser_load`.

    Raises
    ------
    NotJudged
        The second run has other loads, or cells that are not coarser by a fifth.
    """
    if not ratio >= _RATIO:
        raise NotJudged(f"the coarser run must have cells larger by a factor of {_RATIO} (got {ratio:.3g})")
    if load.shape != coarser_load.shape or not np.allclose(load, coarser_load, rtol=1e-6, atol=0.0):
        raise NotJudged("the coarser run must have the same loads")
    return ratio


def with_index(line: StoredProfile, coarser_values: FloatArray, ratio: float) -> StoredProfile:
    """Line whose error is at least the grid convergence index of two runs.

    The index is ``1.25 |f - g| / (ratio - 1)``, of first order, and nowhere less than half of the largest on the line:
    where the difference happens to vanish the error does not.

    Parameters
    ----------
    coarser_values : (n, components) array
        Values of the coarser run at the points of the line, nan where it has none.
    ratio : float
        Of the cells of both runs.
    """
    index, along = _SAFETY * np.abs(line.values - coarser_values) / (ratio**_ORDER - 1), line.profile.along
    finite = np.isfinite(index).all(axis=1)
    if not finite.any():
        return line
    index = np.stack([np.interp(along, along[finite], column[finite]) for column in index.T], axis=1)
    return replace(line, error=np.maximum(line.error, np.maximum(index, 0.5 * index.max(axis=0))))


def with_bars(
    lines: Sequence[StoredProfile], stored: StoredContact, bars: Mapping[str, tuple[Number, ErrorBar]], widest: float
) -> tuple[StoredProfile, ...]:
    """Lines of numbers and fields with error bars, which are their error; errors of other lines stay.

    A run that stores its errors has them in every step, another at the last step only, and only of numbers.

    Parameters
    ----------
    stored : StoredContact
        The run.
    bars : mapping
        Declarations and error bars by number; a bar of another value than that of the line does not count.
    widest : float
        Unit of the contact radius on its line [m].
    """
    return tuple(replace(line, error=_error(line, stored, bars, widest)) for line in lines)


def _error(
    line: StoredProfile, stored: StoredContact, bars: Mapping[str, tuple[Number, ErrorBar]], widest: float
) -> FloatArray:
    name, error, unit = _NUMBERS.get(line.kind, ""), line.error.copy(), widest if line.kind == "radius" else 1.0
    errors = stored.errors.get(name)
    if errors is not None and errors.ndim == 1:
        return np.asarray(errors[list(line.moments), None] / unit)
    if errors is not None:
        x, y, _ = line.profile.points.T
        row, columns = np.abs(stored.y - y[0]).argmin(), np.abs(stored.x[:, None] - x).argmin(axis=0)
        return np.asarray(errors[line.moments[0], row, columns, None])
    if name in bars and isclose(unit * line.values[-1, 0], bars[name][1].value):
        error[-1] = bars[name][1].error / unit
    return error


def _estimated(line: StoredProfile, coarser: StoredProfile, ratio: float) -> StoredProfile:
    at, values = coarser.profile.along, coarser.values
    if line.kind == "approach":  # over the same steps
        coarser_values = values
    else:
        if line.kind != "stress":  # of revolution: the row goes on beyond the axis
            at, where = np.unique(np.concatenate((-at, at)), return_index=True)
            values = np.concatenate((values, values))[where]
        if at.size < _FEWEST:
            return line
        coarser_values = Akima1DInterpolator(at, values)(line.profile.along)
    return with_index(line, coarser_values, ratio)
