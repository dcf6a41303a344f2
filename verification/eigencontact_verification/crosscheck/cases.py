"""The list of cases: every kernel with what it is compared for, installed shapes of strangers included.

Lengths are in units of an edge or a diameter, which is 1; Young's modulus and the eigenstrain or traction are 1 too.
Depths are those of the centre. Kernels are the keys of inclusion shapes, of surface influences and of layered media;
``"inhomogeneity"``, the solver of equivalent inclusions; ``"plasticity"``, bodies that yield; and ``"wear"``, surfaces
that wear. The radius of a circle under pressure is 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from eigencontact.scene.installed import installed_plugins
from eigencontact_verification.crosscheck import inhomogeneities, layers, plastic_cases, plasticity, wear
from eigencontact_verification.crosscheck.case import Case, Gap
from eigencontact_verification.crosscheck.inclusions import EIGENSTRAINS, inclusion_case, shape_of
from eigencontact_verification.crosscheck.strangers import (
    example_of,
    is_mirrored,
    is_revolved,
    point_inside,
    text_digest,
)
from eigencontact_verification.crosscheck.tractions import TRACTIONS, rectangle_case

__all__ = ["cases_of", "gaps", "kernels", "why_not"]

POISSON_RATIOS = (0.0, 0.3, 0.45)
DEPTHS = (0.5, 1.5, 5.0)
_REVOLVED = ("uniform", "zz")
_OCTAHEDRON = {
    "vertices": [[0.5, 0, 0], [-0.5, 0, 0], [0, 0.5, 0], [0, -0.5, 0], [0, 0, 0.5], [0, 0, -0.5]],
    "faces": [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
}


def _tractions(kernel: str) -> tuple[Case, ...]:
    return tuple(rectangle_case(kernel, nu, quick=nu == 0.3) for nu in POISSON_RATIOS)


def _cuboid() -> tuple[Case, ...]:
    cases: list[Case] = []
    for depth in DEPTHS:
        cube = {"key": "cuboid", "center": [0.0, 0.0, depth], "edges": [1.0, 1.0, 1.0]}
        for nu in POISSON_RATIOS:
            for name in EIGENSTRAINS:
                if name != "uniform":
                    quick = nu == 0.3 and (depth, name) in {(1.5, "zz"), (1.5, "xz"), (5.0, "xy")}
                    title, divisions = f"depth-{_text(depth)}", _divisions(depth, name)
                    cases.append(inclusion_case(cube, name, nu, name=title, quick=quick, divisions=divisions))
    brick = {"key": "cuboid", "center": [0.0, 0.0, 0.6], "edges": [1.6, 1.0, 0.6]}
    cases += [inclusion_case(brick, name, 0.3, name="brick") for name in ("xx", "yy", "zz", "xy", "xz", "yz")]
    tilted = {"key": "cuboid", "center": [0.0, 0.0, 0.9], "edges": [1.0, 0.8, 0.6], "rotation": [0.0, 0.5, 0.0]}
    for name in ("zz", "xz"):
        cases.append(inclusion_case(tilted, name, 0.3, name="tilted", mirrored=(False, True), outer_elements=1))
    return tuple(cases)


def _divisions(depth: float, name: str) -> tuple[int, int, int] | None:
    """Finer meshes where the largest displacement of the surface is many elements away.

    A strain in the plane of a deep cube moves the surface most some five edges beside it.
    """
    return (5, 7, 10) if depth >= 5 and name in ("xx", "yy", "xy", "xx-yy") else None


def _sphere() -> tuple[Case, ...]:
    cases: list[Case] = []
    for depth in (0.75, 1.5, 5.0):
        ball = {"key": "sphere", "center": [0.0, 0.0, depth], "radius": 0.5}
        for nu in POISSON_RATIOS:
            for name in _REVOLVED:
                quick = nu == 0.3 or (depth, name) == (1.5, "uniform")
                cases.append(inclusion_case(ball, name, nu, name=f"depth-{_text(depth)}", revolved=True, quick=quick))
    ball = {"key": "sphere", "center": [0.0, 0.0, 1.5], "radius": 0.5}
    cases += [inclusion_case(ball, name, 0.3, name="solid-depth-1-5") for name in ("xx", "xy", "xz")]
    return tuple(cases)


def _ellipsoid() -> tuple[Case, ...]:
    cases: list[Case] = []
    for title, axes in (("oblate", [0.5, 0.5, 0.2]), ("prolate", [0.25, 0.25, 0.5])):
        spheroid = {"key": "ellipsoid", "center": [0.0, 0.0, 1.0], "semi_axes": axes}
        for nu in POISSON_RATIOS:
            cases += [
                inclusion_case(spheroid, name, nu, name=title, revolved=True, quick=nu == 0.3) for name in _REVOLVED
            ]
    triaxial = {"key": "ellipsoid", "center": [0.0, 0.0, 1.0], "semi_axes": [0.5, 0.35, 0.25]}
    cases += [inclusion_case(triaxial, name, 0.3, name="triaxial") for name in ("xx", "yy", "zz", "xy", "xz", "yz")]
    turned = {**triaxial, "rotation": [0.5, 0.0, 0.0]}
    cases.append(inclusion_case(turned, "zz", 0.3, name="turned", mirrored=(False, False), outer_elements=1))
    return tuple(cases)


def _cylinder() -> tuple[Case, ...]:
    cases: list[Case] = []
    for title, depth, length in (("upright", 1.0, 1.0), ("disc", 0.6, 0.25)):
        upright = {"key": "cylinder", "center": [0.0, 0.0, depth], "radius": 0.5, "length": length}
        for nu in POISSON_RATIOS:
            cases += [
                inclusion_case(upright, name, nu, name=title, revolved=True, quick=nu == 0.3) for name in _REVOLVED
            ]
    lying = {"key": "cylinder", "center": [0.0, 0.0, 1.0], "radius": 0.4, "length": 1.0, "axis": "x"}
    cases += [inclusion_case(lying, name, 0.3, name="lying") for name in ("xx", "zz", "xz")]
    return tuple(cases)


def _layer() -> tuple[Case, ...]:
    layer = {"key": "layer", "size": [1.0, 1.0], "thickness": 0.25, "top": 0.25}
    flush = {**layer, "top": 0.0}
    names = ("xx", "zz", "xy", "xz")
    return (
        *(inclusion_case(layer, name, 0.3, name="buried", refine=0.25, cells=4, exact_cells=True) for name in names),
        *(inclusion_case(flush, name, 0.3, name="flush", refine=0.25, cells=4, exact_cells=True) for name in names),
    )


def _polyhedron() -> tuple[Case, ...]:
    shape = {"key": "polyhedron", "mesh": _OCTAHEDRON, "offset": [0.0, 0.0, 1.0]}
    return tuple(inclusion_case(shape, name, 0.3, name="octahedron") for name in ("uniform", "xz"))


def _stranger(kernel: str) -> tuple[Case, ...]:
    """Uniform expansion and one shear of a shape that is known by `contains` and `bounds` alone."""
    entry = installed_plugins().get("inclusion-shape", kernel)
    given = {"key": kernel, **example_of(entry.component)}
    shape = shape_of(given)
    revolved, anchor = is_revolved(shape), point_inside(shape)
    planes = (is_mirrored(shape, 0), is_mirrored(shape, 1))
    text = {"text": text_digest(entry.component)}  # the elements ask `contains`
    cases = (
        inclusion_case(
            given, "uniform", 0.3, name="example", revolved=revolved, mirrored=planes, anchor=anchor,
            quick=revolved,
        ),
        inclusion_case(given, "xz", 0.3, name="example", mirrored=planes, anchor=anchor, refine=0.5),
    )  # fmt: skip
    return tuple(replace(case, parameters={**case.parameters, **text}) for case in cases)


_OWN: dict[str, Callable[[], tuple[Case, ...]]] = {
    "cuboid": _cuboid,
    "sphere": _sphere,
    "ellipsoid": _ellipsoid,
    "cylinder": _cylinder,
    "layer": _layer,
    "polyhedron": _polyhedron,
}


#: What is neither a traction nor a shape.
_OTHERS: dict[str, Callable[[], tuple[Case, ...]]] = {
    inhomogeneities.KEY: inhomogeneities.inhomogeneity_cases,
    layers.KEY: layers.layered_cases,
    plasticity.KEY: plastic_cases.plastic_cases,
    wear.KEY: wear.wear_cases,
}


def _others() -> list[str]:
    """Keys of `_OTHERS`, without layered media that are not installed."""
    media = [entry.key for entry in installed_plugins().of_kind("layered-medium")]
    return [key for key in _OTHERS if key != layers.KEY or key in media]


def _shapes() -> list[str]:
    return [entry.key for entry in installed_plugins().of_kind("inclusion-shape")]


def kernels() -> tuple[str, ...]:
    """Keys that can be verified: tractions, shapes, bodies that are not homogeneous; strangers' shapes last."""
    shapes = _shapes()
    strangers = [key for key in shapes if key not in _OWN and not _refusal(key)]
    return (*TRACTIONS, *(key for key in _OWN if key in shapes), *_others(), *strangers)


def cases_of(kernel: str) -> tuple[Case, ...]:
    """Cases of one key, the quick ones among them.

    Raises
    ------
    ValueError
        Nothing of this key is installed, or its shape cannot be built without being told how.
    """
    if kernel in TRACTIONS:
        return _tractions(kernel)
    if kernel in _others():
        return _OTHERS[kernel]()
    if kernel not in _shapes():
        raise ValueError(f"kernel must be one of {', '.join(kernels())} (got {kernel!r}); install its plugin")
    return _OWN[kernel]() if kernel in _OWN else _stranger(kernel)


def gaps() -> tuple[Gap, ...]:
    """What is known not to be covered, and why."""
    inside = "cut elements do not resolve it; axisymmetric models do for eigenstrains of revolution"
    unsaid = "displacement elements lock there"
    return (
        Gap(subject="cuboid", what="Poisson's ratio 0.5", reason=unsaid),
        *(
            Gap(subject=key, what="stress inside, without symmetry of revolution", reason=inside)
            for key in ("sphere", "ellipsoid", "cylinder", "polyhedron")
        ),
        Gap(
            subject=inhomogeneities.KEY,
            what="shapes other than spheres, anisotropy, shear on the surface",
            reason="only elements of revolution follow the boundary and know the stress beside it",
        ),
        Gap(subject=inhomogeneities.KEY, what="stress in voids and rigid spheres", reason="cells find its mean only"),
        Gap(
            subject=inhomogeneities.KEY,
            what="one eigenstrain near the surface or under a narrow load",
            reason="what it leaves unfulfilled is there more than the limit of agreement",
        ),
        Gap(subject=layers.KEY, what="shear on the surface", reason="elements of revolution bear pressure only"),
        Gap(subject=layers.KEY, what="Poisson's ratio 0.5", reason=unsaid),
        Gap(
            subject=plasticity.KEY,
            what="friction, two bodies that yield, other shapes than a sphere, layers of other elastic constants",
            reason="the elements are of revolution, below a rigid sphere without friction; layers need fine cells",
        ),
        Gap(
            subject=plasticity.KEY,
            what="the error of the increments",
            reason="both methods take the same, by backward Euler; orders in the load step are tested apart",
        ),
        Gap(
            subject=wear.KEY,
            what="shear coupled to pressure, slip across the load, layers that wear",
            reason="the reference is rings with Cattaneo's and Mindlin's friction; their limits are tested apart",
        ),
        Gap(subject="layer", what="thickness from a file", reason="the same code as uniform thickness, other numbers"),
        *(Gap(subject=key, what="all", reason=reason) for key in _shapes() if (reason := _refusal(key))),
    )


def why_not(kernel: str) -> str:
    """Why something that is installed, or should be, cannot be verified; empty if there is no such thing.

    That is a shape that cannot be built without being told how, a plugin that is broken, or one of another kind.
    """
    if kernel in kernels():
        return ""
    if kernel in _shapes():
        return _refusal(kernel)
    registry = installed_plugins()
    broken = [str(item) for item in registry.broken if item.name == kernel]
    if broken:
        return broken[0]
    kinds = [entry.kind for entry in registry.named(kernel)]
    if kinds:
        return (
            f"kernel must be an inclusion shape or a surface traction (got {kernel!r}, which is of kind "
            f"{kinds[0]}); one of {', '.join(kernels())}"
        )
    return ""


def _refusal(key: str) -> str:
    """Why a stranger's shape cannot be built; empty if it can."""
    if key in _OWN:
        return ""
    component: Any = installed_plugins().get("inclusion-shape", key).component
    try:
        example_of(component)
    except ValueError as problem:
        return str(problem)
    return ""


def _text(depth: float) -> str:
    """Depth for a name: 1.5 is 1-5."""
    return f"{depth:g}".replace(".", "-")
