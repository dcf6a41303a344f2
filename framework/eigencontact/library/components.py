"""Plugins by themselves: the registry, components by key, and the exact field of a loaded rectangle at points."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.arrays import real_array
from eigencontact.core.units import LARGEST, SMALLEST
from eigencontact.errors import EigencontactError, PluginError, SceneError, require
from eigencontact.hooks.registry import Entry, Registry
from eigencontact.plugin import KINDS
from eigencontact.scene.installed import installed_plugins

__all__ = ["field_points", "make", "rectangle_field"]

FloatArray = NDArray[np.float64]


def make(key: str, /, *, kind: str | None = None, **parameters: Any) -> Any:
    """Component of an installed plugin by its key.

    Parameters
    ----------
    key : str
        Name of the plugin: ``"sphere"``, or ``"package:sphere"`` where packages share a key.
    kind : str, optional
        Kind of plugin, if several kinds have the key and accept the parameters.
    **parameters
        Fields of the component; text with units is accepted.

    Raises
    ------
    PluginError, SceneError
        Unknown or ambiguous key, refused parameters.

    Examples
    --------
    >>> make("sphere", radius="105 um").kind
    'geometry'
    >>> make("sphere", radius="2 um", center=(0, 0, "5 um")).kind
    'inclusion-shape'
    """
    from eigencontact.scene.components import instantiate

    registry = installed_plugins()
    require(isinstance(key, str), "make", "key", key, "the name of a plugin")
    if kind is not None:
        require(isinstance(kind, str) and kind in KINDS, "make", "kind", kind, f"one of {', '.join(KINDS)}")
        return instantiate(registry, registry.get(kind, key), parameters, key)
    kinds = dict.fromkeys(entry.kind for entry in registry.named(key))
    entries = [registry.get(kind, key) for kind in kinds]
    if len(entries) > 1:
        fitting = [entry for entry in entries if set(parameters) <= set(registry.parameters(entry.component))]
        entries = fitting or entries
    if len(entries) > 1:
        return _only_fitting(registry, key, entries, parameters)
    if not entries:
        raise PluginError(registry.unknown(key))
    return instantiate(registry, entries[0], parameters, key)


def _only_fitting(registry: Registry, key: str, entries: list[Entry], parameters: dict[str, Any]) -> Any:
    """Component of the only kind that accepts the parameters; a sphere's centre has two or three coordinates."""
    from eigencontact.scene.components import converted, instantiate

    components, refusals, of_right_form = {}, {}, []
    for entry in entries:
        try:
            converted(registry, entry, parameters, key)
            of_right_form.append(entry)
            components[entry.kind] = instantiate(registry, entry, parameters, key)
        except EigencontactError as problem:
            refusals[entry.kind] = str(problem)
    if len(components) == 1:
        return next(iter(components.values()))
    if components:
        raise PluginError(
            f"{key!r} must be told apart by kind (it may be {', '.join(map(repr, components))}); give kind="
        )
    if len(of_right_form) == 1:  # its own rules refuse the values, and say so best
        return instantiate(registry, of_right_form[0], parameters, key)
    reasons = "; ".join(f"as {kind}: {reason}" for kind, reason in refusals.items())
    raise SceneError(f"{key} must be given parameters that one kind accepts ({reasons})")


def field_points(points: ArrayLike, where: str, *, half_space: bool) -> FloatArray:
    """Field points ``(n, 3)`` [m] of a caller; refuses infinite values and, in a half-space, z < 0."""
    at = real_array(points, where, "points", "of shape (n, 3) [m]", "m")
    require(at.ndim == 2 and at.shape[1] == 3, where, "points", at.shape, "of shape (n, 3) [m]")
    if not np.all(np.isfinite(at)):
        raise SceneError(f"{where}.points must be finite [m] (got NaN or infinity)")
    farthest = float(np.abs(at).max(initial=0.0))
    require(farthest <= LARGEST, where, "points", farthest, f"within {LARGEST:g} m of the origin")
    if half_space:
        require(np.all(at[:, 2] >= 0), where, "points", at[:, 2].min(initial=0.0), "at z of 0 or more [m]")
    return at


def rectangle_field(
    traction: ArrayLike,
    half_widths: ArrayLike,
    points: ArrayLike,
    *,
    young_modulus: float,
    poisson_ratio: float,
    quantity: Literal["displacement", "stress"] = "displacement",
) -> FloatArray:
    """Field in a half-space loaded uniformly on the rectangle |x| <= a, |y| <= b of its surface z = 0.

    Parameters
    ----------
    traction : (3,) [Pa]
        ``(q_x, q_y, p)``: shears act on the body along +x and +y, the pressure pushes along +z, into the body.
    half_widths : (2,) [m]
        ``(a, b)``.
    points : (n, 3) [m]
        Field points, z >= 0.
    young_modulus, poisson_ratio : float
        E [Pa] and ν in (-1, 0.5].
    quantity : {"displacement", "stress"}
        What to return.

    Returns
    -------
    (n, 3) [m] or (n, 3, 3) [Pa]
        Displacement, or symmetric stress tensors (tension positive). On an edge, stresses that jump take their
        mean; true singularities (logarithms at edges and corners, z = 0) come out large and finite.

    References
    ----------
    Boussinesq 1885, Cerruti 1882, Love 1929; K. L. Johnson, Contact Mechanics (1985), chapter 3.

    Examples
    --------
    >>> u = rectangle_field((0, 0, 1e6), (1e-6, 1e-6), [[0, 0, 0]], young_modulus=210e9, poisson_ratio=0.3)
    >>> f"{u[0, 2]:.6e}"
    '9.725731e-12'
    """
    from eigencontact.core.material import Material
    from eigencontact.core.tensors import to_matrix
    from eigencontact.model.installed import installed_influence

    caller = "rectangle_field"
    rule = "three finite numbers (q_x, q_y, p) [Pa]"
    load = real_array(traction, caller, "traction", rule, "Pa")
    require(load.shape == (3,) and np.all(np.abs(load) <= LARGEST), caller, "traction", traction, rule)
    rule = "two positive numbers (a, b) [m]"
    widths = real_array(half_widths, caller, "half_widths", rule, "m")
    good = widths.shape == (2,) and np.all(widths >= SMALLEST) and np.all(widths <= LARGEST)
    require(good, caller, "half_widths", half_widths, rule)
    at = field_points(points, caller, half_space=True)
    supported = isinstance(quantity, str) and quantity in ("displacement", "stress")
    require(supported, caller, "quantity", quantity, "'displacement' or 'stress'")
    material = Material(young_modulus=young_modulus, poisson_ratio=poisson_ratio)
    names = ("x", "y", "z") if quantity == "displacement" else ("xx", "yy", "zz", "yz", "xz", "xy")
    total, registry = np.zeros((len(names), len(at))), installed_plugins()
    for value, component in zip(load, ("q_x", "q_y", "p"), strict=True):
        if value:
            influence = installed_influence(registry, component)
            evaluate = influence.displacement if quantity == "displacement" else influence.stress
            total += value * evaluate(
                names, at[:, 0], at[:, 1], at[:, 2], (float(widths[0]), float(widths[1])), material
            )
    return total.T if quantity == "displacement" else to_matrix(total)
