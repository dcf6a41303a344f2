"""Lines along which a case is compared: on the surface, and through and beside the source inside the body.

Displacement is compared on the surface, stress inside. Points keep off the boundary of the source, where stress jumps
or, at edges, is infinite. Components that a plane of symmetry makes zero are left out: they would agree for nothing.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Case, Curve, Fields, Profile, Quantity

__all__ = [
    "DIRECTIONS",
    "STRESSES",
    "VECTORS",
    "Contains",
    "FieldCase",
    "chosen",
    "clear_of",
    "columns",
    "growth_to",
    "in_units",
    "inner_lines",
    "planes_of",
    "read_section",
    "read_solid",
    "surface_lines",
]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Contains = Callable[[FloatArray, FloatArray, FloatArray], BoolArray]

VECTORS = ("u_x", "u_y", "u_z")
STRESSES = ("s_xx", "s_yy", "s_zz", "s_yz", "s_xz", "s_xy")
_AXES = "xyz"
DIRECTIONS = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if i or j or k], float)
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)


def planes_of(sources: Iterable[str]) -> tuple[str, str]:
    """Kind of the planes x = 0 and y = 0 for a source that is its own mirror image in both.

    Parameters
    ----------
    sources : iterable of str
        Components that act: ``"xz"`` of an eigenstrain, ``"x"`` of a traction.

    Returns
    -------
    (str, str)
        ``"even"`` where the mirrored source is the source, ``"odd"`` where it is its negative, ``"none"`` where
        several components do not agree: a mirror in x changes the sign of every component with one index x.

    Examples
    --------
    >>> planes_of(["xx", "zz"]), planes_of(["xy"]), planes_of(["xz"]), planes_of(["yz"]), planes_of(["x"])
    (('even', 'even'), ('odd', 'odd'), ('odd', 'even'), ('even', 'odd'), ('odd', 'even'))
    """
    chosen = list(sources)
    kinds = []
    for axis in "xy":
        signs = {component.count(axis) % 2 for component in chosen}
        kinds.append("none" if len(signs) != 1 else "odd" if signs == {1} else "even")
    return kinds[0], kinds[1]


def _present(names: Sequence[str], plane: str, axis: str) -> tuple[str, ...]:
    """Components that a plane normal to `axis` leaves on itself."""
    if plane == "none":
        return tuple(names)
    return tuple(name for name in names if name.count(axis) % 2 == (plane == "odd"))


def surface_lines(
    reach: float,
    planes: tuple[str, str],
    *,
    count: int = 25,
    paths: Sequence[str] = ("x", "y", "diagonal"),
    source: Contains | None = None,
    margin: float = 0.0,
    both_sides: bool = False,
) -> tuple[Profile, ...]:
    """Displacement of the surface along x, y and the diagonal.

    Parameters
    ----------
    reach : float
        Longest distance from the origin.
    planes : (str, str)
        Kind of the planes x = 0 and y = 0.
    count : int
        Points of each line.
    paths : sequence of str
        Which lines.
    source, margin : callable, float
        A source that touches the surface, and how far points keep off its boundary there.
    both_sides : bool
        From -reach to reach instead of from 0.
    """
    profiles = []
    for path in paths:
        across, along = {"x": (1.0, 0.0), "y": (0.0, 1.0), "diagonal": (0.5**0.5, 0.5**0.5)}[path]
        distance = np.linspace(-reach if both_sides else 0.0, reach, count)
        points = np.stack([across * distance, along * distance, np.zeros(count)], axis=1)
        if source is not None:
            clear = clear_of(source, points, margin)
            points, distance = points[clear], distance[clear]
        present: tuple[str, ...] = VECTORS
        if path == "x":
            present = _present(VECTORS, planes[1], "y")
        elif path == "y":
            present = _present(VECTORS, planes[0], "x")
        profiles.append(
            Profile(
                name=f"surface-{path}",
                quantity="displacement",
                points=points,
                along=distance,
                label=f"distance from the axis along {path if path != 'diagonal' else 'the diagonal'}",
                components=present,
                formal_order=3.0,
            )
        )
    return tuple(profiles)


def clear_of(contains: Contains, points: FloatArray, margin: float) -> BoolArray:
    """Whether the points lie farther than about `margin` from the boundary of the region, ``(n,)``."""
    state = np.asarray(contains(*points.T))
    probes = points[:, None, :] + margin * DIRECTIONS
    probes = np.concatenate([probes, points[:, None, :] + 0.5 * margin * DIRECTIONS], axis=1)
    inside = np.asarray(contains(*(probes[..., axis] for axis in range(3))))
    return np.asarray(np.all(inside == state[:, None], axis=1))


def inner_lines(
    contains: Contains,
    bounds: tuple[tuple[float, float, float], tuple[float, float, float]],
    anchor: tuple[float, float, float],
    *,
    margin: float,
    count: int = 25,
    components: Sequence[str] = STRESSES,
    formal_order: float = 3.0,
    inside: bool = True,
    gap: float = 0.6,
) -> tuple[Profile, ...]:
    """Stress along a vertical line through the region, a vertical one beside it, and a horizontal one across it.

    Parameters
    ----------
    contains, bounds : callable, (low, high)
        The region.
    anchor : (x, y, z)
        Point of the region that the lines go through.
    margin : float
        Distance from the boundary of the region below which points are left out.
    count : int
        Points of each line, before some are left out.
    components : sequence of str
        Components of stress to compare.
    formal_order : float
        Largest order of convergence of the stress to be believed.
    inside : bool
        Whether points inside the region are kept.
    gap : float
        How far the line beside the region is from its bounds, in its longest extents.
    """
    low, high = np.asarray(bounds[0]), np.asarray(bounds[1])
    size = float(np.max(high - low))
    x, y, z = anchor
    top, bottom = max(0.06 * size, low[2] - 1.2 * size), high[2] + 1.2 * size
    depths, outwards = np.linspace(top, bottom, count), np.linspace(x, high[0] + 1.5 * size, count)
    beside = high[0] + gap * size
    lines = {
        "through": (_column(x, y, depths), depths, "depth"),
        "beside": (_column(beside, y, depths), depths, "depth"),
        "across": (np.stack([outwards, np.full(count, y), np.full(count, z)], axis=1), outwards, "x"),
    }
    profiles = []
    for name, (points, along, label) in lines.items():
        clear = clear_of(contains, points, margin) & (points[:, 2] >= 0)
        if not inside:
            clear &= ~np.asarray(contains(*points.T))
        profiles.append(
            Profile(
                name=f"{name}-stress",
                quantity="stress",
                points=points[clear],
                along=along[clear],
                label=label,
                components=tuple(components),
                formal_order=formal_order,
            )
        )
    return tuple(profiles)


def in_units(profiles: Iterable[Profile], *, length: str, displacement: str, stress: str) -> tuple[Profile, ...]:
    """Profiles whose abscissa and values have a unit in words of the problem: ``"edge"``, ``"ε* edge"``, ``"E ε*"``."""
    return tuple(
        replace(
            profile,
            label=f"{profile.label} [{length}]",
            unit=displacement if profile.quantity == "displacement" else stress,
        )
        for profile in profiles
    )


def _column(x: float, y: float, depths: FloatArray) -> FloatArray:
    return np.stack([np.full(depths.size, x), np.full(depths.size, y), depths], axis=1)


def read_section(solution: Any, profiles: Sequence[Profile], contains: Contains) -> Fields:
    """Read what the profiles ask for of an axisymmetric model with one source; stress is recovered on its own side."""
    from eigencontact_verification.fem.section_recovery import recovered_section_stress

    fields = {}
    for profile in profiles:
        if profile.quantity == "displacement":
            values = solution.displacement(profile.points)
        else:
            values = recovered_section_stress(solution, profile.points, side=contains)
        fields[profile.name] = chosen(values, profile)
    return fields


def read_solid(solution: Any, profiles: Sequence[Profile], sources: Sequence[Contains] = ()) -> Fields:
    """Read a solid model: stress recovered on each side of the bounds of its sources (see `recovery`)."""
    from eigencontact_verification.fem.recovery import recovered_stress

    model = solution.model
    boxes = [(*region.bounds[0], *region.bounds[1]) for region in model.regions]
    boxes += [(*patch.low, 0.0, *patch.high, 0.0) for patch in model.patches]
    breaks = [sorted({box[axis] for box in boxes} | {box[axis + 3] for box in boxes}) for axis in range(3)]
    contains = sources[0] if sources else None
    fields = {}
    for profile in profiles:
        if profile.quantity == "displacement":
            values = solution.displacement(profile.points)
        else:
            values = recovered_stress(solution, profile.points, breaks=breaks, contains=contains)
        fields[profile.name] = chosen(values, profile)
    return fields


def growth_to(distance: float, elements: int) -> float:
    """Growth with which so many elements of the coarse mesh reach from the source to a distance.

    Parameters
    ----------
    distance : float
        In edges of the elements beside the source.
    elements : int
        Number of elements. The edge at a distance t is ``1 + ln(growth) t``.

    Examples
    --------
    >>> round(growth_to(60.0, 2), 2)
    12.31
    """
    low, high = 1e-6, 50.0
    for _ in range(100):
        rate = 0.5 * (low + high)
        low, high = (rate, high) if np.log1p(rate * distance) / rate > elements else (low, rate)
    return float(np.exp(high)) * (1 + 1e-9)


def columns(values: Any, components: Sequence[str]) -> FloatArray:
    """Components of displacements ``(n, 3)`` or stresses ``(n, 3, 3)``, ``(n, components)``; names end with indices."""
    indices = (tuple(_AXES.index(axis) for axis in name.rpartition("_")[2]) for name in components)
    array = np.moveaxis(np.asarray(values), 0, -1)
    return np.stack([array[place] for place in indices], axis=-1)


def chosen(values: Any, profile: Profile) -> FloatArray:
    """`columns` of a profile."""
    return columns(values, profile.components)


class FieldCase(Case):
    """Case whose semi-analytical field is known at any point, without an error of its own."""

    @abstractmethod
    def field(self, points: FloatArray, quantity: Quantity) -> FloatArray:
        """Displacement ``(n, 3)`` or stress ``(n, 3, 3)`` at points ``(n, 3)``."""

    def judged(self) -> Fields:
        """Values of the field; see `Case.judged`."""
        return {
            profile.name: chosen(self.field(profile.points, profile.quantity), profile) for profile in self.profiles
        }

    def curve(self, profile: Profile) -> Curve | None:
        """Field on the line of a profile, closely; see `Case.curve`."""
        from eigencontact_verification.crosscheck.pictures.fields import curve

        return curve(profile, self.field)
