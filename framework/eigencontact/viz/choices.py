"""Fields of results by name, and the numbers of a chosen field."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.field_error import error_name
from eigencontact.core.quantities import QUANTITIES
from eigencontact.core.tensors import COMPONENTS, hydrostatic, principal, to_mandel, tresca, von_mises
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.viz.cut import StepValues
from eigencontact.viz.errors import errors_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

__all__ = ["SURFACE", "Field", "cell_fields", "choose", "region_fields", "surface_fields"]

#: Where fields of the surface lie, beside the names of regions.
SURFACE = "surface"
#: A component smaller than this part of the others is zero.
ROUND_OFF = 1e-9
#: Scalars that follow from a stress.
_OF_STRESS = {"von_mises": von_mises, "tresca": tresca, "hydrostatic": hydrostatic}
_PRINCIPAL = ("1", "2", "3")
_MAGNITUDE = "magnitude"
#: Names for titles and colour bars; others are their own names with spaces.
_WORDS = {
    "pressure": "Contact pressure",
    "shear": "Shear traction",
    "shear_bound": "Bound of friction",
    "reference_shear": "Shear traction in closed form",
    "reference_pressure": "Contact pressure in closed form",
    "homogeneous_pressure": "Contact pressure of homogeneous bodies",
    "slip": "Slip in this step",
    "displacement": "Displacement",
    "residual_displacement": "Displacement by eigenstrain",
    "uplift": "Uplift",
    "dissipated_energy_density": "Work of friction",
    "von_mises": "Von Mises stress",
    "tresca": "Tresca stress",
    "hydrostatic": "Mean normal stress",
    "principal": "Principal stress",
}
_AXES = {"x": "along x", "y": "along y", "z": "into the body"}


@dataclass(frozen=True)
class Field:
    """Field of results with a common place of its values.

    Attributes
    ----------
    name : str
        As a user gives it.
    variable : str
        Of the results; the first of several that make it up.
    components : tuple of str
        That can be chosen, the first where none is; empty where it is one number.
    """

    name: str
    variable: str
    components: tuple[str, ...] = ()

    def component(self, symbol: str | None) -> str:
        """Component by name, by default the first; hyphens and the order of two indices do not matter.

        Raises
        ------
        SceneError
            Names the nearest one.
        """
        if symbol is None:
            return self.components[0] if self.components else ""
        text = str(symbol).strip().lower().replace("-", "_")
        if not self.components:
            raise SceneError(f"component must be left out of {self.name!r}, which is one number (got {shown(symbol)})")
        match = next((name for name in (text, text[::-1]) if name in self.components), None)
        if match is None:
            listed = ", ".join(self.components)
            near = nearest(text, self.components)
            raise SceneError(f"component must be one of {listed} for {self.name!r} (got {shown(symbol)}){near}")
        return match


def surface_fields(dataset: Results) -> dict[str, Field]:
    """Fields in the cells of the surface, by name; vectors as one field."""
    names = [str(name) for name, variable in dataset.data_vars.items() if variable.dims == ("step", "y", "x")]
    fields: dict[str, Field] = {}
    for name in names:
        stem, axis = name.rpartition("_")[::2]
        if stem and axis in _AXES:
            axes = [letter for letter in "xyz" if f"{stem}_{letter}" in names]
            normal = ("z",) if "z" in axes else ()
            magnitude = (_MAGNITUDE,) if {"x", "y"} <= set(axes) and not normal else ()
            order = dict.fromkeys((*magnitude, *normal, *axes))
            fields.setdefault(stem, Field(stem, f"{stem}_{axes[0]}", tuple(order)))
        fields[name] = Field(name, name)
    if "residual_displacement_z" in names:
        fields["uplift"] = Field("uplift", "residual_displacement_z")
    return fields


def region_fields(dataset: Results, region: str) -> dict[str, Field]:
    """Fields of a region by name, with the scalars of its stress."""
    stored_fields = json.loads(dataset.attrs["regions"])[region]["fields"]
    by_name: dict[str, Field] = {}
    if "stress" in stored_fields:
        kinds = (*_OF_STRESS, *COMPONENTS, *_PRINCIPAL)
        by_name["stress"] = Field("stress", f"{region}_stress", kinds)
        by_name |= {name: Field(name, f"{region}_stress") for name in _OF_STRESS}
        by_name["principal"] = Field("principal", f"{region}_stress", _PRINCIPAL)
    kinds_of = {"strain": COMPONENTS, "displacement": ("z", "x", "y"), "principal": _PRINCIPAL}
    for name in stored_fields:
        if name != "stress":
            by_name[name] = Field(name, f"{region}_{name}", kinds_of.get(name, ()))
    stored_errors = {error_name(name): field for name, field in by_name.items() if name in stored_fields}
    for name, field in stored_errors.items():
        if f"{region}_{name}" in dataset:
            kinds = COMPONENTS if field.variable == f"{region}_stress" else field.components
            by_name[name] = Field(name, f"{region}_{name}", kinds)
    return by_name


def cell_fields(dataset: Results) -> dict[str, Field]:
    """History fields in the cells of bodies by name: with the number of the body, and without it for the first."""
    fields: dict[str, Field] = {}
    for name in map(str, dataset.data_vars):
        variable = dataset[name]
        stem, body = name.rpartition("_")[::2]
        if body not in ("1", "2") or tuple(variable.dims[-3:]) != tuple(f"cells_{body}_{axis}" for axis in "zyx"):
            continue
        kinds = COMPONENTS if variable.ndim == 5 else ()
        fields[name] = Field(name, name, kinds)
        fields.setdefault(stem, Field(stem, name, kinds))
    if "equivalent_plastic_strain" in fields and "plastic_strain" in fields:
        tensor = fields["plastic_strain"]
        fields["plastic_strain"] = Field("plastic_strain", tensor.variable, ("equivalent", *tensor.components))
    return fields


def choose(name: str, fields: dict[str, Field], place: str, pictures: Sequence[str] = ()) -> Field:
    """Field by name; hyphens and case do not matter. `place` is the text of its place for messages.

    `SceneError` names what there is, standard `pictures` among it, and the nearest name.
    """
    text = str(name).strip().lower().replace("-", "_")
    if text not in fields:
        listed = ", ".join(fields) or "none"
        alternatives = f", or a picture: {', '.join(pictures)}" if pictures else ""
        near = nearest(text, fields) or nearest(text.replace("_", "-"), pictures)
        raise SceneError(
            f"field must be one that the results hold{place}: {listed}{alternatives} (got {shown(name)}){near}"
        )
    return fields[text]


def surface_numbers(dataset: Results, field: Field, component: str, step: int) -> StepValues:
    """Numbers of a field of the surface in one step."""
    stem = field.variable.rpartition("_")[0] if field.components else field.variable
    unit = _unit(dataset, field.variable)
    if component == _MAGNITUDE:
        components = [_read(dataset, f"{stem}_{axis}", step) for axis in "xy"]
        errors = [error for axis in "xy" if (error := errors_of(dataset, f"{stem}_{axis}", step)) is not None]
        size = np.linalg.norm(errors, axis=0) if len(errors) == len(components) else None
        return StepValues(_label(stem), unit, np.hypot(*components), errors=size)
    name = f"{stem}_{component}" if component else field.variable
    values = _read(dataset, name, step)
    if field.name == "uplift":
        return StepValues(_label("uplift"), unit, 0.0 - values, errors=errors_of(dataset, name, step))
    stem, axis = name.rpartition("_")[::2]
    label = f"{_label(stem)} {_AXES[axis]}" if axis in _AXES and stem else _label(name)
    return StepValues(label, unit, values, name, errors_of(dataset, name, step))


def region_numbers(dataset: Results, region: str, field: Field, component: str, step: int) -> StepValues:
    """Numbers of a field of a region in one step."""
    values = _read(dataset, field.variable, step)
    errors = errors_of(dataset, field.variable, step)
    unit = _unit(dataset, field.variable)
    kind = component or field.name
    stored_name = f"{region}_{kind}"
    if kind in _OF_STRESS and stored_name in dataset:  # as the run has found it
        values = _read(dataset, stored_name, step)
        return StepValues(_label(kind), unit, values, stored_name, errors_of(dataset, stored_name, step))
    if field.variable == f"{region}_stress":
        if kind in _OF_STRESS:
            return StepValues(_label(kind), unit, _OF_STRESS[kind](to_mandel(values)))
        if kind in _PRINCIPAL:
            return StepValues(f"{_label('principal')} {kind}", unit, principal(to_mandel(values))[int(kind) - 1])
        return StepValues(
            rf"Stress $\sigma_{{{kind}}}$",
            unit,
            _component_of(values, kind),
            errors=_component_errors(errors, COMPONENTS.index(kind)),
        )
    if not component:
        return StepValues(_label(field.name), unit, values, field.variable, errors)
    at = "xyz".index(kind) if kind in _AXES else field.components.index(kind)
    if kind in COMPONENTS:
        symbol = rf"Strain $\varepsilon_{{{kind}}}$" if field.name == "strain" else f"{_label(field.name)} {kind}"
        return StepValues(symbol, unit, _component_of(values, kind), errors=_component_errors(errors, at))
    words = _AXES.get(kind, kind)
    return StepValues(f"{_label(field.name)} {words}", unit, values[at], errors=_component_errors(errors, at))


def cell_numbers(dataset: Results, field: Field, component: str, step: int) -> StepValues:
    """History fields in the cells of a body after a step.

    Raises
    ------
    SceneError
        A step after which they were not kept.
    """
    variable = field.variable
    if component == "equivalent":
        variable, component = f"equivalent_{variable}", ""
    stored_steps = [int(number) for number in dataset["history_step"].values]
    number = int(dataset["step"][step])
    if number not in stored_steps:
        listed = ", ".join(map(str, stored_steps))
        raise SceneError(
            f"step must be one after which {field.name!r} was kept: {listed} (got {number}); the run keeps that of all "
            'steps with output.history = "all"'
        )
    values = _read(dataset, variable, stored_steps.index(number))
    unit = _unit(dataset, variable)
    label = _label(variable.rpartition("_")[0])
    if component:
        n = COMPONENTS.index(component)
        return StepValues(rf"{label}, ${component}$", unit, values[n] / (1.0 if n < 3 else np.sqrt(2.0)))
    return StepValues(label, unit, values)


def _component_errors(errors: NDArray[Any] | None, at: int) -> NDArray[Any] | None:
    """Errors of one component, if any."""
    return None if errors is None else errors[at]


def _component_of(values: NDArray[Any], component: str) -> NDArray[Any]:
    """Component of stress or strain; zero if it is round-off relative to the other components."""
    field = values[COMPONENTS.index(component)]
    small = np.nanmax(np.abs(field), initial=0.0) <= ROUND_OFF * np.nanmax(np.abs(values), initial=0.0)
    return np.zeros_like(field) if small else field


def _label(name: str) -> str:
    return _WORDS.get(name) or name.replace("_", " ").capitalize()


def _unit(dataset: Results, variable: str) -> str:
    unit = str(dataset[variable].attrs.get("units", ""))
    return QUANTITIES[variable].unit if not unit and variable in QUANTITIES else unit.replace("^", "")


def _read(dataset: Results, variable: str, step: int) -> NDArray[Any]:
    return np.asarray(dataset[variable][step].values, dtype=float)
