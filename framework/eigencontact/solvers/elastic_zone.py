"""Zone of a body in which the elastic stress under a contact exceeds the limit of a law.

The search samples boxes around the contact; each box is twice as large and twice as coarse as the previous one. All
boxes have the same number of points, so that the work is bounded for any load.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.core.material import Material
from eigencontact.core.tensors import COMPONENTS, SQRT2

__all__ = ["ACROSS", "ElasticStress", "Exceeds", "Tractions", "Zone", "elastic_zone", "overload"]

BoolArray = NDArray[np.bool_]
#: Tractions [Pa] on a window, by name; the pressure is ``"p"``.
Tractions = tuple[Grid, Mapping[str, FloatArray]]
#: Whether Mandel stress ``(6, n)`` [Pa] at depths ``(n,)`` [m] exceeds the limit of a law.
Exceeds = Callable[[FloatArray, FloatArray], BoolArray]

#: Number of coarse cells across a contact.
ACROSS = 16
#: Number of boxes in the search: the first extends 1.5 contact widths in each direction, the last 12. Stress falls with
#: the square of the distance, so a zone beyond the last box needs a load of several hundred times the elastic limit.
_BOXES = 4
#: Approximate number of points per call of a law, if a depth does not have more [points].
_AT_ONCE = 1 << 15
#: Largest memory for stored elastic stress, all loads together [bytes].
_STRESS_MEMORY = 100_000_000
#: Number of points with the largest stress for which the ratio of load to limit is searched (more than the cells under
#: a contact at half the depths); number of halvings of the stress, and of the interval after that.
_LARGEST, _HALVINGS, _BISECTIONS = 2500, 60, 5


class Influence(Protocol):
    """Stress in a half-space under a loaded rectangle; see `eigencontact.plugin.SurfaceInfluence.sample`."""

    def sample(
        self, quantity: str, components: Sequence[str], x: FloatArray, y: FloatArray, z: float,
        half_widths: tuple[float, float], material: Material,
    ) -> FloatArray:  # fmt: skip
        """Components at offsets x, y [m] and depth z [m], under unit traction, ``(n, ny, nx)``."""
        ...


@dataclass(frozen=True, slots=True)
class Zone:
    """Bounds (x, y, z) [m] of a zone; `closed` if it does not reach the rim of the largest box."""

    low: FloatArray
    high: FloatArray
    closed: bool


class ElasticStress:
    """Stress by the tractions of coarse contacts, cached for repeated loads and factors."""

    def __init__(self, influences: Mapping[str, Influence], material: Material) -> None:
        self._influences, self._material, self._room = influences, material, _STRESS_MEMORY
        self._contributions: dict[tuple[Any, ...], list[tuple[FloatArray, FloatArray]]] = {}

    def at(self, edges: tuple[float, float], loaded: Mapping[str, FloatArray], count: int, z: float) -> FloatArray:
        """Mandel stress ``(6, count, count)`` [Pa] around loaded cells of edges (dx, dy) [m], at the depth `z` [m].

        Strips have an infinite edge along y and stress ``(6, 1, count)``.
        """
        stress = np.zeros((6, _rows(edges, count), count))
        for name, field in loaded.items():
            self._add(stress, name, edges, field, z)
        stress[3:] *= SQRT2
        return stress

    def _add(self, stress: FloatArray, name: str, edges: tuple[float, float], field: FloatArray, z: float) -> None:
        counts = stress.shape[1:]
        before = self._contributions.setdefault((name, *edges, field.shape, counts, z), [])
        for earlier_field, contribution in before:
            if np.array_equal(earlier_field, field):
                stress += contribution
                return
            if np.array_equal(earlier_field, -field):
                stress -= contribution
                return
        # Table of all offsets between loaded cells and points, for the sum over the cells.
        y, x = (
            (np.arange(1 - loads, count) + 0.5 * (loads - count)) * (edge if edge < np.inf else 1.0)
            for loads, count, edge in zip(field.shape, counts, edges[::-1], strict=True)
        )
        half = (0.5 * edges[0], 0.5 * edges[1])
        tables = self._influences[name].sample("stress", list(COMPONENTS), x, y, z, half, self._material)
        contribution = _convolved(tables, field)
        stress += contribution
        if contribution.nbytes <= self._room:
            self._room -= contribution.nbytes
            before.append((field, contribution))


def elastic_zone(exceeds: Exceeds, load: Tractions, elastic: ElasticStress, factor: float) -> Zone | None:
    """Zone in which `factor` times the elastic stress under tractions exceeds a limit; None without such a zone."""
    place = _loaded(load)
    if place is None:
        return None
    middle, edges, loaded = place
    count = _places(loaded)
    zone: Zone | None = None
    for _ in range(_BOXES):
        inside = _inside(exceeds, edges, loaded, elastic, count, factor)
        if not inside.any():
            return zone
        rims = [inside[-1], inside[:, :, [0, -1]], *([inside[:, [0, -1]]] if inside.shape[1] > 1 else [])]
        closed = not any(np.any(rim) for rim in rims)
        low, high = _bounds(inside, middle, edges)
        if zone is not None:
            low, high = np.minimum(low, zone.low), np.maximum(high, zone.high)
        zone = Zone(low, high, closed)
        if closed:
            break
        middle, edges, loaded = _coarser(middle, edges, loaded)
    return zone


def overload(exceeds: Exceeds, load: Tractions, elastic: ElasticStress) -> float:
    """Ratio of the elastic stress to the largest multiple within the elastic range of a law, to 10 %."""
    place = _loaded(load)
    if place is None:
        return 0.0
    _, edges, loaded = place
    count = _places(loaded)
    depths = (np.arange(count // 2) + 0.5) * edges[0]
    stress = np.stack([elastic.at(edges, loaded, count, float(z)) for z in depths], axis=1).reshape(6, -1)
    largest = np.argsort(np.linalg.norm(stress, axis=0))[-_LARGEST:]
    stress, z, fraction = stress[:, largest], np.repeat(depths, count * _rows(edges, count))[largest], 1.0
    for _ in range(_HALVINGS):
        violations = exceeds(fraction * stress, z)
        if not violations.any():
            break
        # Points below the limit at a smaller factor are left out: few remain.
        stress, z, fraction = stress[:, violations], z[violations], 0.5 * fraction
    low, high = fraction, 2.0 * fraction
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if exceeds(middle * stress, z).any() else (middle, high)
    return 1.0 / high


def _loaded(load: Tractions) -> tuple[FloatArray, tuple[float, float], dict[str, FloatArray]] | None:
    """Centre (x, y) [m] and edges (dx, dy) [m] of the cells under pressure, and their tractions."""
    window, fields = load
    box = Box.around(fields["p"] > 0)
    if box is None:
        return None
    middle = np.array([window.x[box.x0] + window.x[box.x1 - 1], window.y[box.y0] + window.y[box.y1 - 1]]) / 2
    loaded = {name: field[box.y0 : box.y1, box.x0 : box.x1] for name, field in fields.items()}
    return middle, (2.0 * window.half_widths[0], 2.0 * window.half_widths[1]), loaded


def _rows(edges: tuple[float, float], count: int) -> int:
    """Number of points along y of a box of the search; one for strips."""
    return count if edges[1] < np.inf else 1


def _places(loaded: Mapping[str, FloatArray]) -> int:
    """Number of points along one side of a box of the search."""
    ny, nx = loaded["p"].shape
    return 3 * max(int(ny), int(nx), ACROSS)


def _coarser(
    middle: FloatArray, edges: tuple[float, float], loaded: Mapping[str, FloatArray]
) -> tuple[FloatArray, tuple[float, float], dict[str, FloatArray]]:
    """Loaded cells merged in pairs in each direction with equal total forces; accurate enough at larger distances."""
    odd_y, odd_x = (size % 2 for size in loaded["p"].shape)
    joined = {}
    if edges[1] == np.inf:
        for name, field in loaded.items():
            even = np.pad(field, ((0, 0), (0, odd_x)))
            joined[name] = 0.5 * (even[:, ::2] + even[:, 1::2])
        return middle + 0.5 * np.array([odd_x * edges[0], 0.0]), (2.0 * edges[0], np.inf), joined
    for name, field in loaded.items():
        even = np.pad(field, ((0, odd_y), (0, odd_x)))
        joined[name] = 0.25 * (even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2])
    return middle + 0.5 * np.array([odd_x, odd_y]) * edges, (2.0 * edges[0], 2.0 * edges[1]), joined


def _inside(
    exceeds: Exceeds,
    edges: tuple[float, float],
    loaded: Mapping[str, FloatArray],
    elastic: ElasticStress,
    count: int,
    factor: float,
) -> BoolArray:
    """Whether stress exceeds the limit in coarse cells ``(nz, count or 1, count)`` around the loaded ones."""
    depths, rows = (np.arange(count // 2) + 0.5) * edges[0], _rows(edges, count)
    out = np.empty((depths.size, rows, count), dtype=bool)
    # A law is called for several depths together: for single depths the calls would dominate the time.
    for first in range(0, depths.size, together := max(1, _AT_ONCE // (rows * count))):
        block_depths = depths[first : first + together]
        stress = np.stack([elastic.at(edges, loaded, count, float(z)) for z in block_depths], axis=1)
        scaled = factor * stress.reshape(6, -1)
        out[first : first + together] = exceeds(scaled, np.repeat(block_depths, rows * count)).reshape(-1, rows, count)
    return out


def _bounds(inside: BoolArray, middle: FloatArray, edges: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
    """Bounds (x, y, z) [m] of the cells inside."""
    count = inside.shape[2]
    if edges[1] == np.inf:  # the single row has a length of one metre
        edges = (edges[0], 1.0)
        middle = np.array([middle[0], 0.5 * (count - 1)])
    spans = [np.flatnonzero(inside.any(axis=axes)) for axes in ((0, 1), (0, 2), (1, 2))]
    sides = np.array([edges[0], edges[1], edges[0]])
    starts = np.array([middle[0] - 0.5 * count * edges[0], middle[1] - 0.5 * count * edges[1], 0.0])
    low = starts + sides * np.array([span[0] for span in spans])
    return low, starts + sides * np.array([span[-1] + 1.0 for span in spans])


def _convolved(tables: FloatArray, field: FloatArray) -> FloatArray:
    """Sums over loaded cells if the tables ``(n, ny, nx)`` cover all of them."""
    shape = [fft.next_fast_len(size, real=True) for size in tables.shape[1:]]
    product = fft.irfft2(fft.rfft2(tables, shape) * fft.rfft2(field, shape), shape)
    rows, columns = field.shape
    return np.array(product[:, rows - 1 : tables.shape[1], columns - 1 : tables.shape[2]])
