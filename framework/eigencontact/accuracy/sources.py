"""Sources of numerical error of a run, and coarser discretisations of each source."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from numpy.typing import NDArray

from eigencontact.accuracy.changes import Changes, refined_steps, refined_window
from eigencontact.accuracy.points import cell_sizes, half_distances, has_points, places_of_edges
from eigencontact.accuracy.settings import FIDELITIES, resolution_by

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["EDGES", "SOURCES", "ErrorSource", "Variation", "error_sources", "without_overlap"]

#: Edges of coarser cells relative to the run. Measured on random scenes: with 1.5 and 2, which cost more, bars of the
#: same width hold less often; 2 and 3 need wider bars.
_COARSER = (2.0, 2.5)
#: Largest ratio of the increments of a coarser run to those of the run with half of them, for an order of both.
_QUARTER = 0.75
#: Least factor by which a degree more is taken to lower an error.
_SLOWEST = 1.1
#: Lowest order of an error that the program keeps below a setting: it may be far below, and fall more slowly.
_ADAPTIVE = 0.5
#: Tolerance of the solvers up to which its error is no part of the bars: ten times 1e-6 changed the numbers of random
#: scenes by at most 2.3 % of their bars (see the page on error bars), at the price of one more run.
_TIGHT = 1e-6
#: Sources whose step size is the edges of cells along x and y, and along z where the scene gives this edge.
EDGES = ("cells", "cells along z")
_SETTINGS = {setting.key: setting for setting in FIDELITIES}
#: Error of a number or of a field.
Error = TypeVar("Error", float, NDArray[Any])


@dataclass(frozen=True, kw_only=True, slots=True)
class Variation:
    """One coarser discretisation."""

    changes: Changes  #: changes of the scene's tables
    ratio: float  #: its step size in step sizes of the scene (cell edge, increment, tolerance); below 1 it is finer


@dataclass(frozen=True, kw_only=True, slots=True)
class ErrorSource:
    """Source of discretisation error.

    Attributes
    ----------
    name : str
        In ``summary.json`` and on the console.
    lowest, highest : float
        Orders between which the error is known to fall with the step size.
    applies : callable
        Whether the run of a plan has this source.
    variations : callable
        Plan to variations, the nearest to the scene first; none where the error follows from the plan.
    known_errors : callable, optional
        Plan and summary of the run to errors that need no other run, by number. Where a variation also gives an error,
        the larger one counts.
    is_least_error : bool
        Whether its error is the smallest that a number can have: it counts only in a number that no other source
        changes. Smaller cells lower it.
    finer : callable, optional
        Plan and a factor to the changes that divide the step size by about this factor; None where none can.
    stride : float
        Factor that shows in the results: a tolerance must fall further than cells.
    on_coarse : bool
        Whether it is varied on the coarse cells of the source ``"cells"``, where a run costs a fraction.
    sparing : bool
        Whether its second variation is made only where the first one is a notable part of an error bar.
    of_cells : bool
        Whether its step size is a fraction of the edges of all cells: the errors of the sources `EDGES` contain its
        error, and cells that are finer everywhere lower it. See `without_overlap`.
    """

    name: str
    applies: Callable[[Plan], bool]
    variations: Callable[[Plan], Sequence[Variation]] = lambda _: ()
    known_errors: Callable[[Plan, Mapping[str, Any]], Mapping[str, float]] | None = None
    finer: Callable[[Plan, float], Changes] | None = None
    stride: float = 2.0
    lowest: float = 1.0
    highest: float = 2.0
    on_coarse: bool = True
    is_least_error: bool = False
    sparing: bool = False
    of_cells: bool = False


def error_sources(plan: Plan) -> list[ErrorSource]:
    """Sources of error in the run of a plan, in the order of their variation."""
    return [source for source in SOURCES if source.applies(plan)]


def without_overlap(errors: Mapping[str, Error]) -> dict[str, Error]:
    """Errors by source, where an error that two sources have counts once.

    Cells that are larger everywhere are larger at inclusions too, so that the error of all cells contains the error of
    the cells at inclusions. Only the rest belongs to the cells elsewhere. Larger cells with a larger division would
    have the same edges at inclusions, but their margin of two cells has more finer cells than that of the run.

    Examples
    --------
    >>> without_overlap({"cells": 5.0, "cells at inclusions": 3.0})
    {'cells': 2.0, 'cells at inclusions': 3.0}
    >>> without_overlap({"cells": 2.0, "cells at inclusions": 3.0})
    {'cells': 0.0, 'cells at inclusions': 3.0}
    >>> without_overlap({"cells": 5.0, "cells along z": 10.0, "cells at inclusions": 3.0})
    {'cells': 4.0, 'cells along z': 8.0, 'cells at inclusions': 3.0}
    """
    out = dict(errors)
    within = [errors[source.name] for source in SOURCES if source.of_cells and source.name in errors]
    edges = [name for name in EDGES if name in errors]
    if within and edges:
        total = sum(errors[name] for name in edges)
        excess = total - sum(within)
        share = 0.5 * (excess + abs(excess)) / (total + (total == 0.0))
        out |= {name: errors[name] * share for name in edges}
    return out


def _cells(plan: Plan) -> list[Variation]:
    """Cells 2 and 2.5 times larger in the same window; coarse cells are accepted."""
    numerics = {"allow-coarse": True}
    return [
        Variation(
            changes={"grid": refined_window(plan, 1.0 / ratio, keep_parity=True)[0], "numerics": numerics}, ratio=ratio
        )
        for ratio in _COARSER
    ]


def _finer_cells(plan: Plan, factor: float) -> Changes:
    return {"grid": refined_window(plan, factor, keep_parity=True)[0]}


def _has_path(plan: Plan) -> bool:
    """Whether a state depends on the path of the loads: friction, wear, a law with memory."""
    scene = plan.scene
    has_memory = any(law.variables for law in plan.model.laws)
    return scene.friction is not None or scene.wear is not None or has_memory


def _increments(plan: Plan) -> list[Variation]:
    """Half the increments and a quarter; twice as many where steps have too few for that."""
    tables = plan.scene.resolved()["steps"]
    half, quarter, double = (refined_steps(tables, factor) for factor in (0.5, 0.25, 2.0))
    second = quarter if quarter[1] <= _QUARTER * half[1] else double
    choices = [double] if half[1] == 1.0 else [half, second]
    return [Variation(changes={"steps": steps}, ratio=1.0 / ratio) for steps, ratio in choices]


def _more_increments(plan: Plan, factor: float) -> Changes:
    return {"steps": refined_steps(plan.scene.resolved()["steps"], factor)[0]}


def _of_setting(key: str, value: Callable[[Plan], Any], ratio: float) -> Callable[[Plan], list[Variation]]:
    """Variation of one setting of the scene."""

    def variations(plan: Plan) -> list[Variation]:
        return [Variation(changes=_SETTINGS[key].of(plan, value(plan)), ratio=ratio)]

    return variations


def _finer(key: str) -> dict[str, Any]:
    """Finer variation of one setting, and its stride."""
    return {"finer": _SETTINGS[key].divided, "stride": _SETTINGS[key].stride}


def _applies(key: str) -> Callable[[Plan], bool]:
    return _SETTINGS[key].applies


def _has_pitch(plan: Plan) -> bool:
    """Whether the height of the cells of inhomogeneities does not follow the grid."""
    return plan.numerics.inclusion_pitch is not None and _SETTINGS["inclusion-pitch"].applies(plan)


def _other_refinement(plan: Plan) -> list[Variation]:
    """Half of the division of cells at inclusions; twice the division where it cannot be less, which costs more."""
    refinement = plan.numerics.refinement
    alternative = refinement // 2 or 2
    return [Variation(changes={"numerics": {"inclusion-refinement": alternative}}, ratio=refinement / alternative)]


def _lower_degree(plan: Plan) -> list[Variation]:
    """One degree less; the ratio is the factor per degree of the inhomogeneity that converges most slowly."""
    slowest = max(s.degree.quality for s in plan.model.cells.inhomogeneities if s.degree is not None)
    ratio = min(2.0, max(_SLOWEST, 1.0 / slowest)) if slowest > 0.0 else 2.0
    return [Variation(changes={"numerics": {"inclusion-resolution": resolution_by(plan, -1)}}, ratio=ratio)]


def _has_degree(plan: Plan) -> bool:
    """Whether some whole inhomogeneity has a degree that can be lower."""
    return any(source.degree is not None and source.degree.degree > 0 for source in plan.model.cells.inhomogeneities)


def _fewer_jumps(plan: Plan, factor: float) -> Changes:
    """Setting of the jumps over cycles with fewer skipped cycles."""
    changes = _SETTINGS["jump-error"].divided(plan, factor)
    return changes or _SETTINGS["cycles-per-update"].divided(plan, factor)


def _jumps(plan: Plan) -> list[Variation]:
    """Twice the error that a jump over cycles may have, or jumps over twice the cycles."""
    wear = plan.scene.wear
    assert wear is not None
    if wear.error is None:
        assert wear.cycles_per_update is not None
        return [Variation(changes={"wear": {"cycles-per-update": 2 * wear.cycles_per_update}}, ratio=2.0)]
    return [Variation(changes={"wear": {"jump-error": min(1.0, 2.0 * wear.error)}}, ratio=2.0)]


def _by_jumps(_: Plan, summary: Mapping[str, Any]) -> dict[str, float]:
    """Errors by jumps that the run itself estimates.

    The worn depth of a jump is integrated to a part of `jump-error` in 1, 2, 4, ... sub-steps: twice the setting may
    leave their number as it is, and then shows nothing.
    """
    relative = summary["wear_error"] - abs(summary["update_error"])
    return {name: relative * abs(summary[name]) for name in ("worn_volume", "wear_energy")}


def _layer_error(plan: Plan) -> float:
    assert plan.scene.wear is not None
    return plan.scene.wear.layer_error


def _plastic_error(plan: Plan) -> float:
    return plan.numerics.plastic_error or 0.0


def _pitch(plan: Plan) -> float:
    return plan.numerics.inclusion_pitch or 0.0


def _expands_clouds(plan: Plan) -> bool:
    return plan.numerics.cloud_tolerance > 0.0 and _SETTINGS["cloud-tolerance"].applies(plan)


SOURCES: tuple[ErrorSource, ...] = (
    ErrorSource(
        name="cells",
        applies=lambda _: True,
        variations=_cells,
        known_errors=places_of_edges,
        finer=_finer_cells,
        on_coarse=False,
    ),
    ErrorSource(name="points of regions", applies=has_points, known_errors=half_distances, on_coarse=False),
    ErrorSource(
        name="size of a cell",
        applies=lambda plan: bool(plan.scene.geometry),
        known_errors=cell_sizes,
        on_coarse=False,
        is_least_error=True,
    ),
    ErrorSource(
        name="load steps",
        applies=_has_path,
        variations=_increments,
        finer=_more_increments,
        highest=1.0,
        sparing=True,
    ),
    ErrorSource(
        name="cells along z",
        applies=_has_pitch,
        variations=_of_setting("inclusion-pitch", lambda plan: 1.5 * _pitch(plan), 1.5),
        **_finer("inclusion-pitch"),
    ),
    ErrorSource(
        name="cells at inclusions",
        applies=_applies("inclusion-refinement"),
        variations=_other_refinement,
        **_finer("inclusion-refinement"),
        highest=1.0,
        of_cells=True,
    ),
    ErrorSource(
        name="cells of regions",
        applies=_applies("inclusion-cells"),
        variations=_of_setting("inclusion-cells", lambda plan: max(1, plan.numerics.inclusion_cells // 2), 2.0),
        **_finer("inclusion-cells"),
    ),
    ErrorSource(
        name="degree",
        applies=_has_degree,
        variations=_lower_degree,
        **_finer("inclusion-resolution"),
    ),
    ErrorSource(
        name="plastic-error",
        applies=lambda plan: plan.numerics.plastic_error is not None,
        variations=_of_setting("plastic-error", lambda plan: min(1.0, 2.0 * _plastic_error(plan)), 2.0),
        **_finer("plastic-error"),
        lowest=_ADAPTIVE,
    ),
    ErrorSource(
        name="jumps over cycles",
        applies=_applies("jump-error"),
        variations=_jumps,
        known_errors=_by_jumps,
        finer=_fewer_jumps,
        stride=_SETTINGS["jump-error"].stride,
        lowest=_ADAPTIVE,
    ),
    ErrorSource(
        name="layer-error",
        applies=_applies("layer-error"),
        variations=_of_setting("layer-error", lambda plan: min(1.0, 2.0 * _layer_error(plan)), 2.0),
        **_finer("layer-error"),
        lowest=_ADAPTIVE,
    ),
    ErrorSource(
        name="cloud-tolerance",
        applies=_expands_clouds,
        variations=_of_setting("cloud-tolerance", lambda plan: min(0.01, 10.0 * plan.numerics.cloud_tolerance), 10.0),
        **_finer("cloud-tolerance"),
    ),
    ErrorSource(
        name="tolerance",
        applies=lambda plan: plan.numerics.tolerance > _TIGHT and _SETTINGS["tolerance"].applies(plan),
        variations=_of_setting("tolerance", lambda plan: min(0.1, 10.0 * plan.numerics.tolerance), 10.0),
        **_finer("tolerance"),
    ),
)
