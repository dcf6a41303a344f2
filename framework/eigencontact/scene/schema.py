"""The scene: everything that defines a computation, as a Python object and as a TOML file with the same fields.

Field names are snake_case in Python and kebab-case in TOML. Numbers are SI; text may carry a unit (``"105 um"``).
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError, model_validator

from eigencontact.core.bulk import BULK_NAMES, IN_PLANE
from eigencontact.core.grid import Grid
from eigencontact.core.quantities import DataFile, loads_per_length
from eigencontact.core.units import LARGEST
from eigencontact.errors import SceneError
from eigencontact.hooks.files import with_files
from eigencontact.hooks.registry import Registry
from eigencontact.scene.accuracy import Accuracy
from eigencontact.scene.as_tables import with_tables
from eigencontact.scene.body import Body
from eigencontact.scene.checks import (
    at_least,
    both_alike,
    boundary_of_axes,
    folder_name,
    in_range,
    non_negative,
    one_or_many,
    printable,
    refuse_deep,
)
from eigencontact.scene.contents import check_contents
from eigencontact.scene.fatigue import FatigueRequest
from eigencontact.scene.inclusions import EigenstrainPatch, Inclusion
from eigencontact.scene.labels import labels_in_messages
from eigencontact.scene.messages import explain_error, find_unknown
from eigencontact.scene.plain import plain
from eigencontact.scene.regions import StressRequest
from eigencontact.scene.steps import Impacts, Step, each_impact, ramps_of
from eigencontact.scene.table import Also, FiniteLength, OfKind, PositiveLength, Table, Tables
from eigencontact.scene.wear import Wear
from eigencontact.scene.whole import Whole, uniform_or_given

__all__ = ["Body", "GridSpec", "Impacts", "Numerics", "Output", "Scene", "Step", "StressRequest"]


class GridSpec(Table):
    """Cells of the window: two of cells, size and spacing, or an automatic grid by the size of the contact.

    Without a contact an automatic grid follows the inclusions: see `eigencontact.model.regions`. ``grid = "auto"`` is
    the grid without any key.

    A grid of infinite length makes a line contact in plane strain: its cells are strips along y, geometries contribute
    their profile at y = 0, and loads, work and areas are per metre of the length.

    Parameters
    ----------
    cells : int or (int, int), optional
        Number of cells along x and y.
    size : float or (float, float), optional
        Extent of the window along x and y [m].
    spacing : float or (float, float), optional
        Edges of a cell along x and y [m].
    center : (float, float)
        Centre of the window [m].
    cells_per_contact_radius : float
        Automatic grid: cells from the centre of the largest contact to the nearest point of its edge.
    margin : float
        Automatic grid: extent of the window relative to the extent of the largest contact.
    length : "infinite", optional
        Length of the contact along y. ``"infinite"`` makes a line contact; `cells`, `size` and `spacing` are then those
        along x.
    datum_depth : float, optional
        Datum depth [m] of a line contact, and of a window that is periodic along y only: displacements are relative to
        the points of each body at this depth, by default the width of the window. Displacements grow without limit with
        the distance there, so a prescribed approach needs this depth.
    """

    cells: Annotated[tuple[int, int] | None, BeforeValidator(both_alike)] = None
    size: Annotated[tuple[PositiveLength, PositiveLength] | None, BeforeValidator(both_alike)] = None
    spacing: Annotated[tuple[PositiveLength, PositiveLength] | None, BeforeValidator(both_alike)] = None
    center: tuple[FiniteLength, FiniteLength] = (0.0, 0.0)
    cells_per_contact_radius: Annotated[float, AfterValidator(at_least(1.0))] = 32.0
    margin: Annotated[float, AfterValidator(at_least(1.0))] = 1.5
    length: Literal["infinite"] | None = None
    datum_depth: PositiveLength | None = None

    @model_validator(mode="before")
    @classmethod
    def _auto(cls, value: Any) -> Any:
        if value == "auto":
            return {}
        return value

    @model_validator(mode="after")
    def _determined(self) -> GridSpec:
        sizes = [name for name in ("cells", "size", "spacing") if getattr(self, name) is not None]
        if sizes and len(sizes) != 2:
            raise ValueError(f"two of cells, size, spacing, or none of them for an automatic grid; given: {sizes}")
        if self.cells is not None and min(self.cells) < 1:
            raise ValueError("of at least 1 cell each way")
        if self.cells is not None and max(self.cells) > LARGEST:
            raise ValueError(f"of at most {LARGEST:g} cells each way")
        if self.line:
            pairs = {name: getattr(self, name) for name in ("cells", "size", "spacing")}
            wrong = next((name for name, pair in pairs.items() if pair is not None and pair[0] != pair[1]), None)
            if wrong is not None:
                raise ValueError(f"of one value of {wrong}, that along x, with length = 'infinite'")
            if self.center[1] != 0.0:
                raise ValueError("centred at y = 0 with length = 'infinite'")
        return self

    @property
    def line(self) -> bool:
        """Whether the cells are strips without end along y."""
        return self.length is not None

    def with_cells(self, nx: int, ny: int, dx: float, dy: float, center: tuple[float, float]) -> Grid:
        """Grid of the kind that the table selects: see `Grid.of`."""
        return Grid.of(nx, ny, dx, dy, center, line=self.line)

    @property
    def automatic(self) -> bool:
        """Whether the planner chooses the grid."""
        return self.cells is None and self.size is None


class Numerics(Table):
    """Numerical settings: accuracy, time and memory. The defaults are accurate.

    Parameters
    ----------
    half_space : {"exact", "full-space", "image-pressure", "periodic"}
        Treatment of the free surface in the fields of eigenstrain. ``"exact"``: closed forms. ``"image-pressure"``:
        a pressure makes the centres of the surface cells free of normal stress. ``"periodic"``: the window repeats.
        ``"full-space"``: no surface.
    inclusion_cells : int
        Cells along z across a region that the program divides into cells: a shape without potentials, or an eigenstrain
        that is not uniform.
    inclusion_resolution : {"cells", "whole"} or Whole
        Discretisation of an inhomogeneity. ``"cells"``: one eigenstrain per cell. ``{ whole = 4 }`` or ``{ whole =
        "auto" }``: one polynomial eigenstrain for the whole region (spheres and ellipsoids; more accurate than cells,
        and cheaper). ``"whole"`` is ``{ whole = 0 }``, one uniform eigenstrain (also for cuboids; for regions far from
        the surface and from each other).
    inclusion_pitch : float, optional
        Height of the cells of inhomogeneities [m]; by default it follows the grid and the shapes.
    inclusion_refinement : int
        Divides the cells of a body at its inclusions, and two cells around them, this many times along each edge. For
        bodies with a law that is not linear: strain in thin layers around a hard inclusion needs finer cells than the
        contact.
    law_room : float
        Margin of the box of cells around the part of a body that may exceed its elastic range, in sizes of this part.
        The program adds cells if the box is too small.
    boundary : {"non-periodic", "periodic", "periodic-y"}
        Boundary of the window: a single window on the half-space, periodic along x and y, or periodic along y only. A
        pair such as ``["non-periodic", "periodic"]`` sets the axes x and y.
    coupling : {"none", "partial", "one-way", "full"}
        Displacements by tractions in a contact with friction. ``"none"``: each displacement by the traction in its own
        direction (directions without load and motion are left out). ``"partial"``: also x by y and y by x.
        ``"one-way"``: also x and y by the pressure (Goodman's approximation: the shear has no effect on the pressure).
        ``"full"``: all. Every level includes the tangential displacement by prescribed and plastic eigenstrain.
    precision : {"double", "single", "auto"}
        Precision of transforms and their fields. ``"auto"`` uses single precision in each operator whose round-off,
        measured when the scene is planned, is below the tolerance; this saves half of the memory and up to half of the
        time, and `explain` lists the choice with the reason. ``"single"`` uses it in all operators; some tolerances are
        then out of reach.
    tolerance : float
        Residual at which a solver ends, relative to the deflection or the stress that drives it.
    max_iterations : int
        Largest number of iterations of a solver; the run fails if it exceeds this number.
    threads : int, optional
        Threads of transforms and loops; the number of processors by default.
    plastic_error : float, optional
        Largest difference in strain between a load step and its two halves. The program halves load steps in which
        cells yield until the difference is within this fraction (five times at most; ``plastic_error`` of a step is the
        remaining difference). The check costs three times the work of a step, and nothing in elastic steps. Without
        this key the steps are those of the scene.
    cloud_tolerance : float
        Error allowed in the field of many inclusions at many points, relative to its largest value: the program sums
        distant inclusions by expansions. 0 sums all inclusions one by one.
    allow_contact_at_edge : bool
        Accepts a contact that reaches the edge of the window; tractions outside the window are then missing.
    allow_coarse : bool
        Accepts cells that are too coarse for the contact or for a region inside a body; the results then have a
        warning.
    """

    half_space: Literal["exact", "full-space", "image-pressure", "periodic"] = "exact"
    inclusion_cells: Annotated[int, AfterValidator(at_least(1))] = 16
    inclusion_resolution: Annotated[Literal["cells"] | Whole, BeforeValidator(uniform_or_given)] = "cells"
    inclusion_pitch: PositiveLength | None = None
    inclusion_refinement: Annotated[int, AfterValidator(in_range(1, 8, "finer cells along an edge"))] = 1
    law_room: Annotated[float, AfterValidator(non_negative("sizes of what yields"))] = 0.1
    boundary: Annotated[Literal["non-periodic", "periodic", "periodic-y"], BeforeValidator(boundary_of_axes)] = (
        "non-periodic"
    )
    coupling: Literal["none", "partial", "one-way", "full"] = "full"
    precision: Literal["double", "single", "auto"] = "double"
    tolerance: Annotated[float, AfterValidator(in_range(1e-13, 0.1, "[-]"))] = 1e-6
    max_iterations: Annotated[int, AfterValidator(at_least(1))] = 500
    threads: Annotated[int, AfterValidator(in_range(1, 1024, "threads"))] | None = None
    plastic_error: Annotated[float, AfterValidator(in_range(1e-6, 1.0, "[-]"))] | None = None
    cloud_tolerance: Annotated[float, AfterValidator(in_range(0.0, 0.01, "[-]"))] = 1e-6
    allow_contact_at_edge: bool = False
    allow_coarse: bool = False

    @property
    def in_cells(self) -> bool:
        """Whether each cell of an inhomogeneity has its own eigenstrain."""
        return self.inclusion_resolution == "cells"

    @property
    def repeats_y(self) -> bool:
        """Whether the window is periodic along y only."""
        return self.boundary == "periodic-y"

    @property
    def repeated_axes(self) -> tuple[int, ...]:
        """Axes (0 for x, 1 for y) along which the window repeats."""
        return {"periodic": (0, 1), "periodic-y": (1,)}.get(self.boundary, ())


class Output(Table):
    """Output in addition to results and summary.

    Parameters
    ----------
    pictures : bool
        Pictures (PNG) of the solution.
    vtk : bool
        Files for ParaView.
    tangential_displacement : bool
        Surface displacement along x and y of a contact without friction.
    history : {"last", "all"}
        Steps with stored internal variables of the bodies: the ``last`` step, or ``all`` steps. With ``all`` the
        program can compute regions at any step without a new solution, and an animation shows the yielded zone at each
        step.
    errors : bool
        Estimated error of every number and field, from coarser runs of the scene; they take about as long as the run
        itself.
    animation : bool or {"gif", "mp4"}
        Animation of a history of several steps: a GIF, or an MP4 where the program ffmpeg is installed.
    """

    pictures: bool = True
    vtk: bool = False
    tangential_displacement: bool = False
    history: Literal["last", "all"] = "last"
    errors: bool = False
    animation: Literal[False, True, "gif", "mp4"] = False


class Scene(Table):
    """A contact, the field of an eigenstrain, or both.

    Parameters
    ----------
    name : str
        Short name, for folders: letters, digits, ``_``, ``.`` and ``-``; the first character is a letter, a digit or
        ``_``. By default it is made from the name of the file.
    title : str
        One line for plots and lists.
    description : str
        Purpose of the scene, and sources of its numbers.
    plugins : list of files
        Python files with your own plugins for this scene; the program executes them when it plans the scene.
    body1 : Body
        Lower half-space; z points into it.
    body2 : Body
        Upper half-space, rigid by default; at least one of the two bodies is elastic.
    geometry : list of tables or components
        Separations of the surfaces, which add up; ``type`` names the geometry plugin. A scene without geometry has no
        contact.
    friction : table or component, optional
        Friction law of the contact; ``type`` names the plugin. Without it the contact is frictionless.
    wear : Wear, optional
        Wear of sliding surfaces; ``type`` names the wear law.
    inclusions : list of Inclusion
        Regions with an eigenstrain or another material; ``type`` names the inclusion shape.
    eigenstrain : list of EigenstrainPatch
        Eigenstrain in a patch of the window down to a depth; ``type`` names the eigenstrain field.
    grid : GridSpec
        Cells, or ``"auto"``.
    steps : list of Step
        Load history; one step by default if there is no contact.
    numerics : Numerics
        Numerical settings: accuracy, time and memory.
    stress : list of StressRequest
        Regions of points with stored fields below the surface.
    observers : list of tables or components
        Additional numbers of each step; ``type`` names the plugin.
    fatigue : list of FatigueRequest
        Fatigue criteria over a cycle of the run; ``type`` names the criterion.
    output : Output
        Output in addition to results and summary.
    accuracy : Accuracy, optional
        Largest errors of the results: the program chooses cells, increments and tolerances.

    Examples
    --------
    >>> scene = Scene(
    ...     body1={"young_modulus": "210 GPa", "poisson_ratio": 0.3},
    ...     body2={"rigid": True},
    ...     geometry={"type": "sphere", "radius": "105 um"},
    ...     steps={"normal_load": "0.65 N"},
    ... )
    >>> scene.body1.young_modulus
    210000000000.0
    """

    name: Annotated[str, AfterValidator(folder_name)] = ""
    title: Annotated[str, AfterValidator(printable)] = ""
    description: Annotated[str, AfterValidator(printable)] = ""
    plugins: Annotated[list[DataFile], BeforeValidator(one_or_many)] = Field([])
    body1: Body
    body2: Body = Body(rigid=True)
    geometry: Annotated[Tables, OfKind("geometry")] = Field([])
    friction: Annotated[dict[str, Any] | None, OfKind("friction-law")] = None
    wear: Wear | None = None
    inclusions: Annotated[list[Inclusion], BeforeValidator(one_or_many)] = Field([])
    eigenstrain: Annotated[list[EigenstrainPatch], BeforeValidator(one_or_many)] = Field([])
    grid: Annotated[GridSpec, Also("auto")] = GridSpec()
    steps: Annotated[list[Step], BeforeValidator(one_or_many), Field(min_length=1), AfterValidator(each_impact)] = (
        Field([Step()])
    )
    numerics: Numerics = Numerics()
    stress: Annotated[list[StressRequest], BeforeValidator(one_or_many)] = Field([])
    observers: Annotated[Tables, OfKind("observer")] = Field([])
    fatigue: Annotated[list[FatigueRequest], BeforeValidator(one_or_many)] = Field([])
    output: Output = Output()
    accuracy: Accuracy | None = None

    @model_validator(mode="after")
    def _consistent(self) -> Scene:
        if self.body1.rigid and self.body2.rigid:
            raise ValueError(
                "!body1 and body2 must not both be rigid; give one of them young-modulus and poisson-ratio"
            )
        check_contents(self)
        return self

    def __init__(self, **data: Any) -> None:
        refuse_deep(data)
        data = plain(data)
        try:
            with loads_per_length(line=_is_line(data.get("grid"))):
                super().__init__(**with_tables(type(self), data))
        except ValidationError as problem:
            with labels_in_messages(data):
                find_unknown(data, type(self))
                errors = problem.errors()
                more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
                raise SceneError(explain_error(_as_written(errors[0], data), "").lstrip("!") + more) from None

    _folder: Path | None = None

    @property
    def ramps(self) -> list[Step]:
        """Plain steps of the load history in order, those of each cycle once."""
        return ramps_of(self.steps)

    @property
    def bulk_at_rest(self) -> dict[str, float]:
        """Bulk stress [Pa] before the first step, by name, zero for components that only steps have; else empty."""
        tables = {
            name: getattr(table, component)
            for body, names in BULK_NAMES.items()
            if (table := self.bodies[body - 1].bulk_stress) is not None
            for name, component in zip(names, IN_PLANE, strict=True)
        }
        ramped = {name for ramp in self.ramps for name in ramp.bulk}
        every = [name for names in BULK_NAMES.values() for name in names]
        return {name: tables.get(name, 0.0) for name in every if name in ramped or tables.get(name, 0.0)}

    @property
    def losses(self) -> dict[int, float]:
        """Share of the worn depth of each body that wears."""
        return {} if self.wear is None else self.wear.parts

    def solved_cycles(self, repeat: int) -> int:
        """Number of solved repeats of a cycle: all if the surfaces do not wear, else an estimate."""
        return repeat if self.wear is None else self.wear.solved_cycles(repeat)

    def guesses_cycles(self, repeat: int) -> bool:
        """Whether the number of solved cycles is an estimate, because the error control chooses it."""
        return self.wear is not None and self.wear.error is not None and self.solved_cycles(repeat) < repeat

    @property
    def folder(self) -> Path | None:
        """Folder of relative paths in the scene: that of its file; None without a file."""
        return self._folder

    def within(self, folder: Path | None) -> Scene:
        """Copy with relative paths from a folder; further copies keep it."""
        copy = self.model_copy()
        copy._folder = folder  # noqa: SLF001
        return copy

    def known_plugins(self, registry: Registry | None = None) -> Registry:
        """Plugins available to the scene: an argument, by default all installed ones, and those of its own files.

        Raises
        ------
        PluginError
            A file in ``plugins`` that cannot be used; says which line of it, and why.
        """
        from eigencontact.scene.installed import installed_plugins

        return with_files(installed_plugins() if registry is None else registry, self.plugin_files)

    @property
    def plugin_files(self) -> list[Path]:
        """Files in ``plugins``, from the folder of the scene."""
        return [Path(name) if self.folder is None else self.folder / name for name in self.plugins]

    @property
    def label(self) -> str:
        """Name for folders and headings: `name`, or the title's first words."""
        words = "".join(letter.lower() if letter.isalnum() else " " for letter in self.title).split()
        return self.name or "-".join(words[:6]) or "scene"

    @property
    def bodies(self) -> tuple[Body, Body]:
        """Tables of body 1 and body 2."""
        return self.body1, self.body2

    def resolved(self) -> dict[str, Any]:
        """Return all fields with defaults, SI units, TOML names, and absolute paths of data files."""
        scene = self
        if self.folder is not None:
            from eigencontact.scene.files import anchored

            scene, _ = anchored(self, self.known_plugins())
        tables = scene.model_dump(mode="json", by_alias=True, exclude_none=True)
        for request in tables["stress"]:
            if not request["name"]:  # made of shape and body, and no valid name of a scene
                del request["name"]
        return tables


def _is_line(grid: Any) -> bool:
    """Whether the table of a grid, checked or not, is that of a line contact."""
    length = grid.get("length") if isinstance(grid, dict) else getattr(grid, "length", None)
    return length is not None


def _as_written(error: Any, data: dict[str, Any]) -> dict[str, Any]:
    """Remove the array index 0 from a finding where the scene has a single table in place of an array."""
    place = tuple(error["loc"])
    if len(place) > 1 and place[1] == 0 and isinstance(data.get(place[0]), dict):
        place = (place[0], *place[2:])
    return {**error, "loc": place}
