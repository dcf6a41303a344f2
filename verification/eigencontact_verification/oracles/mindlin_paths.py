"""Spheres under normal and tangential loads that both vary: the paths of Mindlin and Deresiewicz.

Every state is a superposition of Hertz pressures: ``q(r) = ∫ g dp`` with p(r; P') the pressure under the load P', from
P' = 0 to the present load P, and a profile g(P') between -μ and μ. Hence

    Q = ∫ g dP',   δ = (3 C/16) ∫ g d(P'/a'),   U = (C/8) ∫ (g/a') (∫_0^P' g dP'') dP'

because the increment of a Hertz pressure is that of a flat punch, under which tangential traction displaces the disk
evenly. A change of the loads acts on the profile from its end: a rise of P with ``|dQ| <= μ dP`` appends g = dQ/dP
without any slip; anything else sets g = +μ or -μ from some P_c < P on, which is where the stick disk of the change
ends.

Conventions and validity as in `eigencontact_verification.oracles.cattaneo`; a' = (3 P' R/(4 E*))^(1/3).

References
----------
R. D. Mindlin, H. Deresiewicz 1953, J. Appl. Mech. 20, 327 (the paths);
J. Jäger 1993, Arch. Appl. Mech. 63, 402; M. Ciavarella 1998, Int. J. Solids Struct. 35, 2349 (the superposition).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["SphereOnPath"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class SphereOnPath:
    """State of a contact that began unloaded.

    Parameters
    ----------
    friction : float
        μ.
    stretch : float
        a'³/P' = 3R/(4 E*) [m³/N].
    compliance : float
        C = Σ (2-ν)/G [1/Pa].
    pieces : tuple of (load, slope)
        The profile g from the bottom: its value up to each load [N]; the last load is the present P.

    Examples
    --------
    >>> start = SphereOnPath(friction=0.5, stretch=1.0, compliance=1.0)
    >>> state = start.to(1.0, 0.0).to(1.0, 0.25)
    >>> round(state.tangential_load, 12), round(state.stick_radius, 6), round(state.shift, 6)
    (0.25, 0.793701, 0.034691)
    """

    friction: float
    stretch: float
    compliance: float
    pieces: tuple[tuple[float, float], ...] = ()
    #: Load where the stick disk of the last change ends.
    stick_load: float = 0.0

    def to(self, load: float, tangential_load: float) -> SphereOnPath:
        """Go straight to P > 0 and Q [N].

        Raises
        ------
        ValueError
            The contact slides as a whole: |Q| > μP.
        """
        before, shear = self.load, self.tangential_load
        change, turn = load - before, tangential_load - shear
        tiny = 1e-13 * self.friction * max(load, before)
        if change > 0 and abs(turn) <= self.friction * change + tiny:
            slope = float(np.clip(turn / change, -self.friction, self.friction))
            continues = bool(self.pieces) and abs(self.pieces[-1][1] - slope) <= 1e-12 * self.friction
            pieces = self.pieces[:-1] if continues else self.pieces
            return replace(self, pieces=(*pieces, (load, slope)), stick_load=load)
        if change < 0:  # the top of the profile comes off; what that leaves of Q tells the direction of slip
            bottom = self.pieces[-2][0] if len(self.pieces) > 1 else 0.0
            if abs(turn - self.pieces[-1][1] * change) <= tiny:  # back the way it came: no slip
                share = min(1.0, (before - bottom) / -change)
                point = before + share * change
                pieces = (*self.pieces[:-1], (point, self.pieces[-1][1])) if share == 1.0 else self.pieces[:-1]
                back = replace(self, pieces=pieces, stick_load=point)
                return back if share == 1.0 else back.to(load, tangential_load)
            sign = np.sign(turn - self.pieces[-1][1] * change)
        else:
            sign = np.sign(turn)
        return self._slipped(load, tangential_load, float(sign) * self.friction) if turn or change else self

    def _slipped(self, load: float, tangential_load: float, slope: float) -> SphereOnPath:
        """Profile with `slope` from where it must begin to carry Q."""
        pieces: list[tuple[float, float]] = []
        below, carried = 0.0, 0.0
        top = (*self.pieces, (load, slope)) if load > self.load else self.pieces
        for piece_end, value in top:
            end = min(piece_end, load)
            # carried + value (x - below) + slope (load - x) = Q for some x in the piece?
            remaining = tangential_load - carried + value * below - slope * load
            x = remaining / (value - slope) if value != slope else np.inf
            if below - 1e-13 * load <= x <= end:
                x = max(x, below)
                tail = ((x, value), (load, slope)) if x > below else ((load, slope),)
                return replace(self, pieces=(*pieces, *tail), stick_load=float(x))
            pieces.append((end, value))
            carried += value * (end - below)
            below = end
            if end == load:
                break
        raise ValueError(f"tangential load must be at most {self.friction * load} in size (got {tangential_load})")

    @property
    def load(self) -> float:
        """P [N]."""
        return self.pieces[-1][0] if self.pieces else 0.0

    @property
    def radius(self) -> float:
        """Contact radius a [m]."""
        return float(np.cbrt(self.stretch * self.load))

    @property
    def stick_radius(self) -> float:
        """Radius of what did not slip in the last change [m]."""
        return float(np.cbrt(self.stretch * self.stick_load))

    @property
    def tangential_load(self) -> float:
        """Q [N]."""
        return float(sum(value * (end - below) for below, end, value in self._steps()))

    @property
    def shift(self) -> float:
        """δ [m]."""
        factor = 3.0 * self.compliance / 16.0 * self.stretch ** (-1.0 / 3.0)
        return float(factor * sum(value * (end ** (2 / 3) - below ** (2 / 3)) for below, end, value in self._steps()))

    @property
    def stored_energy(self) -> float:
        """Elastic energy of the shear alone, ½ ∫ q u dA [J]."""
        total, carried = 0.0, 0.0
        for below, end, value in self._steps():
            # ∫ (g/a') (carried + g (P' - below)) dP' with a' = (stretch P')^(1/3)
            first = 1.5 * (end ** (2 / 3) - below ** (2 / 3))
            second = 0.6 * (end ** (5 / 3) - below ** (5 / 3))
            total += value * ((carried - value * below) * first + value * second)
            carried += value * (end - below)
        return float(self.compliance / 8.0 * self.stretch ** (-1.0 / 3.0) * total)

    def shear(self, r: ArrayLike) -> FloatArray:
        """Shear traction [Pa] at the radius r [m]."""
        r = np.asarray(r, dtype=float)
        total = np.zeros(r.shape)
        for below, end, value in self._steps():
            total += value * (self._hertz(r, end) - self._hertz(r, below))
        return total

    def _hertz(self, r: FloatArray, load: float) -> FloatArray:
        # p = p0 √(1 - r²/a²) with p0/a = 3 P/(2π a³)
        square = (self.stretch * load) ** (2 / 3)
        return np.asarray(1.5 / (np.pi * self.stretch) * np.sqrt(np.maximum(0.0, square - r * r)))

    def _steps(self) -> list[tuple[float, float, float]]:
        ends = [end for end, _ in self.pieces]
        return [(below, end, value) for below, (end, value) in zip([0.0, *ends], self.pieces, strict=False)]
