"""A run of a line contact in plain numbers: its bodies, gap, friction and loads per length; and what is not judged."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.bodies import NotJudged
from eigencontact_verification.audit.contact_scene import INCOMPRESSIBLE, body_law, profile_of, refuse
from eigencontact_verification.audit.stored import StoredRegion, regions_at

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

__all__ = ["StoredLine", "StoredStrain", "is_line", "line_scene", "read_line"]

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
    """What a run of a line contact stores over its steps.

    Attributes
    ----------
    name : str
        Of the scene.
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
    fields : dict of str to (steps, nx) float64
        ``"pressure"`` and, with friction, ``"shear_x"`` [Pa], ``"slip_x"`` [m].
    regions : list of list of StoredRegion
        Stress, by step.
    strains : list of StoredStrain
        Of bodies that yield.
    """

    name: str
    scene: dict[str, Any]
    x: FloatArray
    cell: float
    half_width: FloatArray
    load: FloatArray
    force: FloatArray
    bulk: FloatArray
    fields: dict[str, FloatArray]
    regions: list[list[StoredRegion]]
    strains: list[StoredStrain]

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
            raise NotJudged("it has no contact")
        load = np.asarray(data["normal_load"].values, dtype=float)
        rubs = "shear_x" in data.variables
        names = ("pressure", "shear_x", "slip_x") if rubs else ("pressure",)
        remote = {str(name) for name in data.variables if "bulk_stress_" in str(name)}
        if any(np.any(data[name].values) for name in remote if not name.endswith("_xx")):
            raise NotJudged("its bulk stress is not along x alone")
        ends = ("bulk_stress_xx", "body2_bulk_stress_xx")
        stored = StoredLine(
            name=str(data.attrs["name"]),
            scene=line_scene(str(data.attrs["scene"])),
            x=np.asarray(data["x"].values, dtype=float),
            cell=float(data.attrs["cell_size"][0]),
            half_width=np.asarray(data["contact_radius"].values, dtype=float),
            load=load,
            force=np.asarray(data["tangential_load_x"].values, dtype=float) if rubs else 0 * load,
            bulk=np.stack([data[name].values if name in remote else 0 * load for name in ends]),
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
        raise NotJudged("none of its steps has a load")
    if np.any(np.abs(stored.force) > _SLIDES * stored.scene["friction"] * load):
        raise NotJudged("it slides as a whole, and the elements hold the force")
    return stored


def line_scene(text: str) -> dict[str, Any]:
    """Scene of a run, as JSON allows.

    Parameters
    ----------
    text : str
        TOML.

    Returns
    -------
    dict
        ``bodies`` that deform (number, young_modulus, poisson_ratio, law), ``profile`` (see `ContactScene`) and
        ``friction``, the coefficient.

    Raises
    ------
    NotJudged
        It has what the elements have not.
    """
    from eigencontact.model.bodies import bodies_of
    from eigencontact.scene.components import build_component
    from eigencontact.scene.schema import Scene

    scene = Scene(**{**tomllib.loads(text), "stress": [], "observers": [], "fatigue": []})
    refuse(scene, line=True)
    if scene.inclusions or scene.eigenstrain:
        raise NotJudged("it has inclusions or eigenstrain, and the bodies of the elements have none")
    registry = scene.known_plugins()
    bodies = []
    for number, solid in enumerate(bodies_of(scene, registry), 1):
        table: Any = (scene.body1, scene.body2)[number - 1]
        if solid is None:
            continue
        material: Any = solid
        if hasattr(solid, "interfaces"):
            raise NotJudged(f"body {number} has layers, and the bodies of the elements have none")
        if material.poisson_ratio > INCOMPRESSIBLE:
            raise NotJudged(f"Poisson's ratio is {material.poisson_ratio:g}, and the elements need less than 0.5")
        if table.initial is not None:
            raise NotJudged(f"body {number} begins with the state of another run")
        law = body_law(registry, table.law, number, material)
        moduli = {"young_modulus": material.young_modulus, "poisson_ratio": material.poisson_ratio}
        bodies.append({"number": number, "law": law, **moduli})
    coefficient = 0.0
    if scene.friction is not None:
        friction: Any = build_component(registry, "friction-law", scene.friction, "friction")
        if friction.key != "coulomb":
            raise NotJudged(f"the elements have no friction {friction.key!r}")
        if bodies[0]["number"] != 1:
            raise NotJudged("body 1 is rigid, and the elements hold the shear on it")
        coefficient = float(friction.coefficient)
    profile = [profile_of(registry, table, 0.0) for table in scene.geometry]
    return {"bodies": bodies, "profile": profile, "friction": coefficient}
