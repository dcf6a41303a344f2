"""Tables of a scene with eigenstrain in a body: inclusions of a shape, and patches of the surface layer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field, field_validator, model_validator

from eigencontact.core.places import place_field
from eigencontact.errors import SceneError
from eigencontact.scene.checks import at_least
from eigencontact.scene.table import ComponentTable, FiniteLength, OfKind, PositiveLength

__all__ = ["EigenstrainPatch", "Inclusion", "eigenstrain_table"]

_Layers = Annotated[int, AfterValidator(at_least(1))]


class _Component(ComponentTable):
    """Table of a region of a body.

    Parameters
    ----------
    name : str, optional
        Name in pictures, messages, results, `explain` and laws by material, different from the others of its
        kind; by default the shape or field and its number.
    body : {1, 2}
        Half-space that contains the region.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9 ._-]*$")] | None = None
    body: Literal[1, 2] = 1


class Inclusion(_Component):
    """Region of a body with an eigenstrain (stress-free strain), other elastic constants, or both.

    A region with a `material` is an inhomogeneity: its eigenstrain follows from the stress that acts on it. Where
    inhomogeneities overlap, the later table determines the material and the prestrain. Prescribed eigenstrains that
    overlap add up; in an inhomogeneity they add to its prestrain.

    ``type`` names the inclusion shape; its fields (center, radius, edges ...) are keys of the same table. Coordinates
    are those of the scene with z into `body`, the surface at z = 0.

    Attributes
    ----------
    eigenstrain : number, three numbers, 3 x 3 matrix or table
        Expansion positive, tensor components: one number is isotropic, three are (xx, yy, zz). A table defines an
        eigenstrain field: ``{ type = "thermal", ... }``. Optional, and zero by default, with a material.
    material : table or component, optional
        Constitutive law; its ``type`` names the plugin, ``"isotropic"`` by default. ``void = true`` is short
        for ``type = "void"``.
    centers : list of (x, y, z), optional
        Positions [m] of copies of the inclusion, in place of the field of the shape with its position
        (``center``, of a polyhedron ``offset``).
    """

    kind: ClassVar[str] = "inclusion-shape"

    eigenstrain: Annotated[Any, OfKind("eigenstrain-field")] = None
    material: Annotated[dict[str, Any] | None, OfKind("constitutive-law", default="isotropic")] = None
    centers: Annotated[list[tuple[FiniteLength, FiniteLength, FiniteLength]], Field(min_length=1)] | None = None

    def tables(self, shape: type, where: str) -> list[dict[str, Any]]:
        """Tables of the shape plugin of class `shape`, one for each place.

        Raises
        ------
        SceneError
            Many places for a shape that does not say where it is (no field is annotated `Place`), or one beside them.
        """
        if self.centers is None:
            return [self.component]
        name = place_field(shape)
        if name is None:
            raise SceneError(
                f"{where}.centers must be left out for {self.type!r}, a shape without a field that says where it is "
                f"(got {len(self.centers)} centers); give a table of inclusions for each"
            )
        position_key = next((key for key in self.component if key.replace("-", "_") == name), None)
        if position_key is not None:
            raise SceneError(f"{where} must be at its {position_key}, or at centers (got both); give one of them")
        return [{**self.component, name: center} for center in self.centers]

    @field_validator("eigenstrain")
    @classmethod
    def _field(cls, value: Any) -> Any:
        rule = 'a number, three, a symmetric 3 x 3 matrix, or a table { type = "...", ... } that names a field'
        good = isinstance(value.get("type"), str) if isinstance(value, Mapping) else _is_strain(value)
        if not good:
            raise ValueError(rule)
        return value

    @field_validator("material", mode="before")
    @classmethod
    def _law(cls, value: Any) -> Any:
        if not isinstance(value, Mapping):
            return value
        table = dict(value)
        if table.pop("void", False) is True:
            if table.get("type", "void") != "void":
                raise ValueError("void = true, or of another type: leave one of them out")
            table["type"] = "void"
        return {"type": "isotropic", **table}

    @model_validator(mode="after")
    def _with_a_cause(self) -> Inclusion:
        if self.eigenstrain is None and self.material is None:
            raise ValueError("given an eigenstrain, a material, or both")
        return self


class EigenstrainPatch(_Component):
    """Eigenstrain field in a patch of the window from the surface down to a depth.

    ``type`` names the eigenstrain field; its fields are keys of the same table.

    Attributes
    ----------
    depth : float
        Lower end [m]; the upper end is the surface.
    layers : int, optional
        Layers of cells over the depth; 32 by default. If the depth steps of a stress region divide the depth into 16
        to 64 layers, the default is these layers: the field there then needs a single transform in space.
    size : (float, float), optional
        Extent of the patch along x and y [m], rounded to whole cells; the whole window by default.
    center : (float, float), optional
        Centre of the patch [m]; by default the centre of the window.
    """

    kind: ClassVar[str] = "eigenstrain-field"

    depth: PositiveLength
    layers: _Layers | None = None
    size: tuple[PositiveLength, PositiveLength] | None = None
    center: tuple[FiniteLength, FiniteLength] | None = None


def _is_strain(value: Any) -> bool:
    def row(items: Any, member: Any) -> bool:
        return isinstance(items, list | tuple) and len(items) == 3 and all(member(item) for item in items)

    def number(item: Any) -> bool:
        return isinstance(item, int | float) and not isinstance(item, bool)

    return number(value) or row(value, number) or row(value, lambda items: row(items, number))


def eigenstrain_table(value: Any) -> dict[str, Any]:
    """Table of the eigenstrain field of a number, three numbers, a matrix, a table or None (zero)."""
    if value is None:
        return {"type": "uniform", "value": 0.0}
    return dict(value) if isinstance(value, Mapping) else {"type": "uniform", "value": value}
