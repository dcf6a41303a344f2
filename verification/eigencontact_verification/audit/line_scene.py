"""Stored results of a line contact over its steps: loads per length, surface, stress; and reasons without a verdict."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.bodies import NotJudged
from eigencontact_verification.audit.line_bodies import line_scene
from eigencontact_verification.audit.stored import StoredRegion, regions_at

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

__all__ = ["StoredLine", "StoredStrain", "is_line", "read_line"]

FloatArray = NDArray[np.float64]

#: Part of the largest friction from which a contact slides as a whole: its shift has no equation then.
_SLIDES = 1 - 1e-6
#: Part of what friction carries below which a strip sticks.
_STICKS = 1 - 1e-6


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredStrain:
    """Equivalent plastic strain of a body after the last step.

    Attributes
    ----------
    body : int
        From 1.
    x, z : (nx,), (nz,) float64
        Middles of its cells [m].
    values : (nz, nx) float64
    """

    body: int
    x: FloatArray
    z: FloatArray
    values: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class StoredLine:
    """Stored results of a line contact over its steps.

    Attributes
    ----------
    name, text : str
        Of the scene; the scene.
    scene : dict
        Of `line_scene`.
    x : (nx,) float64
        Middles of the strips [m].
    cell : float
        Their width [m].
    half_width, load, force : (steps,) float64
        Half width of the contact [m], forces per length along z and x on body 1 [N/m].
    bulk : (2, steps) float64
        Remote stress xx of both bodies [Pa].
    place : (steps,) float64
        Place x of the geometry [m].
    fields : dict of str to (steps, nx) float64
        ``"pressure"`` and, with friction, ``"shear_x"`` [Pa], ``"slip_x"`` [m].
    regions : list of list of StoredRegion
        Stress, by step.
    strains : list of StoredStrain
        Of bodies that yield.
    pitch : float
        Largest edge of the cells below the surface, 0 without [m].
    middles : dict of int to ((n,), (m,)) float64
        Middles x and z of the cells by body [m].
    """

    name: str
    text: str
    scene: dict[str, Any]
    x: FloatArray
    cell: float
    half_width: FloatArray
    load: FloatArray
    force: FloatArray
    bulk: FloatArray
    place: FloatArray
    fields: dict[str, FloatArray]
    regions: list[list[StoredRegion]]
    strains: list[StoredStrain]
    pitch: float
    middles: dict[int, tuple[FloatArray, FloatArray]]

    @property
    def yields(self) -> bool:
        """Whether a body or a region has a law."""
        return any(owner.get("law") for body in self.scene["bodies"] for owner in (body, *body["regions"]))

    @property
    def smooth(self) -> bool:
        """Whether the pressure falls as Hertz's at its ends: elastic, no regions in cells, no shear that presses."""
        bodies = self.scene["bodies"]
        alike = len({(body["young_modulus"], body["poisson_ratio"]) for body in bodies}) == 1 < len(bodies)
        presses = self.scene["friction"] > 0 and not (alike and not any(body["regions"] for body in bodies))
        return not (self.yields or presses or any(body["cut"] for body in bodies))

    @property
    def travels(self) -> bool:
        """Whether the geometry moves along the surface."""
        return bool(np.any(self.place))

    def edges(self, steps: Iterable[int]) -> list[float]:
        """Places where contact or stick ends in these steps, ascending, at least a strip apart [m]."""
        places = [0.0]
        for k in steps:
            pressure = self.fields["pressure"][k]
            bound = self.scene["friction"] * pressure
            zones = [pressure > 0]
            if "shear_x" in self.fields:
                zones.append(np.abs(self.fields["shear_x"][k]) < _STICKS * bound)
            for zone in zones:
                inside = self.x[zone]
                places += [inside[0] - self.cell / 2, inside[-1] + self.cell / 2] if inside.size else []
        edges = np.unique(places)
        edges = edges[np.append(True, np.diff(edges) > self.cell)]
        return [float(edge) for edge in edges if abs(edge) > self.cell]


def is_line(path: str | Path) -> bool:
    """Whether a run is one of a line contact."""
    from eigencontact.results.stored import open_stored

    with open_stored(path) as data:
        return bool(data.attrs.get("line", 0))


def read_line(path: str | Path) -> StoredLine:
    """Read a run.

    Raises
    ------
    NotJudged
        It has what the elements have not.
    """
    from eigencontact.results.reader import open_results

    with open_results(path) as data:
        if "pressure" not in data.variables:
            raise NotJudged("the run has no contact")
        load = np.asarray(data["normal_load"].values, dtype=float)
        rubs = "shear_x" in data.variables
        names = ("pressure", "shear_x", "slip_x") if rubs else ("pressure",)
        remote = {str(name) for name in data.variables if "bulk_stress_" in str(name)}
        if any(np.any(data[name].values) for name in remote if not name.endswith("_xx")):
            raise NotJudged("the bulk stress has components beside xx")
        ends = ("bulk_stress_xx", "body2_bulk_stress_xx")
        x, cell = np.asarray(data["x"].values, dtype=float), float(data.attrs["cell_size"][0])
        edges = np.append(x - cell / 2, x[-1] + cell / 2)
        middles = {
            number: (np.asarray(data[f"cells_{number}_x"].values), np.asarray(data[f"cells_{number}_z"].values))
            for number in (1, 2)
            if f"cells_{number}_z" in data.variables
        }
        stored = StoredLine(
            name=str(data.attrs["name"]),
            text=str(data.attrs["scene"]),
            scene=line_scene(str(data.attrs["scene"]), edges, np.asarray(data["time"].values).tolist()),
            x=x,
            cell=cell,
            pitch=max(
                (float(np.diff(line).max()) for two in middles.values() for line in two if line.size > 1), default=0.0
            ),
            middles=middles,
            half_width=np.asarray(data["contact_radius"].values, dtype=float),
            load=load,
            force=np.asarray(data["tangential_load_x"].values, dtype=float) if rubs else 0 * load,
            bulk=np.stack([data[name].values if name in remote else 0 * load for name in ends]),
            place=np.asarray(data["travel_x"].values, dtype=float) if "travel_x" in data.variables else 0 * load,
            fields={name: np.asarray(data[name].values, dtype=float)[:, 0] for name in names},
            regions=[regions_at(data, at) for at in range(load.size)],
            strains=[
                StoredStrain(
                    body=number,
                    **{axis: np.asarray(data[f"cells_{number}_{axis}"].values, dtype=float) for axis in "xz"},
                    values=np.asarray(data[name].values[-1], dtype=float)[:, 0],
                )
                for number in (1, 2)
                if (name := f"equivalent_plastic_strain_{number}") in data.variables
            ],
        )
    if not load.max(initial=0.0) > 0:
        raise NotJudged("no step has a normal load")
    if np.any(np.abs(stored.force) > _SLIDES * stored.scene["friction"] * load):
        raise NotJudged("the contact is in gross slip, and the elements need a force below the limit of friction")
    return stored
