"""Projection onto tractions within the bounds of friction that carry prescribed forces: found, or refused."""

import numpy as np
import pytest

from eigencontact.solvers.tangential.discs import Infeasible, RigidPlane, length_of

#: Share of what friction carries in a direction of the forces, and whether that is possible.
SHARES = [(-0.5, True), (0.3, True), (1 - 1e-6, True), (1 - 1e-12, True), (1.0, True), (1 + 1e-10, True),
          (1 + 1e-6, False), (1.5, False), (100.0, False)]  # fmt: skip


def cells(rng, components):
    """Bounds, modes, and the forces of gross slip along a random motion; fewer modes with one direction alone."""
    ny, nx = rng.integers(2, 9, 2)
    bound = rng.uniform(0, 1, (ny, nx)) * (rng.uniform(size=(ny, nx)) > 0.3)
    bound[0, 0] = 1.0
    x, y = np.meshgrid(np.linspace(-1, 1, nx), np.linspace(-1, 1, ny))
    modes = np.array([[np.ones_like(x), 0 * x], [0 * x, np.ones_like(x)], [-y, x]])
    if components == 1:
        modes = modes[:1, :1]
    motion = np.einsum("m,mkij->kij", rng.normal(size=len(modes)), modes)
    slipping = bound * motion / np.maximum(length_of(motion), 1e-300)
    return bound, modes, np.einsum("mkij,kij->m", modes, slipping)


@pytest.mark.parametrize("components", [1, 2])
@pytest.mark.parametrize("size", [0.3, 100.0])
@pytest.mark.parametrize(("share", "possible"), SHARES)
def test_forces_are_carried_within_the_bounds_or_refused(share, possible, size, components):
    rng = np.random.default_rng(5)
    for _ in range(5):
        bound, modes, forces = cells(rng, components)
        plane, start = RigidPlane(modes, share * forces), size * rng.normal(size=(components, *bound.shape))
        if not possible:
            with pytest.raises(Infeasible):
                plane.closest(start, bound)
            continue
        found = plane.closest(start, bound)
        assert np.all(length_of(found) <= bound * (1 + 1e-14))
        assert np.max(np.abs(plane.work(found) - share * forces)) <= 1e-9 * bound.sum()


def test_the_projection_is_the_closest():
    """Nothing that is allowed and carries the forces lies nearer: the angle to every other such field is obtuse."""
    rng = np.random.default_rng(6)
    bound, modes, forces = cells(rng, 2)
    plane, start = RigidPlane(modes, 0.4 * forces), rng.normal(size=(2, *bound.shape))
    found = plane.closest(start, bound)
    for _ in range(20):
        other = plane.closest(rng.normal(size=start.shape), bound)
        assert np.sum((start - found) * (other - found)) <= 1e-9
