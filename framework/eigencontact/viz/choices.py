"""Which fields results hold, by the names that a user gives, and the numbers of one of them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.quantities import QUANTITIES
from eigencontact.core.tensors import COMPONENTS, hydrostatic, principal, to_mandel, tresca, von_mises
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.viz.cut import Shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

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
    """A field that results hold in one place.

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

    def component(self, wanted: str | None) -> str:
        """Component of a name, the first where none is given; hyphens and the order of two indices do not matter.

        Raises
        ------
        SceneError
            Names the nearest one.
        """
        if wanted is None:
            return self.components[0] if self.components else ""
        text = str(wanted).strip().lower().replace("-", "_")
        if not self.components:
            raise SceneError(f"component must be left out of {self.name!r}, which is one number (got {shown(wanted)})")
        found = next((name for name in (text, text[::-1]) if name in self.components), None)
        if found is None:
            known = ", ".join(self.components)
            near = nearest(text, self.components)
            raise SceneError(f"component must be one of {known} for {self.name!r} (got {shown(wanted)}){near}")
        return found


def surface_fields(dataset: Results) -> dict[str, Field]:
    """Fields in the cells of the surface, by name; vectors as one field."""
    names = [str(name) for name, made in dataset.data_vars.items() if made.dims == ("step", "y", "x")]
    found: dict[str, Field] = {}
    for name in names:
        stem, axis = name.rpartition("_")[::2]
        if stem and axis in _AXES:
            parts = [one for one in "xyz" if f"{stem}_{one}" in names]
            own = ("z",) if "z" in parts else ()
            whole = (_MAGNITUDE,) if {"x", "y"} <= set(parts) and not own else ()
            order = dict.fromkeys((*whole, *own, *parts))
            found.setdefault(stem, Field(stem, f"{stem}_{parts[0]}", tuple(order)))
        found[name] = Field(name, name)
    if "residual_displacement_z" in names:
        found["uplift"] = Field("uplift", "residual_displacement_z")
    return found


def region_fields(dataset: Results, region: str) -> dict[str, Field]:
    """Fields of a region, by name; what follows from its stress among them."""
    fields = json.loads(dataset.attrs["regions"])[region]["fields"]
    found: dict[str, Field] = {}
    if "stress" in fields:
        kinds = (*_OF_STRESS, *COMPONENTS, *_PRINCIPAL)
        found["stress"] = Field("stress", f"{region}_stress", kinds)
        found |= {name: Field(name, f"{region}_stress") for name in _OF_STRESS}
        found["principal"] = Field("principal", f"{region}_stress", _PRINCIPAL)
    kinds_of = {"strain": COMPONENTS, "displacement": ("z", "x", "y"), "principal": _PRINCIPAL}
    for name in fields:
        if name != "stress":
            found[name] = Field(name, f"{region}_{name}", kinds_of.get(name, ()))
    return found


def cell_fields(dataset: Results) -> dict[str, Field]:
    """What the cells of bodies remember, by name with the number of the body, and by name alone of the first body."""
    found: dict[str, Field] = {}
    for name in map(str, dataset.data_vars):
        made = dataset[name]
        stem, body = name.rpartition("_")[::2]
        if body not in ("1", "2") or tuple(made.dims[-3:]) != tuple(f"cells_{body}_{axis}" for axis in "zyx"):
            continue
        kinds = COMPONENTS if made.ndim == 5 else ()
        found[name] = Field(name, name, kinds)
        found.setdefault(stem, Field(stem, name, kinds))
    if "equivalent_plastic_strain" in found and "plastic_strain" in found:
        tensor = found["plastic_strain"]
        found["plastic_strain"] = Field("plastic_strain", tensor.variable, ("equivalent", *tensor.components))
    return found


def choose(name: str, known: dict[str, Field], place: str, pictures: Sequence[str] = ()) -> Field:
    """Field of a name; hyphens and case do not matter.

    Parameters
    ----------
    name : str
        As a user gives it.
    known : dict
        Fields by name.
    place : str
        Where they lie, in words.
    pictures : sequence of str
        Standard pictures that could be asked for instead.

    Raises
    ------
    SceneError
        Names what there is, and the nearest name.
    """
    text = str(name).strip().lower().replace("-", "_")
    if text not in known:
        listed = ", ".join(known) or "none"
        others = f", or a picture: {', '.join(pictures)}" if pictures else ""
        near = nearest(text, known) or nearest(text.replace("_", "-"), pictures)
        raise SceneError(f"field must be one that the results hold{place}: {listed}{others} (got {shown(name)}){near}")
    return known[text]


def surface_numbers(dataset: Results, field: Field, component: str, step: int) -> Shown:
    """Numbers of a field of the surface in one step."""
    stem = field.variable.rpartition("_")[0] if field.components else field.variable
    unit = _unit(dataset, field.variable)
    if component == _MAGNITUDE:
        parts = [_read(dataset, f"{stem}_{axis}", step) for axis in "xy"]
        return Shown(_words(stem), unit, np.hypot(*parts))
    name = f"{stem}_{component}" if component else field.variable
    values = _read(dataset, name, step)
    if field.name == "uplift":
        return Shown(_words("uplift"), unit, 0.0 - values)
    stem, axis = name.rpartition("_")[::2]
    words = f"{_words(stem)} {_AXES[axis]}" if axis in _AXES and stem else _words(name)
    return Shown(words, unit, values, name)


def region_numbers(dataset: Results, region: str, field: Field, component: str, step: int) -> Shown:
    """Numbers of a field of a region in one step."""
    values = _read(dataset, field.variable, step)
    unit = _unit(dataset, field.variable)
    kind = component or field.name
    stored = f"{region}_{kind}"
    if kind in _OF_STRESS and stored in dataset:  # as the run has found it
        return Shown(_words(kind), unit, _read(dataset, stored, step), stored)
    if field.variable == f"{region}_stress":
        if kind in _OF_STRESS:
            return Shown(_words(kind), unit, _OF_STRESS[kind](to_mandel(values)))
        if kind in _PRINCIPAL:
            return Shown(f"{_words('principal')} {kind}", unit, principal(to_mandel(values))[int(kind) - 1])
        return Shown(rf"Stress $\sigma_{{{kind}}}$", unit, _one(values, kind))
    if not component:
        return Shown(_words(field.name), unit, values, field.variable)
    if field.name == "strain":
        return Shown(rf"Strain $\varepsilon_{{{kind}}}$", unit, _one(values, kind))
    if field.name == "displacement":
        return Shown(f"{_words(field.name)} {_AXES[kind]}", unit, values["xyz".index(kind)])
    return Shown(f"{_words(field.name)} {kind}", unit, values[int(kind) - 1])


def cell_numbers(dataset: Results, field: Field, component: str, step: int) -> Shown:
    """Numbers that the cells of a body remember after a step.

    Raises
    ------
    SceneError
        A step after which they were not kept.
    """
    variable = field.variable
    if component == "equivalent":
        variable, component = f"equivalent_{variable}", ""
    kept = [int(number) for number in dataset["history_step"].values]
    number = int(dataset["step"][step])
    if number not in kept:
        listed = ", ".join(map(str, kept))
        raise SceneError(
            f"step must be one after which {field.name!r} was kept: {listed} (got {number}); the run keeps that of all "
            'steps with output.history = "all"'
        )
    values = _read(dataset, variable, kept.index(number))
    unit = _unit(dataset, variable)
    words = _words(variable.rpartition("_")[0])
    if component:
        n = COMPONENTS.index(component)
        return Shown(rf"{words}, ${component}$", unit, values[n] / (1.0 if n < 3 else np.sqrt(2.0)))
    return Shown(words, unit, values)


def _one(values: NDArray[Any], component: str) -> NDArray[Any]:
    """One component (of stress or strain); zero where it is round-off beside the others, which has no picture."""
    found = values[COMPONENTS.index(component)]
    small = np.nanmax(np.abs(found), initial=0.0) <= ROUND_OFF * np.nanmax(np.abs(values), initial=0.0)
    return np.zeros_like(found) if small else found


def _words(name: str) -> str:
    return _WORDS.get(name) or name.replace("_", " ").capitalize()


def _unit(dataset: Results, variable: str) -> str:
    unit = str(dataset[variable].attrs.get("units", ""))
    return QUANTITIES[variable].unit if not unit and variable in QUANTITIES else unit.replace("^", "")


def _read(dataset: Results, variable: str, step: int) -> NDArray[Any]:
    return np.asarray(dataset[variable][step].values, dtype=float)


def listed(names: Iterable[str]) -> str:
    """Names in quotation marks, for messages."""
    return ", ".join(map(repr, names)) or "none"
