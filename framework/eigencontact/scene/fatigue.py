"""Fatigue tables of a scene: criterion, region, cycle, critical distance, Wöhler curve."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field, ValidationError

from eigencontact.core.woehler import WoehlerCurve
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.scene.checks import at_least, positive
from eigencontact.scene.messages import explain_error, find_unknown
from eigencontact.scene.steps import expected_points
from eigencontact.scene.table import ComponentTable, PositiveLength, Table

__all__ = ["CriticalDistance", "FatigueRequest", "Life", "elastic_constants"]

#: Steps of the shortest closed cycle: there, back, and its end (`eigencontact.results.cycles`).
_SHORTEST = 4
#: Keys of a body beside its constants that leave it elastic and of one material.
_ELASTIC = ("rigid", "bulk-stress")


def _probability(value: float) -> float:
    if not 0.0 < value < 1.0:
        raise ValueError("between 0 and 1 [-]")
    return value


def _cycle(value: Any) -> Any:
    words = ("last", "all")
    if isinstance(value, str) and value not in words:
        raise ValueError(f"'last', 'all' or the numbers of its first and last step{nearest(value, words)}")
    return value


class Life(Table):
    """Wöhler curve relative to the limit of the criterion; see `eigencontact.core.woehler`.

    Parameters
    ----------
    slope : float
        Exponent k of cycles to failure ``N = knee-cycles (amplitude / limit amplitude)^-k`` above the limit.
    knee_cycles : float
        Cycles at the limit amplitude.
    scatter : float
        Ratio of the amplitudes at which 90 % and 10 % of the components fail; 1 without scatter.
    failure_probability : float
        Fraction of the components that fails within the cycles of the results.
    """

    slope: Annotated[float, AfterValidator(positive("-"))]
    knee_cycles: Annotated[float, AfterValidator(positive("-"))]
    scatter: Annotated[float, AfterValidator(at_least(1.0))] = 1.0
    failure_probability: Annotated[float, AfterValidator(_probability)] = 0.5

    @property
    def curve(self) -> WoehlerCurve:
        """The curve."""
        return WoehlerCurve(slope=self.slope, knee_cycles=self.knee_cycles, scatter=self.scatter)


class CriticalDistance(Table):
    """Evaluation of a criterion near the hot spot: value at a critical distance, and life.

    Parameters
    ----------
    distance : float, optional
        Critical distance L of the material [m]: the program also evaluates the value near the hot spot by the `method`.
    method : {"point", "line", "volume"}
        Value at L/2 below the hot spot; mean down to 2 L below it; mean over the part of the body within the radius
        L around it.
    life : Life, optional
        Wöhler curve for the value at the critical distance if there is a `distance`, else for the value at the hot
        spot.
    """

    distance: PositiveLength | None = None
    method: Literal["point", "line", "volume"] = "point"
    life: Life | None = None

    @classmethod
    def of(cls, **values: Any) -> CriticalDistance:
        """Table from the arguments of a call, without those that are None.

        Raises
        ------
        SceneError
            Names the argument, the rule and the value.
        """
        given_values = {name: value for name, value in values.items() if value is not None}
        try:
            return cls(**given_values)
        except ValidationError as problem:
            if isinstance(life := values.get("life"), Mapping):
                find_unknown(dict(life), Life, "life")
            raise SceneError(explain_error(problem.errors()[0], "")) from None


class FatigueRequest(CriticalDistance, ComponentTable):
    """Fatigue criterion for one cycle of the run: ``type`` names the criterion; its fields are keys of the same table.

    The program evaluates it after the last step. An amplitude is half of a range.

    Attributes
    ----------
    name : str, optional
        Name in results and pictures, different from the others; by default the key of the criterion.
    region : str, optional
        Stress region with the evaluated points; by default the only one.
    cycle : {"last", "all"} or (int, int)
        The last closed cycle of the load history, all steps, or the numbers of the first and last step.
    """

    kind: ClassVar[str] = "fatigue-criterion"

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")] | None = None
    region: str | None = None
    cycle: Annotated[str | tuple[int, int], AfterValidator(_cycle)] = "last"

    @property
    def label(self) -> str:
        """Name in results."""
        return self.name or self.type.rpartition(":")[2].replace("-", "_")

    def region_in(self, scene: Any) -> Any:
        """Stress region of the scene with its name."""
        stored = [request for request in scene.stress if "stress" in request.fields]
        labels = [request.label for request in stored]
        if self.region is None and len(stored) == 1:
            return stored[0]
        if self.region not in labels:
            listed = ", ".join(map(repr, labels)) or "none; add [[stress]]"
            hint = nearest(self.region, labels) if self.region else ""
            raise ValueError(f"!fatigue.region must name one with stress: {listed} (got {shown(self.region)}){hint}")
        return stored[labels.index(self.region)]

    def check_in(self, scene: Any) -> None:
        """Require a region with stress, the cycle, and a unique name; see `ComponentTable.check_in`."""
        region = self.region_in(scene)
        labels = [request.label for request in scene.fatigue]
        if labels.count(self.label) > 1:
            raise ValueError(f"!fatigue tables must have different names (got {self.label!r} twice); set name")
        total = expected_points(scene.steps, scene.solved_cycles)
        steps = f"this run has {total} step{'s' if total > 1 else ''}"
        if self.cycle == "last" and not any(step.cycle for step in scene.steps) and total < _SHORTEST:
            raise ValueError(
                f"!fatigue.cycle must be given where the load history has no closed cycle (got 'last', and {steps}); "
                "say 'all', or give [[steps]] a cycle"
            )
        if isinstance(self.cycle, tuple) and not 1 <= self.cycle[0] < self.cycle[1] <= total:
            raise ValueError(
                f"!fatigue.cycle must be two numbers of steps, the first before the last, from 1 on (got "
                f"{shown(list(self.cycle))}, and {steps})"
            )
        if self.distance is None:
            return
        if self.method == "volume" and region.shape != "volume":
            raise ValueError(
                f"!fatigue.region must be of shape 'volume' for method = 'volume' (got {region.label!r}, a "
                f'{region.shape}); ask for a volume, or set method = "line"'
            )
        if region.shape != "volume" and (region.shape != "plane" or region.normal == "z"):
            raise ValueError(
                f"!fatigue.distance must be given with a region along z, an upright plane or a volume (got "
                f"{region.label!r}); leave it out"
            )


def elastic_constants(body: Mapping[str, Any], materials: Iterable[str], region: str) -> tuple[float, float]:
    """Young's modulus and Poisson's ratio of an elastic body of one material.

    Parameters
    ----------
    body : mapping
        Its table of a scene, in SI units.
    beside : iterable of str
        What else makes it inhomogeneous.
    region : str
        Region whose strain follows from them.

    Raises
    ------
    SceneError
        Another body: the region must store its strain.
    """
    table = {name.replace("_", "-"): value for name, value in body.items()}
    names = ("young-modulus", "poisson-ratio")
    causes = [*(name for name in table if name not in (*names, *_ELASTIC)), *materials]
    if causes or not all(isinstance(table.get(name), int | float) for name in names):
        raise SceneError(
            f"region {region!r} must store its strain where the body is not elastic and of one material (got "
            f'{", ".join(causes) or "a body without constants"}); run with fields = ["stress", "strain"] in its table'
        )
    return float(table[names[0]]), float(table[names[1]])
