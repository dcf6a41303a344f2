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
    """Cells of the window: given by two of cells, size, spacing; or chosen from the size of the contact.

    Without a contact an automatic grid follows the inclusions: see `eigencontact.model.regions`. ``grid = "auto"`` is
    the grid without any key.

    A grid of infinite length makes a line contact in plane strain: its cells are strips along y, geometries count at
    y = 0, and loads, work and areas are per metre of the length.

    Parameters
    ----------
    cells : int or (int, int), optional
        Number of cells along x and y.
    size : float or (float, float), optional
        Extent of the window along x and y [m].
    spacing : float or (float, float), optional
        Edges of a cell along x and y [m].
    center : (float, float)
        Middle of the window [m].
    cells_per_contact_radius : float
        Of an automatic grid: cells from the middle of the largest contact to its edge, the nearer one.
    margin : float
        Of an automatic grid: extent of the window in extents of the largest contact.
    length : "infinite", optional
        Length of the contact along y. ``"infinite"`` makes a line contact; `cells`, `size` and `spacing` are then those
        along x.
    datum_depth : float, optional
        Of a line contact, and of a window that repeats along y alone: depth of the points in each body against which
        the surfaces move [m], by default the width of the window. Displacements have no limit far away there, so an
        approach needs this depth.
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
        """Cells of the kind that the table asks for: see `Grid.of`."""
        return Grid.of(nx, ny, dx, dy, center, line=self.line)

    @property
    def automatic(self) -> bool:
        """Whether the planner chooses the grid."""
        return self.cells is None and self.size is None


class Numerics(Table):
    """Fidelity and effort. The defaults are accurate.

    Parameters
    ----------
    half_space : {"exact", "full-space", "image-pressure", "periodic"}
        Treatment of the free surface in the fields of eigenstrain: ``"exact"``; ``"image-pressure"``, which frees the
        middles of the surface's cells; ``"periodic"``, where the window repeats; or ``"full-space"``, which leaves the
        surface out.
    inclusion_cells : int
        Cells along z across a region that has to be cut into cells: a shape without potentials, or an eigenstrain that
        is not uniform.
    inclusion_resolution : {"cells", "whole"} or Whole
        How an inhomogeneity is resolved: by ``"cells"``, each with an eigenstrain of its own; or as a whole with a
        polynomial, ``{ whole = 4 }`` or ``{ whole = "auto" }`` (balls and ellipsoids: more accurate than cells, and
        cheaper). ``"whole"`` is ``{ whole = 0 }``, one uniform eigenstrain (also of cuboids; for regions away from the
        surface and each other).
    inclusion_pitch : float, optional
        Height of those cells [m]; by default it follows the grid and the shapes.
    inclusion_refinement : int
        Divides the cells of a body at its inclusions, and two cells around them, so many times along each edge, where a
        law of the body is not linear: strain in thin layers beside a hard inclusion needs finer cells than the contact.
    law_room : float
        Room around the part of a body in which its law may be more than elastic, in sizes of that part: the cells fill
        both, and become more where that proves too little.
    boundary : {"non-periodic", "periodic", "periodic-y"}
        Whether the window stands alone on the half-space, repeats along x and y, or repeats along y alone. A pair
        such as ``["non-periodic", "periodic"]`` names the axes x and y.
    coupling : {"none", "partial", "one-way", "full"}
        Which displacements follow from which tractions in a contact with friction: ``"none"``, each along its own
        traction alone (what is never loaded or moved along the surface is left out); ``"partial"``, x and y with each
        other as well; ``"one-way"``, x and y by the pressure too (Goodman's approximation: the pressure does not feel
        the shear); ``"full"``, all. Eigenstrain, prescribed or plastic, is no elastic coupling: what it displaces along
        the surface makes the surfaces slip at every level.
    precision : {"double", "single", "auto"}
        Precision of transforms and of the fields that they are applied to. ``"auto"`` takes single in each operator
        whose round-off in it, measured when the scene is planned, is below the tolerance: half its memory, and up to
        half its time; `explain` says which and why. In ``"single"`` all are; not every tolerance can be reached then.
    tolerance : float
        Residual at which a solver ends, relative to the deflection or the stress that drives it.
    max_iterations : int
        Iterations after which a solver gives up and says so.
    threads : int, optional
        Threads of transforms and loops; as many as there are processors by default.
    plastic_error : float, optional
        Halves load steps in which cells flow until the whole and its halves differ by no more than this part of the
        strain (five times at most; ``plastic_error`` of a step tells what is left): three times the work of a step that
        is fine enough, none where nothing flows. Without it steps are those of the scene.
    cloud_tolerance : float
        Error allowed in the field of many inclusions at many points, relative to its largest value: what is far away is
        then summed by expansions. 0 sums all one by one.
    allow_contact_at_edge : bool
        Accepts a contact that reaches the edge of the window, where what is loaded outside is missing.
    allow_coarse : bool
        Accepts cells that cannot show a contact or a region inside a body; results then carry a warning.
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
        """Whether each cell of an inhomogeneity has an eigenstrain of its own."""
        return self.inclusion_resolution == "cells"

    @property
    def repeats_y(self) -> bool:
        """Whether the window repeats along y alone."""
        return self.boundary == "periodic-y"


class Output(Table):
    """What is written besides results and summary.

    Parameters
    ----------
    pictures : bool
        Pictures (PNG) of what was solved.
    vtk : bool
        Files for ParaView.
    tangential_displacement : bool
        The displacement of the surface along x and y of a contact without friction.
    history : {"last", "all"}
        What bodies remember is stored after the ``last`` step, or after ``all``: a region can then be looked at in any
        of them without solving again, and an animation shows what has yielded in each.
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
    """A contact, the field of eigenstrain, or both together.

    Parameters
    ----------
    name : str
        Short name, for folders: letters, digits, ``_``, ``.`` and ``-``, beginning with a letter, a digit or ``_``. By
        default that of the file, made into such a name.
    title : str
        One line for plots and lists.
    description : str
        What the scene shows, and where its numbers come from.
    plugins : list of files
        Python files with plugins of your own, used by this scene as if they were installed; they are run when it is
        planned.
    body1 : Body
        The half-space that z points into.
    body2 : Body
        The half-space above it, rigid by default; at least one of the two is elastic.
    geometry : list of tables or components
        Separations that add up; ``type`` names the geometry plugin. Without one there is no contact.
    friction : table or component, optional
        Friction law of the contact; ``type`` names the plugin. Without it the contact is frictionless.
    wear : Wear, optional
        Wear of sliding surfaces; ``type`` names the wear law.
    inclusions : list of Inclusion
        Regions with a prescribed eigenstrain; ``type`` names the inclusion shape.
    eigenstrain : list of EigenstrainPatch
        Eigenstrain that fills a patch of the window down to a depth; ``type`` names the eigenstrain field.
    grid : GridSpec
        Cells, or ``"auto"``.
    steps : list of Step
        Load history; one step by default where there is no contact.
    numerics : Numerics
        Fidelity and effort.
    stress : list of StressRequest
        Where fields below the surface are wanted.
    observers : list of tables or components
        What is written beside each step; ``type`` names the plugin.
    fatigue : list of FatigueRequest
        Fatigue criteria over a cycle of the run; ``type`` names the criterion.
    output : Output
        Files beside results and summary.
    accuracy : Accuracy, optional
        Errors that numbers may have: the run chooses cells, increments and tolerances.

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
        """Bulk stress [Pa] before the first step, by name, zero of components that steps alone give; empty without."""
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
        """Repeats of a cycle that will be solved: all where the surfaces lose nothing, else a guess."""
        return repeat if self.wear is None else self.wear.solved_cycles(repeat)

    def guesses_cycles(self, repeat: int) -> bool:
        """Whether the number of solved cycles is an estimate, because error control chooses it."""
        return self.wear is not None and self.wear.error is not None and self.solved_cycles(repeat) < repeat

    @property
    def folder(self) -> Path | None:
        """Folder that relative paths in the scene count from: that of its file; None where it came from none."""
        return self._folder

    def within(self, folder: Path | None) -> Scene:
        """Copy whose relative paths count from a folder; further copies keep it."""
        copy = self.model_copy()
        copy._folder = folder  # noqa: SLF001
        return copy

    def known_plugins(self, registry: Registry | None = None) -> Registry:
        """Plugins that the scene can name: those given, by default all that are installed, and those of its own files.

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
        """Return every field with its default filled in, SI units, TOML names, data files by absolute paths."""
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
