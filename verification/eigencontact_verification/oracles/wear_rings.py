"""Wear of bodies of revolution, by rings of uniform pressure on a half-space: sliding and fretting in partial slip.

The surface answers a disk of radius b under the pressure p by

    u(r) = 4 p b/(π E*) E(r²/b²) inside,   4 p r/(π E*) (E(m) - (1 - m) K(m)) outside, m = b²/r²,

with the complete elliptic integrals of the parameter; a ring is the difference of two disks. Contact is unilateral at
the middle of every ring, ``p >= 0, g = h + w + u[p] - d >= 0, p g = 0``, found by block pivoting with dense matrices.
Wear that grows like κ p in a step is a compliance κ on the diagonal: the step is implicit (backward Euler).

Fretting follows Jäger and Ciavarella: with friction μ and the modulus ratio E*/G*, the shift u0 shears the contact by
``μ (p - p*)``, where p* is the pressure of a smaller approach, ``d* = d - e``, ``e = u0 G*/(μ E*)``. The slip is
``μ E*/G*`` times the gap that is left at d*. A full cycle ±u0 slips each ring four times as far. So any worn profile
needs two contacts, no more; gross slip is the case without contact at d*. Slip along the shift only, and no coupling
of shear and pressure: as in Cattaneo's and Mindlin's solution.

Conventions: pressure positive in compression; w is the worn depth of both bodies, added to the initial gap h.

References
----------
K. L. Johnson 1985, Contact Mechanics, section 3.4(a) (disk); J. Jäger 1998, J. Tribol. 120, 677, and
M. Ciavarella 1998, Int. J. Solids Struct. 35, 2349 (superposition); L. A. Galin 1976 and I. G. Goryacheva 1998,
Contact Mechanics in Tribology (wear as a compliance); block pivoting as in `dense`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles.coated_contact import Layer, layer_response

__all__ = ["Contact", "Fretted", "Rings", "Slid", "fret", "slide"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Contact:
    """A solved contact.

    Attributes
    ----------
    pressure : (n,) array
        p [Pa].
    gap : (n,) array
        g [m], zero where p may be positive.
    approach : float
        d [m].
    touching : (n,) bool array
        Rings in contact.
    """

    pressure: FloatArray
    gap: FloatArray
    approach: float
    touching: NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, eq=False)
class Rings:
    """A half-space divided into rings.

    Attributes
    ----------
    edges : (n + 1,) array
        Radii between the rings [m], from 0 up.
    contact_modulus : float
        E* [Pa]; with layers that of the top layer and a rigid partner.
    layers : tuple of (thickness [m], Young's modulus [Pa], Poisson's ratio)
        Bonded layers from the surface down; none by default.
    substrate : (Young's modulus [Pa], Poisson's ratio), optional
        Needed with layers.
    """

    edges: FloatArray
    contact_modulus: float
    layers: tuple[Layer, ...] = ()
    substrate: tuple[float, float] = (0.0, 0.0)

    @cached_property
    def middles(self) -> FloatArray:
        """Radii of the middles of the rings [m]."""
        return np.asarray(0.5 * (self.edges[1:] + self.edges[:-1]))

    @cached_property
    def areas(self) -> FloatArray:
        """Areas of the rings [m²]."""
        return np.asarray(np.pi * np.diff(self.edges**2))

    @cached_property
    def compliance(self) -> FloatArray:
        """Displacement at the middle of every ring (row) under unit pressure on every ring (column) [m/Pa]."""
        from scipy.special import j0, j1

        disks = _disk(self.middles[:, None], self.edges[None, :])
        response = layer_response(self.layers, self.substrate, self.contact_modulus, 0.0)
        if response is not None:
            k, weights, values = response.quadrature(2.0 * float(self.edges[-1]))
            source = self.edges * j1(np.multiply.outer(k, self.edges)) / k[:, None]
            disks += 2.0 * j0(np.multiply.outer(self.middles, k)) @ ((weights * values.real)[:, None] * source)
        return np.asarray(np.diff(disks, axis=1) / self.contact_modulus)

    def press(
        self,
        separation: FloatArray,
        *,
        load: float | None = None,
        approach: float | None = None,
        softness: ArrayLike = 0.0,
        start: NDArray[np.bool_] | None = None,
    ) -> Contact:
        """Press a rigid profile onto the rings.

        Parameters
        ----------
        separation : (n,) array
            Gap at the middles before pressing [m].
        load, approach : float
            One of the two [N], [m].
        softness : float or (n,) array
            κ [m/Pa], what yields in proportion to the pressure besides.
        start : (n,) bool array, optional
            Rings that touch, as a guess.

        Raises
        ------
        RuntimeError
            Block pivoting does not end.
        """
        n = separation.size
        matrix = self.compliance + np.diag(np.broadcast_to(softness, n))
        inside = separation - separation.min() <= 0.1 * np.ptp(separation) if start is None else start
        for _ in range(200):
            rows = np.flatnonzero(inside)
            block, pressure = matrix[np.ix_(rows, rows)], np.zeros(n)
            if load is None:
                rigid = float(approach or 0.0)
                pressure[rows] = np.linalg.solve(block, rigid - separation[rows])
            else:
                by_approach, by_separation = np.linalg.solve(
                    block, np.stack([np.ones(rows.size), separation[rows]], axis=1)
                ).T
                rigid = float((load + self.areas[rows] @ by_separation) / (self.areas[rows] @ by_approach))
                pressure[rows] = rigid * by_approach - by_separation
            gap = separation + matrix @ pressure - rigid
            gap[rows] = 0.0
            wrong = (pressure < 0.0) | (gap < -1e-13 * abs(rigid))
            if not wrong.any():
                return Contact(pressure=pressure, gap=gap, approach=rigid, touching=inside)
            inside = inside ^ wrong
        raise RuntimeError(f"no contact state found for {n} rings (load {load}, approach {approach})")


@dataclass(frozen=True, kw_only=True, eq=False)
class Slid:
    """A state of gross sliding: worn volume [m³], the contact, and the worn depth (n,) [m]."""

    volume: float
    contact: Contact
    depth: FloatArray


def slide(rings: Rings, separation: FloatArray, load: float, volumes: Sequence[float]) -> Iterator[Slid]:
    """Wear in proportion to the pressure under a constant load, one implicit step to each worn volume.

    Parameters
    ----------
    rings : Rings
    separation : (n,) array
        Initial gap [m].
    load : float
        P [N].
    volumes : sequence of float
        Rising worn volumes V [m³]; V = k P t by the law, whatever the contact does.

    Notes
    -----
    First order in the steps: extrapolate two runs, ``2 fine - coarse``. Rings that end at the rim of a flat punch make
    the punch.
    """
    depth, before, touching = np.zeros_like(rings.middles), 0.0, None
    for volume in volumes:
        softness = (volume - before) / load
        contact = rings.press(separation + depth, load=load, softness=softness, start=touching)
        depth, before, touching = depth + softness * contact.pressure, volume, contact.touching
        yield Slid(volume=volume, contact=contact, depth=depth)


@dataclass(frozen=True, kw_only=True, eq=False)
class Fretted:
    """A state of fretting.

    Attributes
    ----------
    cycles : float
        N so far.
    contact : Contact
    depth : (n,) array
        Worn depth [m].
    slip : (n,) array
        Slip of a quarter cycle [m], in contact or not; zero in the stick disk.
    energy : float
        Work of friction in a cycle [J].
    sticking : (n,) bool array
        Rings that stick.
    """

    cycles: float
    contact: Contact
    depth: FloatArray
    slip: FloatArray
    energy: float
    sticking: NDArray[np.bool_]


def fret(
    rings: Rings,
    separation: FloatArray,
    cycles: Sequence[float],
    *,
    amplitude: float,
    friction: float,
    coefficient: float,
    modulus_ratio: float,
    load: float | None = None,
    approach: float | None = None,
    sweeps: int = 3,
) -> Iterator[Fretted]:
    """Fretting between ±u0: the first cycle's state, then one state after each update.

    Parameters
    ----------
    rings : Rings
    separation : (n,) array
        Initial gap [m].
    cycles : sequence of float
        Cycles of each update; parts of a cycle allowed.
    amplitude, friction, modulus_ratio : float
        u0 [m], μ, E*/G*.
    coefficient : float
        α [m³/J]: depth = α times the work of friction per area.
    load, approach : float
        Whichever is kept [N], [m].
    sweeps : int
        How often the slip of the end of an update is found anew. One: it is that of its begin.

    Notes
    -----
    Pressure implicit always; the slip too with several sweeps. First order in the size of the update.
    """
    slipping = amplitude / (friction * modulus_ratio)
    depth, cycle = np.zeros_like(rings.middles), 0.0
    contact = rings.press(separation, load=load, approach=approach)

    def slip_of(worn: FloatArray, begin: NDArray[np.bool_]) -> tuple[FloatArray, NDArray[np.bool_]]:
        smaller = rings.press(separation + worn, approach=contact.approach - slipping, start=begin)
        return friction * modulus_ratio * smaller.gap, smaller.touching

    def state() -> Fretted:
        energy = 4.0 * friction * float(rings.areas @ (contact.pressure * slip))
        return Fretted(cycles=cycle, contact=contact, depth=depth, slip=slip, energy=energy, sticking=sticking)

    slip, sticking = slip_of(depth, contact.touching)
    yield state()
    for update in cycles:
        worn = depth
        for _ in range(sweeps):
            softness = 4.0 * coefficient * friction * update * slip
            contact = rings.press(
                separation + depth, load=load, approach=approach, softness=softness, start=contact.touching
            )
            worn = depth + softness * contact.pressure
            slip, sticking = slip_of(worn, sticking)
        depth, cycle = worn, cycle + update
        yield state()


def _disk(r: FloatArray, b: FloatArray) -> FloatArray:
    """E* u(r) for unit pressure inside the radius b [m]."""
    from scipy.special import ellipe, ellipkm1

    r, b = np.broadcast_arrays(r, b)
    small, large = np.minimum(r, b), np.maximum(r, b)
    m = (small / large) ** 2
    # (1 - m) K(m) tends to 0 at m = 1
    term = (1.0 - m) * ellipkm1(np.maximum(1.0 - m, 1e-300))
    return np.asarray(4.0 / np.pi * large * np.where(r < b, ellipe(m), ellipe(m) - term))
