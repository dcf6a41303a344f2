"""Table of the kernels and coefficients between sources and outputs in space."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eigencontact.convolution.volume_layout import VolumeKernels
from eigencontact.core.array_types import Array, FloatArray
from eigencontact.errors import require

__all__ = ["Coefficients", "WeightedSums"]

#: Coefficient of (kernel, source).
Coefficients = Mapping[tuple[int, int], float]


@dataclass(frozen=True)
class Row:
    """One transformed sum and its destination: ``(output, power of the depth, factor)``."""

    terms: Coefficients
    into: tuple[tuple[int, int, float], ...]


class WeightedSums:
    """Outputs as sums of ``coefficient * depth**power * kernel * source`` with few inverse transforms.

    Parameters
    ----------
    kernels : VolumeKernels
        Spectra.
    table : mapping of (output, power) to coefficients
        Coefficients of (kernel, source) of each output and power of the target's depth.
    sources, outputs : sequence of (int, int)
        Parity along (y, x) of each source and output: a kernel between them has the product of theirs. (Reflection
        along x keeps an even and reverses an odd component; with three sources xx, xz and xy of a tensor these are
        (1, 1), (1, -1) and (-1, -1).) Used where the layout is folded.

    Notes
    -----
    A row of the table that is a combination of others (the zz component of a traceless part) is not transformed a
    second time, nor a source that acts as a combination of others (eigenstrain yy in plane strain).
    """

    def __init__(
        self,
        kernels: VolumeKernels,
        table: Mapping[tuple[int, int], Coefficients],
        *,
        sources: Sequence[tuple[int, int]],
        outputs: Sequence[tuple[int, int]],
    ) -> None:
        self.kernels, self.sources, self.outputs = kernels, tuple(sources), tuple(outputs)
        self.powers = 1 + max((power for _, power in table), default=0)
        for (output, _), terms in table.items():
            for kernel, source in terms:
                self._check(output, kernel, source)
        self._merged = _dependent(table)
        active_terms = {
            row: {term: terms[term] for term in terms if term[1] not in self._merged} for row, terms in table.items()
        }
        self.rows = _independent(active_terms)

    def _check(self, output: int, kernel: int, source: int) -> None:
        """Refuse a kernel without the symmetry of its source and output."""
        product = tuple(a * b for a, b in zip(self.outputs[output], self.sources[source], strict=True))
        kernel_parity = self.kernels.parities[kernel][1:]
        where = f"(the product of output {output} and source {source})"
        require(
            not self.kernels.layout.folded or kernel_parity == product,
            "convolution",
            f"kernels[{kernel}].parity",
            kernel_parity,
            f"{product} {where}",
        )

    def rows_of(self, active: Sequence[int]) -> list[Row]:
        """Rows that some of the sources reach: as many inverse transforms along z."""
        return [row for row in self.rows if any(source in active for _, source in row.terms)]

    def merged(self, fields: Array) -> Array:
        """Sources ``(n_sources, ...)`` with those that act as combinations of others added to these."""
        if not any(fields[source].any() for source in self._merged):
            return fields
        out = np.array(fields)
        for source, weights in self._merged.items():
            for target, weight in weights.items():
                out[target] += weight * fields[source]
            out[source] = 0
        return out

    def turned(self, parity: tuple[int, int]) -> bool:
        """Whether a field is carried as 1j times itself, so that folded kernels need no factor 1j."""
        return self.kernels.layout.folded and parity[0] * parity[1] < 0

    def matrices(self, active: Sequence[int]) -> list[tuple[int, int, FloatArray]]:
        """Column range and coefficients ``(columns, kernels)`` of each row of `rows_of`.

        The columns are the active sources' spectra, then these at -kz.
        """
        width, rows = len(active), []
        place = {source: position for position, source in enumerate(active)}
        for row in self.rows_of(active):
            full = np.zeros((2 * width, len(self.kernels)))
            for (kernel, source), value in row.terms.items():
                if source in place:
                    # Both ends carry a factor 1j where turned: 1j * 1j asks for a minus.
                    sign = (
                        -1.0 if self.turned(self.sources[source]) and self.turned(self.outputs[row.into[0][0]]) else 1.0
                    )
                    column = place[source] + (width if self.kernels.correlations[kernel] else 0)
                    full[column, kernel] += sign * value
            used = np.flatnonzero(full.any(axis=1))
            first, last = int(used[0]), int(used[-1]) + 1
            rows.append((first, last, full[first:last]))
        return rows


def _combination(vector: FloatArray, vectors: Sequence[FloatArray]) -> FloatArray | None:
    """Weights with which others add up to a vector; None where they cannot."""
    if not vectors:
        return None
    weights = np.asarray(np.linalg.lstsq(np.array(vectors).T, vector)[0], dtype=float)
    remainder = vector - weights @ np.array(vectors)
    return weights if np.abs(remainder).max() <= 1e-13 * np.abs(vector).max() else None


def _independent(table: Mapping[tuple[int, int], Coefficients]) -> list[Row]:
    """Rows of the table without rows that are combinations of larger rows of the same power."""
    keys = sorted({term for terms in table.values() for term in terms})
    columns = {key: k for k, key in enumerate(keys)}
    rows: list[Row] = []
    for power in sorted({power for _, power in table}):
        independent: list[int] = []
        vectors: list[FloatArray] = []
        outputs = [output for output, p in sorted(table) if p == power]
        for output in sorted(outputs, key=lambda output: -_size(table[output, power].values())):
            terms = {key: value for key, value in table[output, power].items() if value}
            vector = np.zeros(len(keys))
            vector[[columns[key] for key in terms]] = list(terms.values())
            if not terms:
                continue
            weights = _combination(vector, vectors)
            if weights is None:
                independent.append(len(rows))
                vectors.append(vector)
                rows.append(Row(terms, ((output, power, 1.0),)))
                continue
            for number, weight in zip(independent, weights, strict=True):
                if abs(weight) > 1e-13:
                    into = (*rows[number].into, (output, power, float(weight)))
                    rows[number] = Row(rows[number].terms, into)
    return rows


def _dependent(table: Mapping[tuple[int, int], Coefficients]) -> dict[int, dict[int, float]]:
    """Sources that act as combinations of others with larger coefficients, with the weights of these."""
    places = sorted({(row, kernel) for row, terms in table.items() for kernel, _ in terms})
    numbers = {place: number for number, place in enumerate(places)}
    columns: dict[int, FloatArray] = {}
    for row, terms in table.items():
        for (kernel, source), value in terms.items():
            columns.setdefault(source, np.zeros(len(places)))[numbers[row, kernel]] = value
    independent: list[int] = []
    merged: dict[int, dict[int, float]] = {}
    for source in sorted(columns, key=lambda source: (-_size(columns[source]), source)):
        weights = _combination(columns[source], [columns[basis_source] for basis_source in independent])
        if weights is None:
            independent.append(source)
        else:
            merged[source] = {
                basis_source: float(weight)
                for basis_source, weight in zip(independent, weights, strict=True)
                if abs(weight) > 1e-13
            }
    return merged


def _size(values: Iterable[float]) -> float:
    """Norm, rounded so that what is equal but for rounding stays in order."""
    return float(np.float32(np.linalg.norm(list(values))))
