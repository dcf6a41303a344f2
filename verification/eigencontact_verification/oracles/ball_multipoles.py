r"""A ball of another material in a half-space, in full space or beside its mirror image, loaded about an axis.

No eigenstrain and no equivalent inclusion: the field outside the ball is a sum of elastic multipoles at its centre and
of their images in closed form; the field inside is a sum of Navier polynomials. Both agree on the sphere in the sense
of Betti's theorem.

* Multipoles and polynomials have vector harmonics of one degree l on the sphere, two families each::

      outside  phi = I_l;    psi = I_(l-1), phi = -m (m + k) / (2m + 1) I_(l-2)            m = l - 1, k = 4 (1 - nu)
      inside   phi = R_l;    psi = R_(l+1), phi = -(l+2) (l + 2 - k) / (2l + 3) R_(l+2)

* An unknown is a Navier polynomial w of the ball's material, traction t. The multipoles that belong to it are those of
  Somigliana's representation with w and t on the sphere: the outer field, less a regular field of the body, is (w, t).
* One condition per unknown b: the integral of ``t_b u - w_b t`` over the sphere vanishes, u and t of the whole outer
  field. Strains of degree N in the ball give 2 (N + 1) unknowns. The answers are those of equivalent inclusions of
  degree N, and exact as N grows.

Units: the ball's radius is 1, twice the shear modulus of the body is 1.

References
----------
P. C. Waterman 1969, J. Acoust. Soc. Am. 45, 1417 (the same conditions for waves); J. N. Goodier 1933, Trans. ASME 55,
39 (ball in a body under tension). Images: the condition of no traction in Hankel's transforms, worked out anew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import Literal

import numpy as np
from numpy.polynomial.legendre import legder, leggauss, legval
from numpy.typing import NDArray

from eigencontact_verification.oracles.axial_potentials import fields, regular, singular, sphere_values

__all__ = ["BallMultipoles", "remote_field", "tension"]

FloatArray = NDArray[np.float64]
Pair = tuple[FloatArray, FloatArray]
#: Six of `axial_potentials.fields` at places (r, z), z from the centre of the ball.
Load = Callable[[FloatArray, FloatArray], FloatArray]


def _polynomial(l: int, family: int, nu: float, r: FloatArray, z: FloatArray) -> FloatArray:
    """Fields of a Navier polynomial of vector degree l, times l!, z from the centre."""
    basis = regular(l + 3, r, z)
    phi, psi = basis[:, l], np.zeros((5, *r.shape))
    if family == 1:
        phi = -(l + 2) * (l + 2 - 4 * (1 - nu)) / (2 * l + 3) * basis[:, l + 2]
        psi = basis[:, l + 1]
    return factorial(l) * fields(phi, psi, r, z, nu)


def remote_field(l: int, family: int, nu: float) -> Load:
    """Stress far away that is a polynomial: of degree l - 2 in family 0, of degree l in family 1."""
    return lambda r, z: _polynomial(l, family, nu, r, z)


def tension(nu: float) -> Load:
    """Tension 1 along the axis."""

    def load(r: FloatArray, z: FloatArray) -> FloatArray:
        zero = np.zeros_like(r)
        return np.stack([-nu * r / (1 + nu), z / (1 + nu), zero, zero, zero + 1.0, zero])

    return load


@dataclass(frozen=True, kw_only=True)
class BallMultipoles:
    """Ball of radius 1 about (0, depth) and its unknowns.

    Attributes
    ----------
    nu : float
        Poisson's ratio of the body, below 1/2, where no regular field changes the volume.
    ratio : float
        Shear modulus of the ball over that of the body; 0 is a void, infinity a rigid ball; not 1 with equal
        Poisson's ratios, which leaves no unknown.
    inner_nu : float
        Poisson's ratio of the ball; without effect on voids and rigid balls but for how fast degrees converge.
    degree : int
        Degree N of the strain inside.
    boundary : {"free", "mirror", "none"}
        The plane z = 0: a free surface, a plane of symmetry with an equal ball behind it, or nothing.
    depth : float
        Of the centre, above 1; without effect without a plane.
    nodes : int
        Gauss points from pole to pole.
    """

    nu: float
    ratio: float
    inner_nu: float
    degree: int
    boundary: Literal["free", "mirror", "none"] = "none"
    depth: float = 2.0
    nodes: int = 160

    @cached_property
    def _rule(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Sine, cosine and weight of the points of the sphere."""
        cosine, weight = leggauss(self.nodes)
        return np.sqrt(1 - cosine**2), cosine, weight

    @property
    def unknowns(self) -> list[tuple[int, int]]:
        """Vector degree and family of the unknowns; those of lower strain degree first."""
        pairs = [(l, 1) for l in range(self.degree + 1)] + [(l, 0) for l in range(2, self.degree + 3)]
        return sorted(pairs, key=lambda pair: pair[0] - 2 * (pair[1] == 0))

    def inner_unit_fields(self, r: FloatArray, z: FloatArray) -> FloatArray:
        """Six of `axial_potentials.fields` by each unknown in the ball, (6, unknowns, ...); z from the centre."""
        out = np.stack([_polynomial(l, k, self.inner_nu, r, z) for l, k in self.unknowns], axis=1)
        if np.isinf(self.ratio):
            out[:2] = 0.0
        else:
            out[2:] *= self.ratio
        return out

    @cached_property
    def _inner(self) -> FloatArray:
        """Displacement and traction of the unknowns on the sphere, (unknowns, 4, nodes)."""
        sine, cosine, _ = self._rule
        return np.moveaxis(sphere_values(self.inner_unit_fields(sine, cosine), sine, cosine), 0, 1)

    def _outer(self, l: int, family: int) -> Pair:
        """Coefficients of I_0, I_1, ... in phi and psi of a multipole over (l - 1)!, z from the centre."""
        phi, psi = np.zeros(self.degree + 3), np.zeros(self.degree + 3)
        m = l - 1
        if family == 0:
            phi[l] = 1.0
        else:
            psi[m] = 1.0
            if m:
                phi[m - 1] = -m * (m + 4 * (1 - self.nu)) / (2 * m + 1)
        scale = 1.0 / factorial(max(m, 0))
        return scale * phi, scale * psi

    @cached_property
    def sources(self) -> Pair:
        """Coefficients of I_0, I_1, ... in phi and psi of the unknowns' multipoles; z from the plane.

        Both are (unknowns, count).
        """
        sine, cosine, weight = self._rule
        basis = singular(self.degree + 3, sine, cosine)
        out = np.zeros((2, len(self.unknowns), self.degree + 3))
        for row, (l, _) in enumerate(self.unknowns):
            values = legval(cosine, np.eye(l + 1)[l])
            turned = -sine * legval(cosine, legder(np.eye(l + 1)[l])) if l else np.zeros_like(sine)

            def parts(on_sphere: FloatArray, values: FloatArray = values, turned: FloatArray = turned) -> FloatArray:
                shapes = np.array([values, turned, values, turned]) * weight
                return np.asarray((on_sphere * shapes).sum(axis=-1))

            outer = [self._outer(l, family) for family in ((0, 1) if l else (0,))]
            unit = []
            for pair in outer:
                phi, psi = (np.einsum("l,dln->dn", coefficients, basis) for coefficients in pair)
                unit.append(fields(phi, psi, sine, cosine, self.nu))
            unit += [-_polynomial(l, family, self.nu, sine, cosine) for family in ((0, 1) if l else (1,))]
            system = np.array([parts(sphere_values(column, sine, cosine)) for column in unit]).T
            rows = slice(None) if l else slice(None, None, 2)
            amounts = np.linalg.solve(system[rows], parts(self._inner[row])[rows])
            for amount, pair in zip(amounts, outer, strict=False):
                out[:, row] += amount * np.array(pair)
        out[0] -= self.depth * out[1]
        return out[0], out[1]

    @cached_property
    def _images(self) -> Pair:
        """Coefficients of I_-1, I_0, ... about the mirrored centre in phi and psi, (unknowns, count + 2)."""
        phi, psi = self.sources
        count, nu = phi.shape[1], self.nu
        sign = (-1.0) ** np.arange(count)
        out = np.zeros((2, len(phi), count + 2))
        if self.boundary == "free":
            out[0, :, 1:-1] += (3 - 4 * nu) * sign * phi
            out[0, :, :-2] -= 4 * (1 - nu) * (1 - 2 * nu) * sign * psi
            out[1, :, 2:] -= 2 * sign * phi
            out[1, :, 1:-1] += (3 - 4 * nu) * sign * psi
        elif self.boundary == "mirror":
            out[0, :, 1:-1], out[1, :, 1:-1] = sign * phi, -sign * psi
        return out[0], out[1]

    def unit_fields(self, r: FloatArray, z: FloatArray) -> FloatArray:
        """Six of `axial_potentials.fields` by each unknown outside the ball, (6, unknowns, ...); z from the centre."""
        depth = z + self.depth
        pairs = [(self.sources, singular(self.degree + 3, r, z))]
        if self.boundary != "none":
            mirrored = singular(self.degree + 4, r, depth + self.depth, logarithm=True)
            pairs.append((self._images, mirrored))
        phi, psi = (sum(np.einsum("ul,dl...->du...", pair[k], basis) for pair, basis in pairs) for k in (0, 1))
        return fields(phi, psi, r, depth, self.nu)

    def conditions(self, on_sphere: FloatArray) -> FloatArray:
        """The integral of ``t_b u - w_b t`` for every unknown b, (unknowns, ...), of values (4, ..., nodes)."""
        weight = self._rule[2]
        u, t = on_sphere[:2], on_sphere[2:]
        inner = self._inner * weight
        return np.asarray(np.einsum("bcn,c...n->b...", inner[:, 2:], u) - np.einsum("bcn,c...n->b...", inner[:, :2], t))

    @cached_property
    def matrix(self) -> FloatArray:
        """Conditions of the unknowns' fields, (unknowns, unknowns)."""
        sine, cosine, _ = self._rule
        return self.conditions(sphere_values(self.unit_fields(sine, cosine), sine, cosine))

    def conditions_of(self, load: Load) -> FloatArray:
        """Conditions of a load, (unknowns, ...)."""
        sine, cosine, _ = self._rule
        return self.conditions(sphere_values(load(sine, cosine), sine, cosine))

    def solve(self, load: Load) -> FloatArray:
        """Amounts of the unknowns, (unknowns,)."""
        return np.asarray(np.linalg.solve(self.matrix, -self.conditions_of(load)))

    def field(self, load: Load, r: FloatArray, z: FloatArray) -> FloatArray:
        """Six of `axial_potentials.fields` outside the ball, (6, ...), the load's own among them."""
        return np.asarray(load(r, z) + np.einsum("cu...,u->c...", self.unit_fields(r, z), self.solve(load)))
