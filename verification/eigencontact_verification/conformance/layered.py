"""Checks of layered media: the elastic field of a load on its surface, wave by wave, at any depth.

The checks know nothing of how the constants depend on depth: they ask the medium for them, and hold its answer against
the load, equilibrium, Hooke's law, continuity, reciprocity and the half-spaces that short and long waves see.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import COMPONENTS, SQRT2, HasResponseAtDepths, Material
from eigencontact_verification.conformance.report import check, ensure, ensure_array, ensure_pure
from eigencontact_verification.conformance.sampling import remembered

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_TRACTIONS = ("p", "q_x", "q_y")
_AXES = ("x", "y", "z")
_ROW = {name: row for row, name in enumerate(COMPONENTS)}
#: Directions of the waves [rad]: along both axes, and across all quarters.
_ANGLES = np.array([0.0, 0.5 * np.pi, 0.4, 2.3, 3.9, 5.5])


@check
def check_materials(medium: Any) -> None:
    """The materials at the surface, far below and at any depth are there, and interfaces ascend."""
    depths = np.asarray(medium.interfaces, dtype=float)
    ensure(
        depths.ndim == 1 and np.all(np.diff(depths, prepend=0.0) > 0) and np.all(np.isfinite(depths)),
        "interfaces", "positive, finite and ascending", tuple(depths), "give depths [m], not thicknesses",
    )  # fmt: skip
    for subject, depth, side, expected in (
        ("material_at(0)", 0.0, "below", medium.surface_material),
        ("material_at far below", 1e12 * _sizes(medium)[1], "below", medium.deep_material),
    ):
        material = medium.material_at(depth, side=side)
        ensure(
            isinstance(material, Material), subject, "a Material", repr(material), "return eigencontact.plugin.Material"
        )
        ensure(
            np.allclose(_constants(material), _constants(expected), rtol=1e-6, atol=1e-9), subject, repr(expected),
            repr(material), "compare with surface_material and deep_material",
        )  # fmt: skip
    for depth in depths:
        for side, inside in (("above", depth * (1 - 1e-6)), ("below", depth * (1 + 1e-6))):
            material, near = medium.material_at(float(depth), side=side), medium.material_at(float(inside))
            ensure(
                np.allclose(_constants(material), _constants(near), rtol=1e-4, atol=1e-6),
                f"material_at({depth:.6g}, side={side!r})", f"that of the depth {inside:.9g}, {near!r}", repr(material),
                "'above' is nearer to the surface, 'below' is deeper",
            )  # fmt: skip


@check
def check_response_arrays(medium: Any) -> None:
    """Complex numbers of the shape of the waves; at k = 0 the stress of a uniform traction and no displacement."""
    k = 1.0 / _sizes(medium)[1]
    row, column = np.array([[0.0, k, -k, 3 * k]]), np.array([[0.0], [2 * k], [-k]])
    for kx, ky in ((row, column), (np.array(k), np.array(0.0)), (np.zeros((2, 3)), np.full((2, 3), k)), (row[0], row)):
        shape = np.broadcast_shapes(kx.shape, ky.shape)
        for quantity, components in (("displacement", ("z",)), ("displacement", _AXES), ("stress", ("xz", "zz", "yy"))):
            for traction in _TRACTIONS:
                got = np.asarray(medium.response(quantity, components, traction, kx, ky, 0.3 / k))
                ensure_array(
                    got, (len(components), *shape), f"response of {quantity} to {traction}",
                    "kx and ky broadcast against each other", rule="complex128 of shape {shape}", dtype=np.complex128,
                )  # fmt: skip
                ensure(np.all(np.isfinite(got)), f"response of {quantity} to {traction}", "finite", "not", "see k = 0")
    zero = np.zeros(1)
    for traction, name in (("p", "zz"), ("q_x", "xz"), ("q_y", "yz")):
        u = medium.response("displacement", _AXES, traction, zero, zero, 0.3 / k)
        uniform = np.zeros((6, 1))
        uniform[_ROW[name]] = -1.0 if name == "zz" else -SQRT2
        stress = medium.response("stress", COMPONENTS, traction, zero, zero, 0.3 / k)
        ensure(
            np.array_equal(u, np.zeros((3, 1))), f"displacement at kx = ky = 0 under {traction}", "zero", u.ravel(),
            "the mean displacement of a periodic half-space has no bound: it is defined as zero",
        )  # fmt: skip
        ensure(
            np.allclose(stress, uniform, atol=1e-12), f"stress at kx = ky = 0 under {traction}",
            f"that of a uniform traction, {name} alone, in Mandel scaling", stress.ravel(),
            "return what balances the load, and zero in the other components",
        )  # fmt: skip


@check
def check_response_pure(medium: Any) -> None:
    """Same answer twice, another question in between; kx and ky stay as they were, and may be read-only."""
    k = 1.0 / _sizes(medium)[1]
    kx, ky = k * np.cos(_ANGLES), k * np.sin(_ANGLES)
    ensure_pure(
        "response", lambda: medium.response("stress", COMPONENTS, "q_x", kx, ky, 0.3 / k), (kx, ky),
        between=lambda: medium.response("displacement", _AXES, "p", 2 * kx, ky, 0.0),
        advice="keep no memory of what was asked",
    )  # fmt: skip


@check
def check_response_at_depths(medium: Any) -> None:
    """Where many depths can be asked for at once, the answer is that of one after the other, on either side."""
    at_depths: Any = medium if isinstance(medium, HasResponseAtDepths) else None
    if at_depths is None:
        return
    small, large = _sizes(medium)
    depths = np.array([2.0 * large, 0.0, 0.3 * small, *medium.interfaces[:2], 0.5 * large, 0.3 * small])
    k = np.array([[0.0], [0.1 / large], [1.0 / small]])
    kx, ky = k * np.cos(_ANGLES), k * np.sin(_ANGLES)
    for traction, quantity, side in product(_TRACTIONS, ("displacement", "stress"), ("above", "below")):
        names = _AXES if quantity == "displacement" else COMPONENTS
        response = np.asarray(at_depths.response_at_depths(quantity, names, traction, kx, ky, depths, side=side))
        expected = np.stack(
            [medium.response(quantity, names, traction, kx, ky, float(z), side=side) for z in depths], axis=1
        )
        subject = f"{quantity} at {depths.size} depths under {traction}, {side} interfaces"
        ensure(
            response.shape == expected.shape, f"shape of {subject}", str(expected.shape), response.shape,
            "return (components, depths, ...)",
        )  # fmt: skip
        scale = np.abs(expected).max(axis=(0, 1))
        scale[scale == 0.0] = 1.0
        _near(subject, response / scale, expected / scale, 1e-10, "the depths come in any order, some twice")


@check
def check_load_on_surface(medium: Any) -> None:
    """At z = 0 the stress balances the load: p pushes along +z, q_x and q_y act along +x and +y on the body."""
    kx, ky = _waves(medium)
    for traction, name in (("p", "zz"), ("q_x", "xz"), ("q_y", "yz")):
        stress = medium.response("stress", ("zz", "xz", "yz"), traction, kx, ky, 0.0)
        for row, component in zip(stress, ("zz", "xz", "yz"), strict=True):
            expected = -(1.0 if component == "zz" else SQRT2) * (component == name)
            _near(f"{component} at z = 0 under {traction}", row, expected, 1e-8, "compare signs and Mandel scaling")


@check
def check_balance_below_the_surface(medium: Any) -> None:
    """Equilibrium: the divergence of the stress is zero at every depth, by finite differences."""
    for k, z, step in _places(medium):
        kx, ky = k * np.cos(_ANGLES), k * np.sin(_ANGLES)
        for traction in _TRACTIONS:
            s, ds = _along_z(medium, "stress", COMPONENTS, traction, (kx, ky), z, step)
            s[3:], ds[3:] = s[3:] / SQRT2, ds[3:] / SQRT2
            scale = k * np.abs(s).max(axis=0)
            for x, y, dz, direction in (("xx", "xy", "xz", "x"), ("xy", "yy", "yz", "y"), ("xz", "yz", "zz", "z")):
                force = 1j * (kx * s[_ROW[x]] + ky * s[_ROW[y]]) + ds[_ROW[dz]]
                _near(
                    f"force along {direction} at z = {z:.4g}, k = {k:.4g} under {traction}", force / scale, 0.0, 1e-6,
                    "the stress of this depth does not balance",
                )  # fmt: skip


@check
def check_hooke(medium: Any) -> None:
    """The strain of the displacement is that of the stress with the material of that depth."""
    for k, z, step in _places(medium):
        kx, ky = k * np.cos(_ANGLES), k * np.sin(_ANGLES)
        for traction in _TRACTIONS:
            u, du = _along_z(medium, "displacement", _AXES, traction, (kx, ky), z, step)
            stress = medium.response("stress", COMPONENTS, traction, kx, ky, z)
            strain = np.array(
                [1j * kx * u[0], 1j * ky * u[1], du[2], (du[1] + 1j * ky * u[2]) / SQRT2,
                 (du[0] + 1j * kx * u[2]) / SQRT2, 1j * (ky * u[0] + kx * u[1]) / SQRT2]
            )  # fmt: skip
            expected = _strain(stress, medium.material_at(z))
            scale = np.abs(expected).max(axis=0) + k * np.abs(u).max(axis=0)
            for name, got, law in zip(COMPONENTS, strain, expected, strict=True):
                _near(
                    f"strain {name} at z = {z:.4g}, k = {k:.4g} under {traction}", (got - law) / scale, 0.0, 1e-6,
                    "displacement, stress and material_at do not belong together",
                )  # fmt: skip


@check
def check_interfaces(medium: Any) -> None:
    """Layers are bonded: displacement and traction continuous, in-plane stress that of each side's material."""
    depths = [float(z) for z in medium.interfaces]
    for z in dict.fromkeys([*depths[:3], *depths[-3:]]):
        k = 1.0 / z
        kx, ky = k * np.cos(_ANGLES), k * np.sin(_ANGLES)
        for traction in _TRACTIONS:
            for quantity, components in (("displacement", _AXES), ("stress", ("zz", "yz", "xz"))):
                above, below = (
                    medium.response(quantity, components, traction, kx, ky, z, side=side) for side in ("above", "below")
                )
                scale = np.abs(above).max()
                _near(
                    f"{quantity} across z = {z:.6g} under {traction}", above / scale, below / scale, 1e-8,
                    "bonded layers move together and hand their traction on",
                )  # fmt: skip
            for side, shift in (("above", -1e-9), ("below", 1e-9)):
                at_interface = medium.response("stress", COMPONENTS, traction, kx, ky, z, side=side)
                near = medium.response("stress", COMPONENTS, traction, kx, ky, z * (1 + shift))
                scale = np.abs(near).max()
                _near(
                    f"stress {side} z = {z:.6g} under {traction}", at_interface / scale, near / scale, 1e-6,
                    "'above' is the material nearer to the surface, 'below' the deeper one",
                )  # fmt: skip


@check
def check_short_waves(medium: Any) -> None:
    """Waves much shorter than anything in the medium see the half-space of surface_material."""
    _against_half_space(medium, 1e5 / _sizes(medium)[0], medium.surface_material, "surface_material", 1e-4)


@check
def check_long_waves(medium: Any) -> None:
    """Waves much longer than anything in the medium see the half-space of deep_material."""
    _against_half_space(medium, 1e-14 / _sizes(medium)[1], medium.deep_material, "deep_material", 1e-4)


@check
def check_reciprocity(medium: Any) -> None:
    """Displacement i by traction j is that of j by i (Betti), a load does work, a real load has a real field."""
    kx, ky = _waves(medium)
    k = np.hypot(kx, ky)
    U = k * np.array([medium.response("displacement", _AXES, name, kx, ky, 0.0) for name in ("q_x", "q_y", "p")])
    size = np.abs(U).max(axis=(0, 1))
    _near("displacement i by j", U / size, np.conj(np.swapaxes(U, 0, 1)) / size, 1e-8, "compare the cross terms' signs")
    lowest = np.linalg.eigvalsh(np.moveaxis(0.5 * (U + np.conj(np.swapaxes(U, 0, 1))), -1, 0))[:, 0]
    ensure(
        np.all(lowest > 0), "work of a load on its own displacement", "positive",
        f"{lowest.min():.3g} times k/2 per unit traction", "p pushes along +z, into the body, and so does u_z",
    )  # fmt: skip
    mirrored = k * np.array(
        [medium.response("displacement", _AXES, name, -kx, -ky, 0.0) for name in ("q_x", "q_y", "p")]
    )
    _near("response at -k", mirrored / size, np.conj(U) / size, 1e-8, "it is the conjugate of that at k")


@check
def check_directions(medium: Any) -> None:
    """No direction along the surface is special: a turned wave with a turned load gives the turned displacement."""
    small, large = _sizes(medium)
    for k in (0.7 / large, 1.0 / small):
        for z in (0.0, 0.5 / k):
            kx, ky = k * np.cos(_ANGLES), k * np.sin(_ANGLES)
            U = np.array([medium.response("displacement", _AXES, name, kx, ky, z) for name in ("q_x", "q_y", "p")])
            turn = np.zeros((_ANGLES.size, 3, 3))
            turn[:, 0, 0], turn[:, 0, 1] = np.cos(_ANGLES), -np.sin(_ANGLES)
            turn[:, 1, 0], turn[:, 1, 1] = np.sin(_ANGLES), np.cos(_ANGLES)
            turn[:, 2, 2] = 1.0
            along_x = np.einsum("nia,ijn,njb->abn", turn, U, turn)
            size = np.abs(along_x).max()
            _near(
                f"displacement at z = {z:.4g} in axes along the wave, k = {k:.4g}", along_x / size,
                along_x[..., :1] / size, 1e-8, "turn the load and the answer by the same angle",
            )  # fmt: skip


@check
def check_decay(medium: Any) -> None:
    """A wave dies out below about its own length, however stiff the layers are."""
    small, large = _sizes(medium)
    for k in (0.1 / large, 1.0 / large, 1.0 / small):
        kx, ky = k * np.cos(_ANGLES), k * np.sin(_ANGLES)
        for traction in _TRACTIONS:
            stress = np.abs(medium.response("stress", COMPONENTS, traction, kx, ky, 45.0 / k)).max()
            ensure(
                stress < 1e-6, f"stress at z = 45/k, k = {k:.4g}, under {traction}", "below 1e-6 of the load",
                f"{stress:.2e}", "a growing exponential is left in the field",
            )  # fmt: skip


@check
def check_extreme_waves(medium: Any) -> None:
    """Finite, without a warning, from waves of 1e9 times the size of the medium to 1e-9 of it, at any depth."""
    small, large = _sizes(medium)
    k = np.array([1e-9 / large, 1e-3 / large, 1.0 / large, 1.0 / small, 1e3 / small, 1e9 / small])
    for z in (0.0, 1e-9 * small, *medium.interfaces[:2], 1e9 * large):
        for traction in _TRACTIONS:
            for quantity, components in (("displacement", _AXES), ("stress", COMPONENTS)):
                got = medium.response(quantity, components, traction, 0.6 * k, -0.8 * k, float(z))
                ensure(
                    np.all(np.isfinite(got)), f"{quantity} at z = {z:.3g} under {traction}", "finite",
                    f"{got[:, ~np.isfinite(got).all(axis=0)][:, :1].ravel()} at k = "
                    f"{k[~np.isfinite(got).all(axis=0)][:1]}", "let no exponential of k times a depth grow",
                )  # fmt: skip


def _against_half_space(medium: Any, k: float, material: Material, name: str, tolerance: float) -> None:
    """Surface displacement against that of a half-space: u = A q / (2 G k) with the matrix of the wave's direction."""
    G, nu = material.shear_modulus, material.poisson_ratio
    m, n = np.cos(_ANGLES), np.sin(_ANGLES)
    flat = np.zeros_like(m)
    expected = {
        "p": (1j * (1 - 2 * nu) * m, 1j * (1 - 2 * nu) * n, 2 * (1 - nu) + flat),
        "q_x": (2 * (1 - nu) * m * m + 2 * n * n, -2 * nu * m * n, -1j * (1 - 2 * nu) * m),
        "q_y": (-2 * nu * m * n, 2 * (1 - nu) * n * n + 2 * m * m, -1j * (1 - 2 * nu) * n),
    }
    for traction in _TRACTIONS:
        scaled = 2 * G * k * medium.response("displacement", _AXES, traction, k * m, k * n, 0.0)
        for row, axis in enumerate(_AXES):
            _near(
                f"2 G k u_{axis} at k = {k:.3g} under {traction}", scaled[row], expected[traction][row], tolerance,
                f"G and ν are those of {name}: the limits of response and the property must agree",
            )  # fmt: skip


def _near(subject: str, got: ComplexArray, expected: ComplexArray | float, tolerance: float, advice: str) -> None:
    error = np.abs(got - expected)
    error = np.where(np.isnan(error), np.inf, error)
    worst = int(np.argmax(error))
    expected_value = np.broadcast_to(np.asarray(expected), error.shape).flat[worst]
    ensure(
        error.flat[worst] <= tolerance, subject, f"{complex(expected_value):.8g}",
        f"{complex(np.asarray(got).flat[worst]):.8g}, allowed error {tolerance:.0e}", advice,
    )  # fmt: skip


def _constants(material: Material) -> tuple[float, float]:
    return material.young_modulus / 1e9, material.poisson_ratio


def _strain(stress: ComplexArray, material: Material) -> ComplexArray:
    """Hooke's law, Mandel; an incompressible material has a strain too."""
    E, nu = material.young_modulus, material.poisson_ratio
    strain = (1 + nu) / E * stress
    strain[:3] -= nu / E * stress[:3].sum(axis=0)
    return strain


@remembered
def _sizes(medium: Any) -> tuple[float, float]:
    """Smallest and largest length in the medium [m].

    Without interfaces both are 1/k of the wave whose displacement is half-way between those of short and long waves.
    """
    depths = np.asarray(medium.interfaces, dtype=float)
    if depths.size:
        return float(np.diff(depths, prepend=0.0).min()), float(depths[-1])

    def compliance(k: float) -> float:
        answer = medium.response("displacement", ("z",), "p", np.array([k]), np.zeros(1), 0.0)
        return float(k * np.asarray(answer).real.ravel()[0])

    low, high = -12.0, 12.0
    ends = compliance(10**low), compliance(10**high)
    if abs(ends[0] - ends[1]) < 1e-6 * abs(ends[0]):
        return 1.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        nearer_low = abs(compliance(10**middle) - ends[0]) < abs(compliance(10**middle) - ends[1])
        low, high = (middle, high) if nearer_low else (low, middle)
    return 10**-low, 10**-low


def _waves(medium: Any) -> tuple[FloatArray, FloatArray]:
    """Waves of lengths from far above the largest length to far below the smallest, in several directions."""
    small, large = _sizes(medium)
    k = np.concatenate([np.array([1e-6, 1e-2, 0.3, 1.0, 4.0]) / large, np.array([0.5, 2.0, 10.0, 1e4]) / small])
    return np.outer(k, np.cos(_ANGLES)).ravel(), np.outer(k, np.sin(_ANGLES)).ravel()


def _places(medium: Any) -> Iterator[tuple[float, float, float]]:
    """Wavenumbers, depths well inside the layers and below them, and steps that stay there."""
    small, large = _sizes(medium)
    bounds = [0.0, *(float(depth) for depth in medium.interfaces)]
    intervals = list(pairwise(bounds))
    intervals = intervals if len(intervals) <= 4 else [*intervals[:2], intervals[len(intervals) // 2], intervals[-1]]
    for top, bottom in intervals:
        for k in (0.3 / large, 1.0 / bottom, 2.0 / (bottom - top)):
            if k * top < 12.0:
                yield k, top + 0.37 * (bottom - top), 0.003 * min(1 / k, bottom - top)
    for k in (0.1 / large, 1.0 / large):
        yield k, bounds[-1] + 0.8 / k, 0.003 * min(1.0 / k, small if not medium.interfaces else 1.0 / k)


def _along_z(
    medium: Any, quantity: str, components: tuple[str, ...], traction: str, waves: tuple[FloatArray, FloatArray],
    z: float, step: float,
) -> tuple[ComplexArray, ComplexArray]:  # fmt: skip
    """Field at a depth and its derivative there, by differences of fourth order."""

    def at(depth: float) -> ComplexArray:
        return np.array(medium.response(quantity, components, traction, *waves, depth))

    near, far = (at(z + n * step) - at(z - n * step) for n in (1, 2))
    return at(z), (8 * near - far) / (12 * step)
