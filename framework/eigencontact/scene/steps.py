"""Steps of the load history in a scene: loads and motions, and impacts at drawn places."""

from __future__ import annotations

from random import Random
from typing import Annotated

from pydantic import AfterValidator, model_validator

from eigencontact.core.quantities import Angle, Force, Moment
from eigencontact.core.rigid_modes import NORMAL_MODES, TANGENTIAL_MODES
from eigencontact.scene.checks import at_least, finite, in_range, non_negative
from eigencontact.scene.holding import TRAVEL
from eigencontact.scene.table import FiniteLength, PositiveLength, Table

__all__ = ["Impacts", "Step", "each_impact"]


class Impacts(Table):
    """Random places of a rectangle around a middle at which a geometry is pressed on and lifted, one after the other.

    The places are drawn uniformly and depend on the seed alone; more of them begin with the same ones.
    """

    count: Annotated[int, AfterValidator(in_range(1, 1e5, "impacts"))]
    seed: Annotated[int, AfterValidator(at_least(0))] = 0
    size: tuple[PositiveLength, PositiveLength]
    center: tuple[FiniteLength, FiniteLength] = (0.0, 0.0)

    @property
    def places(self) -> list[tuple[float, float]]:
        """Places (x, y) [m]."""
        drawn = Random(self.seed)  # noqa: S311
        spans = tuple(zip(self.center, self.size, strict=True))
        return [
            (spans[0][0] + (drawn.random() - 0.5) * spans[0][1], spans[1][0] + (drawn.random() - 0.5) * spans[1][1])
            for _ in range(self.count)
        ]


def each_impact(steps: list[Step]) -> list[Step]:
    """Steps in which those with impacts are written out: moved there without load, loaded, unloaded."""
    return [single for step in steps for single in step.written_out()]


class Step(Table):
    """One piece of the load history: a linear ramp from the last state to the values given here.

    A contact is controlled by normal-load or approach. With friction, loads and motions along the surface are given
    beside them, those of body 2 against body 1, and what a step does not mention stays as an earlier step left it (see
    `eigencontact.scene.holding`). Without friction the geometry may roll along the surface: at the end of the step it
    has moved to (travel-x, travel-y). A scene without geometry has steps of `increments` alone, which are the times at
    which eigenstrain that changes with time is evaluated. A step with `impacts` stands for one of loading to its
    normal-load and one of unloading at each of their places.
    """

    normal_load: Annotated[Force, AfterValidator(non_negative("N"))] | None = None
    approach: FiniteLength | None = None
    moment_x: Annotated[Moment, AfterValidator(finite("N m"))] | None = None
    tilt_x: Annotated[Angle, AfterValidator(finite("rad"))] | None = None
    moment_y: Annotated[Moment, AfterValidator(finite("N m"))] | None = None
    tilt_y: Annotated[Angle, AfterValidator(finite("rad"))] | None = None
    tangential_load_x: Annotated[Force, AfterValidator(finite("N"))] | None = None
    shift_x: FiniteLength | None = None
    tangential_load_y: Annotated[Force, AfterValidator(finite("N"))] | None = None
    shift_y: FiniteLength | None = None
    torsion_moment: Annotated[Moment, AfterValidator(finite("N m"))] | None = None
    twist: Annotated[Angle, AfterValidator(finite("rad"))] | None = None
    travel_x: FiniteLength | None = None
    travel_y: FiniteLength | None = None
    increments: Annotated[int, AfterValidator(at_least(1))] = 1
    impacts: Impacts | None = None

    def written_out(self) -> list[Step]:
        """The step itself, or those of its impacts."""
        if self.impacts is None:
            return [self]
        out = []
        for x, y in self.impacts.places:
            away = Step(normal_load=0.0, travel_x=x, travel_y=y)
            if self.increments > 1:  # the ramp to the load would be one to the place as well
                out.append(away)
            pressed = away.model_copy(update={"normal_load": self.normal_load, "increments": self.increments})
            out += [pressed, away]
        return out

    @model_validator(mode="after")
    def _controlled(self) -> Step:
        if self.impacts is not None and (self.normal_load is None or len(self.prescribed) > 1):
            raise ValueError("given impacts and normal-load, and nothing else that loads or moves")
        for mode in (*NORMAL_MODES, *TANGENTIAL_MODES):
            if getattr(self, mode.force) is not None and getattr(self, mode.displacement) is not None:
                raise ValueError(f"controlled by {mode.force} or {mode.displacement}, not both".replace("_", "-"))
        return self

    @property
    def prescribed(self) -> list[str]:
        """Names of the loads and motions given, as written in a scene."""
        modes = (*NORMAL_MODES, *TANGENTIAL_MODES)
        names = [*(name for mode in modes for name in (mode.force, mode.displacement)), *TRAVEL]
        return [name.replace("_", "-") for name in names if getattr(self, name) is not None]
