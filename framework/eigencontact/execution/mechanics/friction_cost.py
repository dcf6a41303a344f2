"""Predicted memory and time of a contact with friction."""

from __future__ import annotations

from collections.abc import Sequence

from eigencontact.convolution.layout import fast_even
from eigencontact.convolution.pace import speed
from eigencontact.core.rigid_modes import NORMAL_MODES
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.sampling import tables_of_images
from eigencontact.execution.mechanics.normal_contact import normal_cost
from eigencontact.model.coupling import Coupling
from eigencontact.scene.holding import TRAVEL
from eigencontact.scene.schema import Numerics, Step

__all__ = ["friction_cost", "pressed_share"]

#: Typical applications of the tangential kernels per solve, and typical rounds of normal and tangential solves. The
#: bundled scenes take 18 to 25 applications per increment if the pressure does not depend on the shear, otherwise 10 to
#: 28 per round and 3 to 5 rounds.
_APPLICATIONS, _ROUNDS = 20, 4
#: Prescribed values that can change the pressure if it does not depend on the shear.
_NORMAL = (*(name for pair in NORMAL_MODES for name in pair), *TRAVEL)


def pressed_share(ramps: Sequence[Step]) -> float:
    """Fraction of the increments that change the pressure."""
    if any(ramp.slides for ramp in ramps):
        return 1.0
    counts, changed, before = 0, 0, None
    for ramp in ramps:
        prescribed = [getattr(ramp, name) for name in _NORMAL]
        counts += ramp.increments
        changed += ramp.increments * (prescribed != before)
        before = prescribed
    return changed / max(1, counts)


def friction_cost(
    shape: tuple[int, int], box: tuple[int, int], coupling: Coupling, numerics: Numerics, pressed: float = 1.0
) -> Cost:
    """Predicted cost of normal and tangential contact, from the pairs of displacement and traction with a kernel.

    The counts are typical of smooth contacts: `_APPLICATIONS` of the tangential kernels and half as many of their
    approximate inverse per round, and `_ROUNDS` rounds if the pressure depends on the shear. `pressed` is the fraction
    of the steps that change the pressure if it does not.
    """
    pace, periodic, pairs = speed(numerics.precision, numerics.threads), numerics.boundary == "periodic", coupling.pairs
    normal = normal_cost(shape, box, numerics)
    (ny, nx), (by, bx) = shape, (shape if periodic else box)
    fy, fx = (by, bx) if periodic else (fast_even(2 * by), fast_even(2 * bx))
    count, cross = len(coupling.components), sum((i == "z") != (j == "z") for i, j in pairs)
    coupled = any(i == "z" and j != "z" for i, j in pairs)
    rounds = _ROUNDS if coupled else 1
    iteration_seconds = count * (pace.convolution(fy, fx) + 0.5 * pace.convolution(fast_even(by), fast_even(bx)))
    iteration_seconds += 1.4e-8 * count * by * bx + 1.5e-4  # the vectors of the iteration, cell by cell
    whole = pace.convolution(fast_even(ny + by), fast_even(nx + bx))
    # Coefficients of the cross terms cost more than those of the pressure.
    once = len(pairs) * tables_of_images(numerics) * 3e-7 * (ny + by) * (nx + bx) / 4
    solve = (
        rounds * (_APPLICATIONS * iteration_seconds + (count + cross) * whole) + (rounds - 1) * normal.seconds_per_step
    )
    real = 8 if numerics.precision == "double" else 4
    padded = real * (ny + by) * (nx + bx)
    boxes = 3 if coupled else 1  # the contact changes from round to round, and each box has spectra of its own
    memory = 8.0 * ny * nx * (8 + 10 * count) + real * by * bx * 24 * count
    memory += padded * (boxes * len(pairs) + 2 * count) + 2.0 * len(pairs) * (ny + by) * (nx + bx)
    solve += (1.0 if coupled else pressed) * normal.seconds_per_step
    return Cost(memory=normal.memory + memory, seconds_once=once, seconds_per_step=solve)
