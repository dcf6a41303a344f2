"""The scene: everything that defines a computation, as a Python object and as a TOML file with the same fields.

Field names are snake_case in Python and kebab-case in TOML. Numbers are SI; text may carry a unit (``"105 um"``).
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError, model_validator

from eigencontact.core.bulk import BULK_NAMES, IN_PLANE
from eigencontact.core.quantities import DataFile, loads_per_length
from eigencontact.errors import SceneError
from eigencontact.hooks.files import with_files
from eigencontact.hooks.registry import Registry
from eigencontact.scene.accuracy import Accuracy
from eigencontact.scene.as_tables import with_tables
from eigencontact.scene.body import Body
from eigencontact.scene.checks import (
    folder_name,
    one_or_many,
    printable,
    refuse_deep,
)
from eigencontact.scene.contents import check_contents
from eigencontact.scene.fatigue import FatigueRequest
from eigencontact.scene.inclusions import EigenstrainPatch, Inclusion
from eigencontact.scene.labels import labels_in_messages
from eigencontact.scene.messages import explain_error, find_unknown
from eigencontact.scene.numerics import GridSpec, Numerics
from eigencontact.scene.plain import plain
from eigencontact.scene.regions import StressRequest
from eigencontact.scene.steps import Impacts, Step, each_impact, ramps_of
from eigencontact.scene.table import Also, OfKind, Table, Tables
from eigencontact.scene.wear import Wear

__all__ = ["Body", "GridSpec", "Impacts", "Numerics", "Output", "Scene", "Step", "StressRequest"]


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
        bulk_names = [name for names in BULK_NAMES.values() for name in names]
        return {name: tables.get(name, 0.0) for name in bulk_names if name in ramped or tables.get(name, 0.0)}

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
