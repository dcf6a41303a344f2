"""Records of one accepted load step for storage, pictures and observers."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.core.numbers import Number
from eigencontact.results.borders import LineBorders, Section

__all__ = ["FACT_NAME", "HistoryRecord", "RegionRecord", "RunInfo", "StepRecord"]

FloatArray = NDArray[np.float64]

#: Characters of the name before each fact of a plan in words; spaces where a line continues the one before it.
FACT_NAME = 12


@dataclass(frozen=True, kw_only=True, slots=True)
class RegionRecord:
    """Fields below the surface at the points of one region.

    Attributes
    ----------
    name : str
        Name given in the scene, unique; a valid NetCDF name.
    shape : str
        ``"plane"``, ``"volume"``, ``"line"`` or ``"points"``.
    body : int
        1 or 2; z points into that body.
    dims : tuple of str
        Dimensions of the fields without the component: ``("z", "x")`` for a plane normal to y, ``("z", "y", "x")``
        for a volume, ``("y", "x")`` for a plane of constant depth, ``("point",)`` for lines and points.
    coords : mapping
        Coordinates x, y, z [m]: arrays along the dimension of their name (or along ``point``), or single numbers.
    fields : mapping
        ``stress (6, ...)`` [Pa] and ``strain (6, ...)``, plain tensor components in the order xx, yy, zz, yz, xz, xy;
        ``displacement (3, ...)`` [m]; ``von_mises (...)``, ``tresca``, ``hydrostatic``, ``principal (3, ...)`` [Pa];
        those that were asked for.
    note : str
        What must be known of the values, in words, or nothing.
    mean_above : float
        Depth [m] above which the stress by tractions is a mean over each cell; 0 where none is.
    """

    name: str
    shape: str
    body: int
    dims: tuple[str, ...]
    coords: dict[str, FloatArray | float]
    fields: dict[str, FloatArray]
    note: str = ""
    mean_above: float = 0.0


@dataclass(frozen=True, kw_only=True, slots=True)
class HistoryRecord:
    """History field of a body.

    Attributes
    ----------
    name : str
        Unique; a valid NetCDF name.
    body : int
        1 or 2.
    values : (components, nz, ny, nx), (1, ny, nx), (components, n) or (components, densities, n)
        In the cells of a box, of the surface, or of n inclusions, there per density of a polynomial; six components are
        a Mandel vector.
    coords : mapping
        Centres of the cells [m] along ``"z"``, ``"y"``, ``"x"``, in this order, the same for all of a body; those of
        the window along ``"y"``, ``"x"`` alone; empty where the values belong to inclusions.
    unit, meaning : str
        SI unit, and in words.
    finer : bool
        Whether the cells are the finer ones at the inclusions of a body, which have coordinates of their own.
    """

    name: str
    body: int
    values: FloatArray
    coords: dict[str, FloatArray]
    unit: str
    meaning: str
    finer: bool = False


@dataclass(frozen=True, kw_only=True, slots=True)
class StepRecord:
    """One accepted step.

    Attributes
    ----------
    index : int
        From 1.
    time : float
        Position in the load history: 1.0 is the end of the first ``[[steps]]`` table, 1.5 half-way through the second.
    scalars : mapping of str to float
        ``normal_load`` [N], ``approach`` [m], ``tilt_x``, ``tilt_y`` [rad], ``moment_x``, ``moment_y`` [N m],
        ``contact_area``, ``contact_area_counted`` [m^2], ``contact_radius`` [m], ``max_pressure`` [Pa],
        ``iterations``, ``convolutions``, ``solve_seconds``, ``gap_residual`` [-], ``penetration_residual`` [-],
        ``load_residual`` [-] of a contact; with stresses ``max_von_mises`` [Pa] and ``max_von_mises_depth`` [m]; with
        eigenstrain ``max_uplift`` and ``max_sink`` [m] of the surface; with friction the loads, motions, zones and
        residuals along the surface (`RunInfo.numbers` declares them).
    fields : mapping of str to (ny, nx) array
        Surface fields by quantity name (`eigencontact.core.quantities.QUANTITIES`); among them
        ``reference_pressure`` where the geometry has a closed form for this step, ``homogeneous_pressure`` where it has
        one without what makes the bodies inhomogeneous: layers, inclusions, eigenstrain.
    regions : mapping of str to RegionRecord
        Sub-surface fields by region name.
    observed : mapping of str to float
        What observers returned, as ``"<observer>_<name>"``.
    history : mapping of str to HistoryRecord
        What the bodies remember, by name.
    """

    index: int
    time: float
    scalars: dict[str, float]
    fields: dict[str, FloatArray]
    regions: dict[str, RegionRecord] = field(default_factory=dict)
    observed: dict[str, float] = field(default_factory=dict)
    history: dict[str, HistoryRecord] = field(default_factory=dict)

    def without_arrays(self) -> StepRecord:
        """Numbers of the step without its fields, whose memory can be released after storage."""
        return replace(self, fields={}, regions={}, history={})

    def row(self) -> dict[str, float]:
        """All numbers of the step by name."""
        return {"step": self.index, "time": self.time, **self.scalars, **self.observed}


@dataclass(frozen=True, kw_only=True)
class RunInfo:
    """Data that all steps of a run share.

    Attributes
    ----------
    title, name : str
        Of the scene.
    grid : Grid
        Grid of the surface fields.
    scene_toml : str
        The scene with every default filled in, SI units.
    scene_hash : str
        SHA-256 of it; a resumed run must have the same.
    versions : mapping of str to str
        Packages (python, numpy, scipy, eigencontact ...) and plugin packages.
    references : tuple of str
        Sources to cite for what this run used.
    contact_modulus : float or None
        E* [Pa]; None without a contact, and for layered bodies, which have none.
    steps : int
        Number of load steps of the whole history.
    outlines : mapping of str to (n, 2, 2) array
        Line segments [m] around the inclusions for pictures: ``""`` as seen from above, others on the plane region of
        their name.
    inclusions : tuple of mapping
        Name, plugin, body, bounds [m] and material of every region with eigenstrain or constants of its own.
    layers : mapping of str to sequence of mapping
        Name, top and bottom [m] of the layers of each layered body, by its number.
    exposed : tuple of str
        Names of the materials that can come to the surface, by number; empty where ``exposed_material`` is not stored.
    sections : tuple of Section
        Borders of inclusions on the planes that pictures cut.
    lines : mapping of str to LineBorders
        Inclusions at the points of line regions, by region.
    cycles : tuple of (float, int, int)
        Cycles of the load history: where a table of them begins, in load steps, ramps of a cycle, repetitions.
    sliding : tuple of float
        Path [m] that the surfaces slid before the first ramp and at the end of each; empty where they do not.
    prestrained : bool
        Whether eigenstrain of the scene moves the surfaces before they are loaded.
    every_history : bool
        Whether what bodies remember is kept after every step, not after the last alone.
    numbers : mapping of str to Number
        Declarations of the scalars of a step, in the order of the blocks that compute them.
    observed : mapping of str to Number
        Declarations of what observers return; a number without one has an unknown unit.
    precisions : mapping of str to str
        Precision of each operator, where the scene leaves it to the plan.
    plan : mapping
        The plan in words, by paragraph: what ``explain`` says of the run.
    """

    title: str
    name: str
    grid: Grid
    scene_toml: str
    scene_hash: str
    versions: dict[str, str]
    references: tuple[str, ...]
    contact_modulus: float | None
    steps: int
    outlines: dict[str, FloatArray] = field(default_factory=dict)
    inclusions: tuple[dict[str, Any], ...] = ()
    layers: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    exposed: tuple[str, ...] = ()
    sections: tuple[Section, ...] = ()
    lines: dict[str, LineBorders] = field(default_factory=dict)
    cycles: tuple[tuple[float, int, int], ...] = ()
    sliding: tuple[float, ...] = ()
    prestrained: bool = False
    every_history: bool = False
    numbers: dict[str, Number] = field(default_factory=dict)
    observed: dict[str, Number] = field(default_factory=dict)
    precisions: dict[str, str] = field(default_factory=dict)
    plan: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def texts(self) -> dict[str, str]:
        """Tables as JSON by the name of the attribute of a results file, without empty ones; written once for a run."""
        tables = {
            "precisions": self.precisions, "inclusions": self.inclusions, "layers": self.layers,
            "exposed_materials": self.exposed,
        }  # fmt: skip
        return {
            "versions": json.dumps(self.versions, sort_keys=True),
            **({"plan": json.dumps(self.plan, ensure_ascii=False)} if self.plan else {}),
            **{name: json.dumps(table) for name, table in tables.items() if table},
        }
