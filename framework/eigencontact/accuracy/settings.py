"""Fidelities: settings of a scene that trade accuracy for time or memory, one entry each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import log2
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.changes import Changes, refined_grid
from eigencontact.model.whole_degrees import LEAST_DEGREE
from eigencontact.scene.numerics import MOST_REFINED
from eigencontact.scene.whole import HIGHEST_DEGREE

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["FIDELITIES", "Fidelity", "finer_settings", "finest", "resolution_by"]


#: Least error that a scene may allow whole inhomogeneities.
_LEAST_ALLOWED = 1e-8


@dataclass(frozen=True, kw_only=True, slots=True)
class Fidelity:
    """One setting that costs accuracy or time."""

    key: str  #: its name; the key of the scene where it is one setting
    applies: Callable[[Plan], bool]  #: whether it makes a difference in the scene of a plan
    alternatives: Callable[[Plan], Sequence[Any]]  #: values to compare with that of the scene
    #: Value of the reference, None where the scene has it; without one `finer` by the `stride` is the reference.
    finest: Callable[[Plan], Any] | None = None
    #: Value that divides the step size of the scene by about a factor; None where the scene states no such step size.
    finer: Callable[[Plan, float], Any] | None = None
    stride: float = 2.0  #: factor that shows in the results: a tolerance must fall further than cells
    table: str = "numerics"  #: table of the scene that the setting stands in
    unit: str = ""  #: unit of its value
    #: Changes of the scene by a value, where it is not one setting.
    changes: Callable[[Plan, Any], Changes] | None = None
    #: Part of a plan that it changes: where this part is that of the scene, there is nothing to solve.
    affected_part: Callable[[Plan], object] | None = None
    #: Whether the window of the scene stays, because an automatic window would follow the change.
    keeps_window: bool = False

    def of(self, plan: Plan, value: Any) -> Changes:
        """Changes that set a value."""
        return {self.table: {self.key: value}} if self.changes is None else self.changes(plan, value)

    def divided(self, plan: Plan, factor: float) -> Changes:
        """Changes that divide the step size by about a factor; empty if the scene has no step size."""
        value = None if self.finer is None else self.finer(plan, factor)
        return {} if value is None else self.of(plan, value)

    def reference(self, plan: Plan) -> Any:
        """Value of the reference; None if the scene has this value, or no step size."""
        if self.finest is not None:
            return self.finest(plan)
        return None if self.finer is None else self.finer(plan, self.stride)

    def words(self, value: Any) -> str:
        """Setting and value in words."""
        if value is None:
            return f"no {self.key}"
        if isinstance(value, Mapping):
            return f"{self.key} {', '.join(f'{name} = {entry}' for name, entry in value.items())}"
        return f"{self.key} {f'{value:.3g}' if isinstance(value, float) else value}{self.unit and f' {self.unit}'}"


def _other_choices(setting: str, choices: Sequence[str]) -> Callable[[Plan], list[str]]:
    """Choices of a setting of the numerics other than that of the scene."""
    return lambda plan: [choice for choice in choices if choice != getattr(plan.numerics, setting)]


def _coarser_values(value: float | None, *choices: float) -> list[float]:
    """Choices that are coarser than a value; all of them without a value."""
    return [choice for choice in choices if value is None or choice > value]


def _divided(value: Callable[[Plan], float | None], least: float) -> Callable[[Plan, float], float | None]:
    """Value divided by a factor, down to the smallest useful value; None if the scene has no value."""

    def finer(plan: Plan, factor: float) -> float | None:
        step_size = value(plan)
        return None if step_size is None else max(step_size / factor, min(least, step_size))

    return finer


def _has_inhomogeneities(plan: Plan) -> bool:
    return bool(plan.model.cells.inhomogeneities)


def _has_internal_variables(plan: Plan) -> bool:
    """Whether a law has internal variables."""
    return any(law.variables for law in plan.model.laws)


def _sources_in_cells(plan: Plan) -> list[Any]:
    """Sources in cells."""
    return [source for source in plan.model.sources if source.lattice is not None]


def _lattices(plan: Plan) -> list[Any]:
    return [source.lattice for source in plan.model.sources]


def _has_region_cells(plan: Plan) -> bool:
    """Whether a region has its own cells: a patch has layers, inhomogeneities share the columns of the grid."""
    from eigencontact.model.sources import Patch

    return any(not isinstance(source.shape, Patch) and source.material is None for source in _sources_in_cells(plan))


def _resolutions(plan: Plan) -> list[Any]:
    """Cells, one eigenstrain, and polynomials of two degrees if every shape has the potentials for them."""
    from eigencontact.halfspace.potentials import HasMomentPotentials

    degree_of_scene = getattr(plan.numerics.inclusion_resolution, "whole", None)
    cells: list[Any] = [] if degree_of_scene is None else ["cells"]
    polynomials = all(isinstance(source.shape, HasMomentPotentials) for source in plan.model.cells.inhomogeneities)
    degrees = (0, 2, 4) if polynomials else (0,)
    return cells + [{"whole": degree} for degree in degrees if degree != degree_of_scene]


def _precisions(plan: Plan) -> object:
    """Precisions of the operators."""
    if plan.numerics.precision != "auto":
        return {plan.numerics.precision}
    return {precision.chosen for precision in plan.precisions} or {"double"}


def _height(plan: Plan) -> float:
    """Height of the cells of inhomogeneities, the lowest [m]."""
    return min(float(source.lattice.edges[0]) for source in _sources_in_cells(plan) if source.material is not None)


def _half_space_is_free(plan: Plan) -> bool:
    """Whether the treatment of the half-space is free: an inhomogeneity and a periodic contact permit only one."""
    model = plan.model
    free = bool(model.sources) and not _has_inhomogeneities(plan) and not model.periodic
    return free and model.numerics.half_space in _SPACES


def _skips_cycles(plan: Plan) -> bool:
    """Whether the run skips wear cycles."""
    return plan.model.wear is not None and any(step.repeat > 3 for step in plan.scene.steps)


def _divisible(plan: Plan) -> bool:
    """Whether cells can be finer at inclusions of a body that yields, or are finer at any inclusions."""
    if plan.numerics.refinement > 1:
        return True
    members = plan.model.cells.inhomogeneities
    yielding, stiff = ({source.body for source in members if source.guessed is guessed} for guessed in (True, False))
    if not yielding & stiff:
        return False
    from eigencontact.execution.interiors.finer_cells import unsupported
    from eigencontact.execution.routes.subsurface import subsurfaces_of

    divided = [item for item in subsurfaces_of(plan.model) if item.inhomogeneities and item.in_cells]
    return all(unsupported(subsurface) is None for subsurface in divided)


def _larger_refinement(plan: Plan, factor: float) -> int | None:
    refinement = plan.numerics.refinement
    return None if refinement == MOST_REFINED else min(MOST_REFINED, int(factor * refinement + 0.5))


def _wears_layers(plan: Plan) -> bool:
    solids = plan.model.bodies.solids
    return any(getattr(solids[body - 1], "interfaces", ()) for body in plan.scene.losses)


def _expands_clouds(plan: Plan) -> bool:
    """Whether a field of whole regions is summed by expansions, or would be to a tolerance."""
    from math import prod

    from eigencontact.halfspace.cloud import is_large
    from eigencontact.model.regions import region_lattice

    whole = len(plan.model.sources) - len(_sources_in_cells(plan))
    points = [prod(region_lattice(request, plan.grid).shape) for request in plan.model.cells.requests]
    return whole > 0 and is_large(whole, max([plan.grid.nx * plan.grid.ny, *points]), 1e-6)


def _fewer_cycles(plan: Plan, factor: float) -> int | None:
    cycles = plan.scene.wear.cycles_per_update if plan.scene.wear else None
    return None if cycles is None else max(1, int(cycles / factor))


def _with_jump_error(_: Plan, value: float | None) -> Changes:
    return {"wear": {"jump-error": value, "cycles-per-update": None}}


def _jump_error(plan: Plan) -> float | None:
    return plan.scene.wear.error if plan.scene.wear else None


def _layer_error(plan: Plan) -> float | None:
    return plan.scene.wear.layer_error if plan.scene.wear else None


def resolution_by(plan: Plan, change: int) -> dict[str, Any] | None:
    """Resolution with the degree of whole inhomogeneities changed by `change`; None without whole inhomogeneities.

    If ``"auto"`` selects several degrees, the allowed error changes by the factor per degree of the inhomogeneity that
    converges fastest. All degrees then change by at least `change`, except those at the least degree.
    """
    wholes = [s.degree for s in plan.model.cells.inhomogeneities if s.degree is not None]
    resolution = plan.numerics.inclusion_resolution
    if not wholes or resolution == "cells":
        return None
    degrees = {whole.degree for whole in wholes}
    if len(degrees) == 1:
        return {"whole": min(HIGHEST_DEGREE, max(0, degrees.pop() + change))}
    allowed = resolution.allowed * min(whole.quality for whole in wholes if whole.degree > LEAST_DEGREE) ** change
    return {"whole": "auto", "error": min(max(allowed, _LEAST_ALLOWED), 0.5)}


def _higher_degree(plan: Plan, factor: float) -> dict[str, Any] | None:
    return resolution_by(plan, max(1, round(log2(factor))))


def _uniform_layers(plan: Plan) -> list[tuple[int, Any]]:
    """Layered bodies with uniform layers, and their numbers."""
    from eigencontact.plugin import LayeredMedium

    layered_bodies = []
    for number, body in enumerate(plan.model.bodies.solids, 1):
        if not isinstance(body, LayeredMedium) or not body.interfaces:
            continue
        tops, bottoms = (0.0, *body.interfaces), body.interfaces
        below_tops = [body.material_at(top) for top in tops]
        above_bottoms = [*(body.material_at(bottom, side="above") for bottom in bottoms), body.deep_material]
        if below_tops == above_bottoms:
            layered_bodies.append((number, body))
    return layered_bodies


def _in_cells(plan: Plan, value: str) -> Changes:
    """Layers of uniform constants as inclusions that fill the window."""
    if value != "cells":
        return {}
    resolved = plan.scene.resolved()
    inclusions: list[Any] = list(resolved.get("inclusions", []))
    changes: dict[str, Any] = {"inclusions": inclusions}
    for number, medium in _uniform_layers(plan):
        changes[f"body{number}"] = {"medium": None, **_constants(medium.deep_material)}
        tops = (0.0, *medium.interfaces[:-1])
        for name, top, bottom in zip(medium.layer_names, tops, medium.interfaces, strict=True):
            inclusions.append(
                {
                    "name": name.replace(" ", "-"),
                    "type": "cuboid",
                    "body": number,
                    "center": [*plan.grid.center, 0.5 * (top + bottom)],
                    "edges": [*plan.grid.size, bottom - top],
                    "material": _constants(medium.material_at(top)),
                }
            )
    return changes


def _constants(material: Any) -> dict[str, float]:
    return {"young-modulus": material.young_modulus, "poisson-ratio": material.poisson_ratio}


_SPACES = ("exact", "image-pressure", "periodic")
_COUPLINGS = ("full", "one-way", "partial", "none")

#: In the order of the table.
FIDELITIES: tuple[Fidelity, ...] = (
    Fidelity(
        key="precision",
        applies=lambda plan: (
            (bool(plan.scene.geometry) or bool(_sources_in_cells(plan))) and plan.numerics.precision != "single"
        ),
        alternatives=_other_choices("precision", ("double", "auto", "single")),
        finest=lambda _: "double",
        affected_part=_precisions,
    ),
    Fidelity(
        key="tolerance",
        applies=lambda plan: (
            (bool(plan.scene.geometry) or _has_inhomogeneities(plan)) and plan.numerics.tolerance < 1e-2
        ),
        alternatives=lambda plan: _coarser_values(plan.numerics.tolerance, 1e-4, 1e-2),
        finer=_divided(lambda plan: plan.numerics.tolerance, 1e-10),
        stride=10.0,
    ),
    Fidelity(
        key="coupling",
        applies=lambda plan: plan.scene.friction is not None,
        alternatives=_other_choices("coupling", _COUPLINGS),
        finest=lambda _: "full",
    ),
    Fidelity(
        key="half-space",
        applies=_half_space_is_free,
        alternatives=_other_choices("half_space", _SPACES),
        finest=lambda _: "exact",
    ),
    Fidelity(
        key="layers",
        applies=lambda plan: bool(_uniform_layers(plan)) and not plan.model.periodic,
        alternatives=lambda _: ["cells"],
        finest=lambda _: None,
        changes=_in_cells,
        keeps_window=True,
    ),
    Fidelity(
        key="inclusion-cells",
        applies=_has_region_cells,
        alternatives=lambda plan: sorted({max(1, plan.numerics.inclusion_cells // parts) for parts in (4, 2)}),
        finer=lambda plan, factor: round(factor * plan.numerics.inclusion_cells),
        affected_part=_lattices,
    ),
    Fidelity(
        key="inclusion-resolution",
        applies=lambda plan: _has_inhomogeneities(plan) and not _has_internal_variables(plan),
        alternatives=_resolutions,
        finest=lambda _: "cells",
        finer=_higher_degree,
        stride=4.0,
    ),
    Fidelity(
        key="inclusion-pitch",
        unit="m",
        applies=lambda plan: any(source.material is not None for source in _sources_in_cells(plan)),
        alternatives=lambda plan: [2.0 * _height(plan)],
        finest=lambda plan: 0.5 * _height(plan),
        finer=_divided(lambda plan: plan.numerics.inclusion_pitch, 0.0),
        affected_part=_lattices,
    ),
    Fidelity(
        key="inclusion-refinement",
        applies=_divisible,
        alternatives=lambda plan: [ratio for ratio in (1, 2) if ratio != plan.numerics.refinement],
        finer=_larger_refinement,
    ),
    Fidelity(
        key="cloud-tolerance",
        applies=_expands_clouds,
        alternatives=lambda plan: [0.0, *_coarser_values(plan.numerics.cloud_tolerance, 1e-4, 1e-2)],
        finest=lambda plan: min(1e-9, plan.numerics.cloud_tolerance),
        finer=_divided(lambda plan: plan.numerics.cloud_tolerance, 1e-12),
        stride=10.0,
    ),
    Fidelity(
        key="plastic-error",
        applies=_has_internal_variables,
        alternatives=lambda plan: _coarser_values(None, 0.03, 0.1) if plan.numerics.plastic_error is None else [None],
        finest=lambda plan: min(0.01, plan.numerics.plastic_error or 0.01),
        finer=_divided(lambda plan: plan.numerics.plastic_error, 1e-6),
        stride=4.0,
    ),
    Fidelity(
        key="jump-error",
        table="wear",
        applies=_skips_cycles,
        alternatives=lambda plan: _coarser_values(_jump_error(plan), 0.03, 0.1),
        finer=_divided(_jump_error, 1e-6),
        stride=4.0,
        changes=_with_jump_error,
    ),
    Fidelity(
        key="cycles-per-update",
        table="wear",
        applies=lambda plan: _skips_cycles(plan) and _jump_error(plan) is None,
        alternatives=lambda _: [],
        finer=_fewer_cycles,
        stride=4.0,
    ),
    Fidelity(
        key="layer-error",
        table="wear",
        applies=_wears_layers,
        alternatives=lambda plan: _coarser_values(_layer_error(plan), 0.2),
        finer=_divided(_layer_error, 1e-6),
        stride=4.0,
    ),
)


def finer_settings(plan: Plan) -> dict[str, Any]:
    """Changes that divide every step size except those of grid and load steps by the stride of its setting."""
    return _joined([setting.divided(plan, setting.stride) for setting in FIDELITIES if setting.applies(plan)])


def finest(plan: Plan, factor: float) -> tuple[dict[str, Any], list[str]]:
    """Changes to the finest of every setting and `factor` times the cells in each direction, with a description."""
    grid, resolution = refined_grid(plan, factor)
    references = [(setting, setting.reference(plan)) for setting in FIDELITIES if setting.applies(plan)]
    finer = [(setting, value) for setting, value in references if value is not None]
    changes = _joined([setting.of(plan, value) for setting, value in finer])
    return {**changes, "grid": grid}, [resolution, *(setting.words(value) for setting, value in finer)]


def _joined(changes_of_settings: Sequence[Changes]) -> dict[str, Any]:
    """Changes of several settings, table by table."""
    changes: dict[str, Any] = {}
    for changes_of_setting in changes_of_settings:
        for name, table in changes_of_setting.items():
            changes[name] = {**changes.get(name, {}), **table}
    return changes
