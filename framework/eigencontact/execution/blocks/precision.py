"""Choice of the precision of each operator for ``numerics.precision = "auto"``.

The program chooses single precision if its round-off is below the error allowed for the operator. One application in
single precision, compared with one in double precision, gives the round-off; a margin is added. The default tolerance
leaves only double precision.
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

#: Fraction of the scene's tolerance for each operator if several operators are iterated together.
INNER = 0.3
#: Margin on the round-off of one application: applications differ by up to this factor, and round-off accumulates over
#: iterations. A pressure on 64 to 256 cells had an error of 2.3 to 3.4e-7 per cell across; one convolution had 1.5e-7.
_MARGIN = 4.0
#: Cells across the sample planes for the measurement. The round-off of volume sums depends on their depth, not on their
#: width.
_ACROSS = 8


@dataclass(frozen=True, slots=True)
class Precision:
    """Precision of one operator, with the reason.

    Attributes
    ----------
    operator : str
        Name of the operator for messages.
    chosen : {"double", "single"}
    round_off : float
        Expected error of single precision, margin included [-].
    bound : float
        Allowed error [-].
    """

    operator: str
    chosen: str
    round_off: float
    bound: float

    def __str__(self) -> str:
        relation = "is within" if self.chosen == "single" else "is above"
        return f"{self.operator} {self.chosen} (round-off of single, {self.round_off:.1e}, {relation} {self.bound:.1e})"


def settled(
    numerics: Numerics, operator: str, round_off: Callable[[], float | None], *, share: float = 1.0
) -> tuple[Numerics, tuple[Precision, ...]]:
    """Numerics with the precision of one operator, and the reason if there was a choice.

    Parameters
    ----------
    numerics : Numerics
        Numerics of the scene.
    operator : str
        Name of the operator for messages.
    round_off : callable
        Relative error of a result in single precision, or None if the operator exists only in double precision. The
        function calls it if the scene leaves the choice open.
    share : float
        Fraction of the tolerance for this operator.
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
    """Precision of a contact on a box of cells; `coupled` if inhomogeneities are iterated together with the contact.

    The compliance of a wave falls with its wavenumber, so round-off grows with the number of cells across.
    """
    return settled(numerics, "contact", lambda: max(box) * plane_round_off(), share=INNER if coupled else 1.0)


@cache
def plane_round_off() -> float:
    """Round-off of a convolution in the plane, relative to the largest value.

    It depends little on the kernel: stress coefficients of cells at any depth and any aspect ratio gave 0.9 to 2.7e-7.
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
    """Round-off of a sum over a volume of cells, relative to the largest value.

    The mirror-image terms of cells near the surface are multiplied by the squared depth of the points. For stress in
    layers of cubes from the surface on, the round-off was 3.4e-6 for 8 layers, 1.6e-5 for 16, 7.6e-5 for 32 and 3.2e-4
    for 64; below the tenth layer it was 1.5e-7.

    Parameters
    ----------
    half_space : HalfSpace
        Half-space of the cells.
    quantity : {"stress", "strain", "displacement"}
    pitch : (float, float)
        Edges of a cell along x and y [m].
    cells : Lattice
        Lattice of the cells. The measurement keeps the number of layers and uses few columns.
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
    """See `volume_round_off`; depths are in units of the cell height."""
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
