"""Linear forms in the derivatives of potentials with powers of depth, for the half-space theorem.

A field of an inclusion is a sum of ``coefficient * z**power * derivative of a potential``. Keeping that sum as data
lets one formula, the displacement, give strain and stress by differentiation, serve points and grids, and tell which
kernels a quantity needs before any is evaluated.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from eigencontact.halfspace.potentials import Order

__all__ = ["INSIDE", "Form", "Kernel", "reduced", "reduced_in_plane"]

#: Whose potential ("real", "image" or "inside"), which ("psi", "phi", "chi" or ""), and how often it is differentiated.
Kernel = tuple[str, str, Order]
Term = tuple[int, Kernel]
Rule = Callable[[Kernel], "dict[Kernel, float] | None"]

#: The indicator of the source region.
INSIDE: Kernel = ("inside", "", (0, 0, 0))

# What is left of a coefficient by rounding when terms cancel, relative to coefficients of order one.
_ROUNDING = 1e-14


@dataclass(frozen=True)
class Form:
    """Sum of ``coefficient * z**power * kernel``.

    Examples
    --------
    >>> psi = Form.potential("image", "psi")
    >>> (2.0 * psi.d(0).times_z()).d(2)
    2 z image psi 101 + 2 image psi 100
    """

    terms: Mapping[Term, float] = field(default_factory=dict)

    @classmethod
    def potential(cls, origin: str, name: str = "") -> Form:
        """The potential itself; ``Form.potential("inside")`` is the indicator of the region."""
        return cls({(0, (origin, name, (0, 0, 0))): 1.0})

    def __add__(self, other: Form) -> Form:
        total = dict(self.terms)
        for term, value in other.terms.items():
            total[term] = total.get(term, 0.0) + value
        return Form({term: value for term, value in total.items() if abs(value) > _ROUNDING})

    def __sub__(self, other: Form) -> Form:
        return self + -1.0 * other

    def __rmul__(self, factor: float) -> Form:
        return Form({term: factor * value for term, value in self.terms.items()} if factor else {})

    def __iter__(self) -> Iterator[tuple[int, Kernel, float]]:
        for (power, kernel), value in self.terms.items():
            yield power, kernel, value

    def __repr__(self) -> str:
        def text(power: int, kernel: Kernel, value: float) -> str:
            z = "" if power == 0 else "z " if power == 1 else f"z^{power} "
            origin, name, order = kernel
            return f"{value:g} {z}{origin}" + (f" {name} {''.join(map(str, order))}" if name else "")

        return " + ".join(text(*term) for term in self) or "0"

    def times_z(self, times: int = 1) -> Form:
        """The form times z**times."""
        return Form({(power + times, kernel): value for (power, kernel), value in self.terms.items()})

    def d(self, axis: int) -> Form:
        """Derivative along x, y or z (axis 0, 1, 2) of the field point."""
        total = Form()
        for power, kernel, value in self:
            total = total + value * Form({(power, _raised(kernel, axis)): 1.0})
            if axis == 2 and power:
                total = total + value * Form({(power - 1, kernel): float(power)})
        return total

    def without_chi_zz(self) -> Form:
        """The same with Chi,zz written as Phi."""
        return self.replaced(
            lambda kernel: (
                {("image", "phi", _order(kernel[2], 0, 0, -2)): 1.0}
                if kernel[1] == "chi" and kernel[2][2] >= 2
                else None
            )
        )

    def replaced(self, rule: Rule) -> Form:
        """Form with every kernel replaced by the combination of `rule`, until none is left."""
        total, todo = Form(), dict(self.terms)
        while todo:
            (power, kernel), value = todo.popitem()
            combination = rule(kernel)
            if combination is None:
                total = total + Form({(power, kernel): value})
            else:
                for replacement, weight in combination.items():
                    todo[power, replacement] = todo.get((power, replacement), 0.0) + value * weight
        return total

    def on_surface(self) -> Form:
        """Form at z = 0, where real and mirror points coincide, in kernels of the image."""

        def mirrored(kernel: Kernel) -> dict[Kernel, float] | None:
            origin, name, order = kernel
            return {("image", name, order): -1.0 if order[2] % 2 else 1.0} if origin == "real" else None

        return Form({term: value for term, value in self.terms.items() if term[0] == 0}).replaced(mirrored)


def _raised(kernel: Kernel, axis: int) -> Kernel:
    origin, name, (nx, ny, nz) = kernel
    return origin, name, (nx + (axis == 0), ny + (axis == 1), nz + (axis == 2))


def _order(order: Order, dx: int, dy: int, dz: int) -> Order:
    return order[0] + dx, order[1] + dy, order[2] + dz


def reduced(kernel: Kernel) -> dict[Kernel, float] | None:
    """Rule for `Form.replaced` with the fewest kernels: Laplacians of Phi and Chi vanish, that of Psi is 2 Phi.

    Stress then needs 15 kernels in full space and 43 of the image. Valid because field points always lie outside the
    image; for the real source Phi = Laplacian(Psi)/2 also holds inside.
    """
    origin, name, order = kernel
    nx, ny, nz = order
    n = nx + ny + nz

    def combine(target: str, sign: float, *steps: tuple[int, int, int]) -> dict[Kernel, float]:
        return {(origin, target, _order(order, *step)): sign for step in steps}

    if name == "chi":
        if nz >= 2:
            return combine("phi", 1.0, (0, 0, -2))
        if nx >= 4 or (nx >= 3 and ny == 0):
            return combine("chi", -1.0, (-2, 2, 0)) | combine("phi", -1.0, (-2, 0, 0))
        if ny >= 3:
            return combine("chi", -1.0, (2, -2, 0)) | combine("phi", -1.0, (0, -2, 0))
        return None
    if name != "phi":
        return None
    if origin == "real" or n <= 2 or (n == 3 and nz >= 1):
        return combine("psi", 0.5, (2, 0, 0), (0, 2, 0), (0, 0, 2))
    if n == 3 and max(nx, ny) == 3:
        inplane = (-2, 2, 0) if nx == 3 else (2, -2, 0)
        deep = (-2, 0, 2) if nx == 3 else (0, -2, 2)
        return combine("phi", -1.0, inplane, deep)
    if nz >= 2:
        return combine("phi", -1.0, (2, 0, -2), (0, 2, -2))
    return None


def reduced_in_plane(kernel: Kernel) -> dict[Kernel, float] | None:
    """Rule after `reduced` for cells without end along y: derivatives along y vanish, and Psi is biharmonic in x and z.

    Stress then needs 10 kernels of the image in place of 43. Inside the source ``Psi,xxxx + 2 Psi,xxzz + Psi,zzzz`` is
    -8 pi.
    """
    origin, name, (nx, ny, nz) = kernel
    if ny:
        return {}
    if name == "psi" and nx >= 4:
        terms = {(origin, name, (nx - 2, 0, nz + 2)): -2.0, (origin, name, (nx - 4, 0, nz + 4)): -1.0}
        return terms | ({INSIDE: -8.0 * math.pi} if origin == "real" else {})
    if name == "phi" and nx >= 2:
        return {(origin, name, (nx - 2, 0, nz + 2)): -1.0}
    return None
