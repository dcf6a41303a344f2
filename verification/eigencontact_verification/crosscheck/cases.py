"""The list of cases: every kernel with the cases of `cases.toml`, and shapes of other authors' plugins.

Kernels are the keys of inclusion shapes, of surface influences and of layered media; ``"inhomogeneity"``, the solver of
equivalent inclusions; ``"polynomial-eigenstrain"``, balls with eigenstrain that varies; ``"plasticity"``, bodies that
yield; and ``"wear"``, surfaces that wear.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from importlib.resources import files
from itertools import product
from typing import Any

from eigencontact.scene.installed import installed_plugins
from eigencontact_verification.crosscheck import inhomogeneities, layers, plasticity, polynomials, wear
from eigencontact_verification.crosscheck.case import Case, Gap
from eigencontact_verification.crosscheck.inclusions import inclusion_case, shape_of
from eigencontact_verification.crosscheck.strangers import example_of, symmetries_of, text_digest
from eigencontact_verification.crosscheck.tractions import TRACTIONS, rectangle_case

__all__ = ["cases_of", "gaps", "kernels", "why_not"]

#: Inclusion shapes with rows in the table.
_SHAPES = ("cuboid", "sphere", "ellipsoid", "cylinder", "layer", "polyhedron")
#: Builders of everything that is neither a traction nor a shape.
_BUILDERS: dict[str, Callable[..., Case]] = {
    inhomogeneities.KEY: inhomogeneities.inhomogeneity_case,
    polynomials.KEY: polynomials.polynomial_case,
    layers.KEY: layers.layered_case,
    plasticity.KEY: plasticity.plastic_case,
    wear.KEY: wear.wear_case,
}


@cache
def _table() -> dict[str, list[dict[str, Any]]]:
    return tomllib.loads((files(__package__) / "cases.toml").read_text(encoding="utf-8"))


def _rows(kind: str) -> Iterator[dict[str, Any]]:
    """Rows of one kind, one for every combination of the values in ``each``, with the changes of ``special``."""
    for row in _table()[kind]:
        fixed = {name: value for name, value in row.items() if name not in ("each", "special")}
        choices = row.get("each", {})
        for values in product(*choices.values()):
            arguments = {**fixed, **dict(zip(choices, values, strict=True))}
            for rule in row.get("special", ()):
                if all(arguments[name] in allowed for name, allowed in rule.items() if name != "then"):
                    arguments |= rule["then"]
            yield arguments


def _stranger(kernel: str) -> tuple[Case, ...]:
    """Uniform expansion and one shear of a shape that is known by `contains` and `bounds` alone."""
    entry = installed_plugins().get("inclusion-shape", kernel)
    table = {"key": kernel, **example_of(entry.component)}
    symmetries = symmetries_of(shape_of(table))
    text = {"text": text_digest(entry.component)}  # the elements call `contains`
    sheared = symmetries | {"revolved": False, "refine": 0.5}
    cases = (
        inclusion_case(table, "uniform", 0.3, name="example", quick=symmetries["revolved"], **symmetries),
        inclusion_case(table, "xz", 0.3, name="example", **sheared),
    )
    return tuple(replace(case, parameters={**case.parameters, **text}) for case in cases)


def _builder_keys() -> list[str]:
    """Keys of `_BUILDERS`, without layered media that are not installed."""
    media = [entry.key for entry in installed_plugins().of_kind("layered-medium")]
    return [key for key in _BUILDERS if key != layers.KEY or key in media]


def _shapes() -> list[str]:
    return [entry.key for entry in installed_plugins().of_kind("inclusion-shape")]


def kernels() -> tuple[str, ...]:
    """Keys that can be verified: tractions, shapes, bodies that are not homogeneous; strangers' shapes last."""
    shapes = _shapes()
    strangers = [key for key in shapes if key not in _SHAPES and not _refusal(key)]
    return (*TRACTIONS, *(key for key in _SHAPES if key in shapes), *_builder_keys(), *strangers)


def cases_of(kernel: str) -> tuple[Case, ...]:
    """Cases of one key, the quick ones among them.

    Raises
    ------
    ValueError
        No plugin of this key is installed, or its shape needs parameters that nobody gives.
    """
    if kernel in TRACTIONS:
        return tuple(rectangle_case(kernel, **row) for row in _rows("tractions"))
    if kernel in _builder_keys():
        return tuple(_BUILDERS[kernel](**row) for row in _rows(kernel))
    if kernel not in _shapes():
        raise ValueError(f"kernel must be one of {', '.join(kernels())} (got {kernel!r}); install its plugin")
    return tuple(inclusion_case(**row) for row in _rows(kernel)) if kernel in _SHAPES else _stranger(kernel)


def gaps() -> tuple[Gap, ...]:
    """Known gaps of the cases, with their reasons."""
    refused = [Gap(subject=key, what="all", reason=reason) for key in _shapes() if (reason := _refusal(key))]
    return (*(Gap(**row) for row in _rows("gaps")), *refused)


def why_not(kernel: str) -> str:
    """Reason why an installed or broken plugin cannot be verified; empty for other names.

    Reasons: its shape cannot be built without parameters, the plugin is broken, or it is of another kind.
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
    """Reason why the shape of another author's plugin cannot be built; empty if it can."""
    if key in _SHAPES:
        return ""
    component: Any = installed_plugins().get("inclusion-shape", key).component
    try:
        example_of(component)
    except ValueError as problem:
        return str(problem)
    return ""
