"""Checks of fatigue criteria: one finite number a point, without a preferred axis, start or point."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import SQRT2, HasKnownValues, HasUpperBound, StressCycle, mandel_rotation
from eigencontact_verification.conformance.report import check, ensure, ensure_pure

FloatArray = NDArray[np.float64]

_AMPLITUDE, _YOUNG, _POISSON = 1e8, 200e9, 0.3
#: Turned axes, and closed forms: the search for planes ends at finite angles, and quadrature over them has an error.
_TURNED, _CLOSED_FORM = 2e-3, 1e-3
#: Round-off of what is the same question.
_EXACT = 1e-9


def _cycle(stress: FloatArray) -> StressCycle:
    """Cycle with the elastic strain."""
    trace = stress[:, :3].sum(axis=1, keepdims=True)
    strain = (1.0 + _POISSON) / _YOUNG * stress
    strain[:, :3] -= _POISSON / _YOUNG * trace
    return StressCycle(stress=stress, strain=strain)


def _stress(steps: int, points: int, seed: int = 5) -> FloatArray:
    """Stress ``(steps, 6, points)`` [Pa] out of phase about a mean, another at each point."""
    mean, first, second, third = np.random.default_rng(seed).normal(size=(4, 6, points))
    phase = (2.0 * np.pi * np.arange(steps) / steps)[:, None, None]
    return np.asarray(
        _AMPLITUDE * (0.3 * mean + np.cos(phase) * first + np.sin(phase) * second + 0.5 * np.cos(2 * phase) * third)
    )


def _named() -> dict[str, FloatArray]:
    """Cycles of `HasKnownValues`, plain components ``(steps, 6)`` of amplitude 1."""
    phase = 2.0 * np.pi * np.arange(240) / 240
    corners = 2.0 * np.pi * np.arange(3) / 3
    wave = np.array([1.0, 0.0, -1.0, 0.0])

    def rows(xx: Any = 0.0, yz: Any = 0.0, xz: Any = 0.0, xy: Any = 0.0) -> FloatArray:
        return np.stack(np.broadcast_arrays(xx, 0.0, 0.0, yz, xz, xy), axis=-1)

    return {
        "tension": rows(xx=wave),
        "pulsating-tension": rows(xx=1.0 + wave),
        "torsion": rows(xy=wave),
        "tension-and-torsion": rows(xx=np.cos(phase), xy=np.sin(phase)),
        "three-shears": rows(yz=np.sin(corners), xz=np.cos(corners)),
    }


def _ensure_close(
    got: FloatArray, expected: FloatArray, tolerance: float, subject: str, rule: str, advice: str
) -> None:
    missed = np.abs(got - expected) / np.maximum(np.abs(expected).max(), 1e-300)
    worst = int(missed.argmax())
    ensure(
        missed[worst] <= tolerance, subject, f"{rule}, {expected[worst]:.8g} within {tolerance:g}", f"{got[worst]:.8g}",
        advice,
    )  # fmt: skip


def _values(criterion: Any, stress: FloatArray) -> FloatArray:
    return np.asarray(criterion.damage(_cycle(stress)).value)


@check
def check_damage(criterion: Any) -> None:
    """One finite number a point, whatever the number of steps and points; unit normals; a positive limit."""
    limit = criterion.limit
    ensure(np.isfinite(limit) and limit > 0, "limit", "positive and finite", limit, "refuse others in __post_init__")
    for steps, points in ((1, 1), (2, 3), (3, 1), (7, 5)):
        answer = criterion.damage(_cycle(_stress(steps, points)))
        value, case = np.asarray(answer.value), f"damage of {steps} steps at {points} points"
        ensure(
            value.shape == (points,) and value.dtype == np.float64 and np.all(np.isfinite(value)), case,
            f"finite float64 of shape {(points,)}", f"{value.dtype} of shape {value.shape}",
            "cycle.stress is (steps, 6, points)",
        )  # fmt: skip
        if answer.normal is not None:
            lengths = np.linalg.norm(np.asarray(answer.normal).reshape(points, 3), axis=1)
            ensure(
                np.allclose(lengths, 1.0, atol=1e-9), f"normal in {case}", f"unit vectors {(points, 3)}",
                f"lengths {lengths.min():.6g} to {lengths.max():.6g}", "divide by the norm",
            )  # fmt: skip


@check
def check_damage_pure(criterion: Any) -> None:
    """Same answer twice, another cycle asked in between; the cycle stays as it was, and may be read-only."""
    cycle, second = _cycle(_stress(6, 4)), _cycle(_stress(5, 3, seed=8))
    ensure_pure(
        "damage", lambda: criterion.damage(cycle).value, (cycle.stress, np.asarray(cycle.strain)),
        arguments="the arrays of the cycle", between=lambda: criterion.damage(second),
        advice="keep no memory of what was asked",
    )  # fmt: skip


@check
def check_points_apart(criterion: Any) -> None:
    """A point alone has the value that it has among others."""
    stress = _stress(8, 5)
    single = np.concatenate([_values(criterion, stress[..., k : k + 1]) for k in range(5)])
    _ensure_close(
        _values(criterion, stress), single, 1e-6, "damage of five points", "that of each alone",
        "vectorise over the last axis; no largest or mean over points",
    )  # fmt: skip


@check
def check_start_of_cycle(criterion: Any) -> None:
    """Where the cycle starts, and steps stored twice, do not matter."""
    stress = _stress(8, 4)
    value = _values(criterion, stress)
    for case, changed_stress in (
        ("from its fourth step", np.roll(stress, 3, axis=0)),
        ("twice", np.repeat(stress, 2, axis=0)),
    ):
        _ensure_close(
            _values(criterion, changed_stress), value, 1e-6, f"damage of a cycle {case}", "that of the cycle",
            "the cycle is closed: compare no step with the first alone",
        )  # fmt: skip


@check
def check_turned_axes(criterion: Any) -> None:
    """The value does not depend on the axes: a sweep over planes that misses the worst one does."""
    stress = _stress(8, 12)
    value = _values(criterion, stress)
    for seed in range(3):
        axes = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
        axes *= np.sign(np.linalg.det(axes))
        turned = np.einsum("ij,tjp->tip", mandel_rotation(axes), stress)
        _ensure_close(
            _values(criterion, turned), value, _TURNED, "damage in turned axes", "the same",
            "refine planes after a coarse sweep (worst_planes), and mind the sqrt 2 of Mandel shear",
        )  # fmt: skip


@check
def check_tension(criterion: Any) -> None:
    """A mean normal stress in tension does not make the value smaller than the same in compression."""
    stress = _stress(8, 6)
    mean = np.zeros((1, 6, 1))
    mean[:, :3] = 0.5 * _AMPLITUDE
    tension, compression = _values(criterion, stress + mean), _values(criterion, stress - mean)
    worst = int((tension - compression).argmin())
    ensure(
        tension[worst] >= compression[worst] * (1.0 - _CLOSED_FORM), "damage with a mean stress in tension",
        f"not below that in compression, {compression[worst]:.6g}", f"{tension[worst]:.6g}",
        "stress is positive in tension: look at the sign of the mean or normal stress",
    )  # fmt: skip


@check
def check_small_stress(criterion: Any) -> None:
    """No stress, no damage; and a hundredth of a cycle does not damage more than all of it."""
    stress = _stress(6, 4)
    zero, small, value = (_values(criterion, factor * stress) for factor in (0.0, 0.01, 1.0))
    ensure(np.all(np.abs(zero) <= _EXACT * np.abs(value)), "damage without stress", "0", f"{zero.max():.3g}", "see 0/0")
    ensure(
        np.all(small <= value), "damage of a hundredth of a cycle", f"below that of the cycle, {value.min():.3g}",
        f"{small.max():.3g}", "the damage parameter grows with stress",
    )  # fmt: skip


@check
def check_known_values(criterion: Any) -> None:
    """Values in closed form that the criterion gives of itself (`HasKnownValues`)."""
    if not isinstance(criterion, HasKnownValues):
        return
    cycles = _named()
    for name, expected in criterion.known_values(_AMPLITUDE, _YOUNG, _POISSON).items():
        ensure(name in cycles, "known_values", f"of cycles named {', '.join(cycles)}", name, "see HasKnownValues")
        plain = _AMPLITUDE * cycles[name][:, :, None]
        plain[:, 3:] *= SQRT2
        _ensure_close(
            _values(criterion, plain), np.array([expected]), _CLOSED_FORM, f"damage of {name}", "its closed form",
            "an amplitude is half of a range, and the radius of the smallest circle or ball, not half of a chord",
        )  # fmt: skip


@check
def check_upper_bound(criterion: Any) -> None:
    """The bound of `HasUpperBound` is nowhere below the damage parameter."""
    if not isinstance(criterion, HasUpperBound):
        return
    shapes = [*_named().values(), np.zeros((2, 6)), np.array([[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]])]
    plain = [(f"cycle {number} of closed forms", _AMPLITUDE * shape[:, :, None]) for number, shape in enumerate(shapes)]
    for case, stress in [*plain, *((f"{steps} random steps", _stress(steps, 40)) for steps in (1, 2, 3, 8, 24))]:
        for name, factor in (("tension", 1.0), ("compression", -1.0)):
            cycle = _cycle(factor * stress)
            bound, value = np.asarray(criterion.upper_bound(cycle)), _values(criterion, factor * stress)
            ensure(
                bound.shape == value.shape and np.all(np.isfinite(bound)), f"upper_bound of {case}",
                f"finite, of shape {value.shape}", f"shape {bound.shape}", "one number a point",
            )  # fmt: skip
            worst = int((bound - value).argmin())
            ensure(
                bound[worst] >= value[worst] - _EXACT * abs(value[worst]), f"upper_bound of {case} in {name}",
                f"at least the damage, {value[worst]:.9g}", f"{bound[worst]:.9g}",
                "a bound that is too small hides the hot spot of a fretting map",
            )  # fmt: skip
