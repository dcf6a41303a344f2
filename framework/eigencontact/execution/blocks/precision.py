"""Choice of the precision of each operator for ``numerics.precision = "auto"``.

Single precision is taken where its round-off, measured in one application beside one in double precision, with a
margin, is below the error that the operator may make. Default is double: at the default tolerance nothing else is left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, Protocol

import numpy as np

from eigencontact.convolution import Convolver, Layout
from eigencontact.model.sources import Lattice
from eigencontact.scene.schema import Numerics

__all__ = ["INNER", "Precision", "contact_precision", "plane_round_off", "settled", "volume_round_off"]

#: Part of the tolerance of a scene that each operator may spend where several are iterated on together.
INNER = 0.3
#: Round-off of one application may be exceeded so many times by another, and adds up over iterations: a pressure found
#: on 64 to 256 cells was off by 2.3 to 3.4e-7 per cell across, where one convolution was by 1.5e-7.
_MARGIN = 4.0
#: Cells across the planes of the stand-ins that are measured; the round-off of sums over a volume follows their depth.
_ACROSS = 8


@dataclass(frozen=True, slots=True)
class Precision:
    """Precision of one operator, with the reason.

    Attributes
    ----------
    operator : str
        For people.
    chosen : {"double", "single"}
    round_off : float
        Error of single precision to be expected, margin included [-].
    bound : float
        Error that it may make [-].
    """

    operator: str
    chosen: str
    round_off: float
    bound: float

    def __str__(self) -> str:
        how = "within" if self.chosen == "single" else "above"
        return f"{self.operator} {self.chosen} (round-off of single, {self.round_off:.1e}, is {how} {self.bound:.1e})"


def settled(
    numerics: Numerics, operator: str, round_off: Callable[[], float | None], *, share: float = 1.0
) -> tuple[Numerics, tuple[Precision, ...]]:
    """Numerics with the precision of one operator, and the reason if there was a choice.

    Parameters
    ----------
    numerics : Numerics
        Of the scene.
    operator : str
        For people.
    round_off : callable
        Relative error of its answer by single precision, None where it knows double alone; called where the scene
        leaves the choice open.
    share : float
        Part of the tolerance that it may spend.
    """
    if numerics.precision != "auto":
        return numerics, ()
    measured, bound = round_off(), share * numerics.tolerance
    if measured is None:
        return numerics.model_copy(update={"precision": "double"}), ()
    expected = _MARGIN * measured
    chosen = "single" if expected <= bound else "double"
    return numerics.model_copy(update={"precision": chosen}), (Precision(operator, chosen, expected, bound),)


def contact_precision(
    numerics: Numerics, box: tuple[int, int], *, coupled: bool
) -> tuple[Numerics, tuple[Precision, ...]]:
    """Precision of a contact on a box of cells; `coupled` if inhomogeneities are iterated together with it.

    The compliance of a wave falls with its number, so that round-off grows with the cells across.
    """
    return settled(numerics, "contact", lambda: max(box) * plane_round_off(), share=INNER if coupled else 1.0)


@cache
def plane_round_off() -> float:
    """Of a convolution in the plane, by the largest value.

    The kernel hardly matters: with coefficients of stress of cells at any depth and of any aspect it was 0.9 to 2.7e-7.
    """
    n, fields = 64, []
    layout = Layout((n, n), (n, n))
    y, x = layout.y.lattice[:, None], layout.x.lattice[None, :]
    source = np.random.default_rng(1).standard_normal((n, n))
    for precision in ("double", "single"):
        kernel = layout.spectrum(1.0 / np.sqrt(1.0 + x**2 + y**2), (1, 1), precision=precision)
        fields.append(Convolver(layout, precision=precision, threads=1).apply(source, kernel))
    return _difference(*fields)


class _HasCells(Protocol):
    """Half-space for the measurement of round-off in cells: see `HalfSpace`."""

    @property
    def cell(self) -> Any: ...

    def options(self, quantity: str) -> dict[str, Any]: ...


def volume_round_off(
    half_space: _HasCells,
    quantity: str,
    pitch: tuple[float, float],
    cells: Lattice,
    depths: tuple[float, int] | None = None,
) -> float:
    """Of a sum over a volume of cells, by the largest value.

    The square of the depth of the points multiplies what is left of cells near the surface: it was 3.4e-6 for stress in
    8 layers of cubes from the surface on, 1.6e-5 in 16, 7.6e-5 in 32, 3.2e-4 in 64, and 1.5e-7 below ten layers.

    Parameters
    ----------
    half_space : HalfSpace
        Of the cells.
    quantity : {"stress", "strain", "displacement"}
    pitch : (float, float)
        Of the cells along x and y [m].
    cells : Lattice
        Their layers count; some columns stand for all.
    depths : (float, int), optional
        First depth of the points [m] and the number of their planes; by default the middles of the cells.
    """
    options = half_space.options(quantity)
    body = (options["poisson_ratio"], options["space"])
    unit, middles = cells.edges[0], (cells.first[0] + 0.5, cells.shape[0])
    points = middles if depths is None else (depths[0] / unit, depths[1])
    return _volume_round_off(half_space.cell, quantity, *body, (pitch[0] / unit, pitch[1] / unit), middles, points)


@cache
def _volume_round_off(
    cell: Any,
    quantity: str,
    nu: float,
    space: str,
    aspect: tuple[float, float],
    middles: tuple[float, int],
    points: tuple[float, int],
) -> float:
    """See `volume_round_off`; depths are in heights of the cells."""
    from eigencontact.solvers.cells import Cells
    from eigencontact.solvers.eigenstrain import VolumeField

    source, target = (
        Cells(first=(0.0, 0.0, first), pitch=(*aspect, 1.0), shape=(count, _ACROSS, _ACROSS))
        for first, count in (middles, points)
    )
    strain = np.random.default_rng(1).standard_normal((6, *source.shape))
    fields = [
        VolumeField(
            cell, source, target, poisson_ratio=nu, quantity=quantity, space=space, precision=precision, threads=1
        ).apply(strain)
        for precision in ("double", "single")
    ]
    return _difference(*fields)


def _difference(double: Any, single: Any) -> float:
    return float(np.abs(single - double).max() / np.abs(double).max())
