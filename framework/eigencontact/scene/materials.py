"""Elastic constants of an inclusion that differ from those around it, as a table of a scene."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from eigencontact.core.quantities import Stress
from eigencontact.scene.checks import finite, in_range, positive
from eigencontact.scene.table import Table

__all__ = ["InclusionMaterial"]

_Modulus = Annotated[Stress, AfterValidator(positive("Pa"))]
_Constant = Annotated[Stress, AfterValidator(finite("Pa"))]
_Ratio = Annotated[float, AfterValidator(finite("-"))]
_Direction = Annotated[list[Annotated[float, AfterValidator(finite("-"))]], Field(min_length=3, max_length=3)]

#: Keys of each kind of material, and those among them that may be left out.
_KEYS: dict[str, tuple[str, ...]] = {
    "isotropic": ("young_modulus", "poisson_ratio"),
    "void": (),
    "cubic": ("c11", "c12", "c44", "x_axis", "y_axis"),
    "transversely-isotropic": (
        "axial_modulus",
        "transverse_modulus",
        "axial_poisson_ratio",
        "transverse_poisson_ratio",
        "axial_shear_modulus",
        "axis",
    ),
    "stiffness": ("stiffness",),
    "map": ("file",),
}
_OPTIONAL = ("x_axis", "y_axis", "axis")


class InclusionMaterial(Table):
    """What an inclusion is made of: ``"isotropic"`` where no `type` is given, ``"void"`` with ``void = true``.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Isotropic [Pa], [-].
    c11, c12, c44, x_axis, y_axis
        Cubic [Pa], with the directions of two of the crystal's axes (those of the scene by default).
    axial_modulus, transverse_modulus, axial_shear_modulus, axial_poisson_ratio, transverse_poisson_ratio, axis
        Transversely isotropic about `axis` (z by default) [Pa], [-]; the axial Poisson's ratio is the contraction
        across by a pull along the axis.
    stiffness : (6, 6)
        In Mandel components [Pa], order xx, yy, zz, yz, xz, xy.
    file : str
        Of a map: arrays x, y, z [m], young_modulus [Pa] and poisson_ratio on them.
    """

    type: Literal["isotropic", "void", "cubic", "transversely-isotropic", "stiffness", "map"] = "isotropic"
    void: bool = False
    young_modulus: _Modulus | None = None
    poisson_ratio: Annotated[float, AfterValidator(in_range(-1.0, 0.5, "[-]", open_low=True))] | None = None
    c11: _Modulus | None = None
    c12: _Constant | None = None
    c44: _Modulus | None = None
    x_axis: _Direction | None = None
    y_axis: _Direction | None = None
    axial_modulus: _Modulus | None = None
    transverse_modulus: _Modulus | None = None
    axial_poisson_ratio: _Ratio | None = None
    transverse_poisson_ratio: _Ratio | None = None
    axial_shear_modulus: _Modulus | None = None
    axis: _Direction | None = None
    stiffness: list[list[_Constant]] | None = None
    file: str | None = None

    @model_validator(mode="before")
    @classmethod
    def _void(cls, value: Any) -> Any:
        if isinstance(value, dict) and value.get("void") is True:
            return {"type": "void", **value}
        return value

    @model_validator(mode="after")
    def _complete(self) -> InclusionMaterial:
        if self.void and self.type != "void":
            raise ValueError("void = true, or of another type: leave one of them out")
        wanted = _KEYS[self.type]
        missing = [name for name in wanted if getattr(self, name) is None and name not in _OPTIONAL]
        if missing:
            raise ValueError(f"{_a(self.type)}, which needs {_listed(missing)}; give it, or another type")
        known = {name for names in _KEYS.values() for name in names}
        more = sorted(name for name in known - set(wanted) if getattr(self, name) is not None)
        if more:
            raise ValueError(f"{_a(self.type)}, which has no {_listed(more)}; leave it out, or give another type")
        if self.stiffness is not None:
            _check_stiffness(self.stiffness)
        return self

    @property
    def constants(self) -> dict[str, Any]:
        """Constants of its type that are given, by name."""
        return {name: value for name in _KEYS[self.type] if (value := getattr(self, name)) is not None}


def _a(kind: str) -> str:
    return f"of type {kind!r}"


def _listed(names: list[str]) -> str:
    return ", ".join(name.replace("_", "-") for name in names)


def _check_stiffness(rows: list[list[float]]) -> None:
    if len(rows) != 6 or any(len(row) != 6 for row in rows):
        raise ValueError("with a stiffness of 6 x 6 Mandel components [Pa]")
    values = np.array(rows)
    size = float(np.abs(values).max())
    if np.abs(values - values.T).max() > 1e-9 * size:
        raise ValueError("with a symmetric stiffness, 6 x 6 Mandel components [Pa]")
    if np.linalg.eigvalsh(values)[0] < -1e-9 * size:
        raise ValueError("with a stiffness that has no negative eigenvalue")
