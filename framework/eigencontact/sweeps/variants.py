"""Variants of a scene: one for each combination of values, and what each is called."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from itertools import product
from typing import TYPE_CHECKING, Any

from eigencontact.errors import EigencontactError, SceneError
from eigencontact.scene.loader import put_values

if TYPE_CHECKING:
    from eigencontact.scene.schema import Scene
    from eigencontact.sweeps.axes import Axis

__all__ = ["Variant", "variants_of"]

_LONGEST = 100


@dataclass(frozen=True)
class Variant:
    """One scene of a sweep.

    Attributes
    ----------
    label : str
        Name of its folder, made of its values.
    place : tuple of int
        Number of its value on each axis; of paired axes one number.
    values : dict
        Value of each key.
    scene : Scene or None
        What is run; None where the values make no scene.
    refused : str
        Why the variant is not run: values that make no scene, or a scene that no plan can be made of.
    """

    label: str
    place: tuple[int, ...]
    values: dict[str, Any]
    scene: Scene | None
    refused: str = ""


def variants_of(scene: Scene, axes: Sequence[Axis], *, pairs: bool, pictures: bool) -> list[Variant]:
    """All combinations, the last axis fastest; or the values of all axes in step with each other.

    Raises
    ------
    SceneError
        Pairs of axes of different length; every variant refused (the first reason).
    """
    if pairs:
        counts = {axis.key: len(axis.values) for axis in axes}
        if len(set(counts.values())) > 1:
            raise SceneError(f"pairs must have as many values of each key (got {json.dumps(counts)})")
        places = [(k,) * len(axes) for k in range(len(axes[0].values))]
    else:
        places = list(product(*(range(len(axis.values)) for axis in axes)))
    variants = [_variant(scene, axes, place, pairs=pairs, pictures=pictures) for place in places]
    if all(variant.scene is None for variant in variants):
        raise SceneError(f"every variant of the sweep is refused; the first: {variants[0].refused}")
    return variants


def _variant(scene: Scene, axes: Sequence[Axis], place: tuple[int, ...], *, pairs: bool, pictures: bool) -> Variant:
    from eigencontact.scene.schema import Scene as Made

    values = {axis.key: axis.values[k] for axis, k in zip(axes, place, strict=True)}
    more = {} if pictures else {"output.pictures": False, "output.vtk": False, "output.animation": False}
    label, at = _label(values), place[:1] if pairs else place
    try:
        variant_scene = Made(**put_values(scene.resolved(), {**more, **values}))
    except EigencontactError as problem:
        return Variant(label, at, values, None, str(problem))
    return Variant(label, at, values, variant_scene.within(scene.folder))


def _label(values: dict[str, Any]) -> str:
    """Name of a folder from the values of a variant; a hash replaces values that do not fit."""
    text = "_".join(f"{key.rpartition('.')[2]}={value}" for key, value in values.items())
    plain = re.sub(r"[^\w.=+-]", "", text.replace(" ", ""), flags=re.ASCII)
    full = sha256(json.dumps(values, sort_keys=True, default=str).encode()).hexdigest()[:8]
    return plain if len(plain) <= _LONGEST and plain == text.replace(" ", "") else f"{plain[:_LONGEST]}-{full}"
