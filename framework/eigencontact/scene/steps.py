"""Steps of the load history in a scene: loads and motions, cycles, and impacts at random places."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from random import Random
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, model_validator

from eigencontact.core.bulk import BULK_NAMES
from eigencontact.core.quantities import Angle, Force, Moment
from eigencontact.core.rigid_modes import NORMAL_MODES, TANGENTIAL_MODES
from eigencontact.scene.body import FiniteStress
from eigencontact.scene.checks import at_least, both_alike, finite, in_range, non_negative, one_or_many
from eigencontact.scene.holding import TRAVEL
from eigencontact.scene.table import FiniteLength, PositiveLength, Table

__all__ = [
    "MOST_CYCLES",
    "Impacts",
    "Segment",
    "Step",
    "each_impact",
    "expected_points",
    "named_ramps",
    "ramps_of",
    "segments_of",
]

#: Repeats of one cycle.
MOST_CYCLES = 10**9


class Impacts(Table):
    """Impacts at random places of a rectangle: the geometry is loaded and unloaded at one place after the other.

    The places are uniformly distributed and depend only on the seed; a larger `count` adds places at the end.

    Parameters
    ----------
    count : int
        Number of places.
    seed : int
        Seed of the random numbers.
    size : float or (float, float)
        Edges of the rectangle along x and y [m].
    center : (float, float)
        Centre of the rectangle [m].
    """

    count: Annotated[int, AfterValidator(in_range(1, 1e5, "impacts"))]
    seed: Annotated[int, AfterValidator(at_least(0))] = 0
    size: Annotated[tuple[PositiveLength, PositiveLength], BeforeValidator(both_alike)]
    center: tuple[FiniteLength, FiniteLength] = (0.0, 0.0)

    @property
    def places(self) -> list[tuple[float, float]]:
        """Places (x, y) [m]."""
        generator = Random(self.seed)  # noqa: S311
        spans = tuple(zip(self.center, self.size, strict=True))
        return [
            (
                spans[0][0] + (generator.random() - 0.5) * spans[0][1],
                spans[1][0] + (generator.random() - 0.5) * spans[1][1],
            )
            for _ in range(self.count)
        ]


def each_impact(steps: list[Step]) -> list[Step]:
    """Steps with impacts as plain steps: motion without load, loading, unloading."""
    return [single for step in steps for single in step.written_out()]


def _checked_steps(steps: Any) -> Any:
    if steps is not None and not steps:
        raise ValueError("one step or more")
    return steps


class Step(Table):
    """Load step: a linear ramp from the last state to the values of this table.

    Either normal-load or approach controls a contact. With friction, a step also has loads and motions along the
    surface, of body 2 relative to body 1; a value that a step does not mention keeps its last value (see
    `eigencontact.scene.holding`). Without friction the geometry may roll along the surface: its position at the end of
    the step is (travel-x, travel-y). A scene without geometry has steps of `increments` only, the times at which it
    evaluates an eigenstrain that changes with time. A step with `impacts` stands for two steps at each place: loading
    to normal-load, and unloading.

    A step with a `cycle` is a list of steps that is repeated `repeat` times, and prescribes nothing else. If the
    contact wears, the program does not solve every cycle: see `eigencontact.scene.wear`.

    In a step with `sliding_distance` the whole contact slides along this path, which is not resolved: shift-x does not
    contain the motion, and the shear is that of the end, along `sliding_direction`, for a motion of body 2 in the
    positive direction; ``"circular"`` ends along x.

    Parameters
    ----------
    normal_load : float, optional
        Normal force at the end of the step [N]; for a periodic window the force on one window.
    approach : float, optional
        Approach of the bodies [m].
    moment_x, moment_y : float, optional
        Moment of the pressure about the x or y axis through the centre of the window [N m].
    tilt_x, tilt_y : float, optional
        Rotation about the x or y axis [rad].
    tangential_load_x, tangential_load_y : float, optional
        Tangential force of body 2 on body 1 along x or y [N].
    shift_x, shift_y : float, optional
        Tangential displacement of body 2 relative to body 1 along x or y [m]. It makes the surfaces slip, and the
        contact stays at its place: a shift should be small compared with the contact radius. `travel_x` and `travel_y`
        move the contact.
    torsion_moment : float, optional
        Moment of body 2 on body 1 about the z axis [N m].
    twist : float, optional
        Rotation about the z axis [rad].
    travel_x, travel_y : float, optional
        Position of the geometry along x or y at the end of the step [m].
    sliding_distance : float, optional
        Sliding path of the whole contact in this step [m].
    sliding_direction : {"x", "y", "circular"}, optional
        Direction of this path; x by default.
    bulk_stress_xx, bulk_stress_yy, bulk_stress_xy : float, optional
        Bulk stress of body 1 at the end of the step [Pa]; see `eigencontact.scene.body.BulkStress`. It acts with and
        without friction and contact, and keeps its last value if a step does not mention it.
    body2_bulk_stress_xx, body2_bulk_stress_yy, body2_bulk_stress_xy : float, optional
        Bulk stress of body 2 [Pa].
    increments : int
        Number of increments of the ramp.
    spacing : {"radius", "even"}, optional
        Spacing of the increments: even in the contact radius, or even in the loads and motions. The default is even in
        the radius for a step with friction that increases only the normal load or the approach, if the gap rises on all
        sides of one point, because a cell that comes into contact within an increment sticks at once. All other steps
        are even in the loads.
    impacts : Impacts, optional
        Random places at which the geometry is loaded and unloaded.
    cycle : list of Step, optional
        Steps of a cycle, in place of all other keys.
    repeat : int
        Number of cycles.
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
    sliding_distance: PositiveLength | None = None
    sliding_direction: Literal["x", "y", "circular"] | None = None
    bulk_stress_xx: FiniteStress | None = None
    bulk_stress_yy: FiniteStress | None = None
    bulk_stress_xy: FiniteStress | None = None
    body2_bulk_stress_xx: FiniteStress | None = None
    body2_bulk_stress_yy: FiniteStress | None = None
    body2_bulk_stress_xy: FiniteStress | None = None
    increments: Annotated[int, AfterValidator(at_least(1))] = 1
    spacing: Literal["radius", "even"] | None = None
    impacts: Impacts | None = None
    cycle: Annotated[list[Step] | None, BeforeValidator(one_or_many), AfterValidator(_checked_steps)] = None
    repeat: Annotated[int, AfterValidator(in_range(1, MOST_CYCLES, "cycles"))] = 1

    def written_out(self) -> list[Step]:
        """Replace impacts by their single steps, also within a cycle; return other steps unchanged."""
        if self.cycle is not None:
            return [self.model_copy(update={"cycle": each_impact(self.cycle)})]
        if self.impacts is None:
            return [self]
        out = []
        for x, y in self.impacts.places:
            away = Step(normal_load=0.0, travel_x=x, travel_y=y)
            if self.increments > 1:  # the ramp to the load would be one to the place as well
                out.append(away)
            loading = {"normal_load": self.normal_load, "increments": self.increments, "spacing": self.spacing}
            pressed = away.model_copy(update=loading)
            out += [pressed, away]
        return out

    @model_validator(mode="after")
    def _controlled(self) -> Step:
        if self.cycle is not None:
            defaults = {name: field.default for name, field in type(self).model_fields.items()}
            settings = sorted(name for name in defaults if getattr(self, name) != defaults[name])
            settings = [name for name in settings if name not in ("cycle", "repeat")]
            if settings:
                raise ValueError(f"a cycle and nothing else but repeat: leave out {settings[0].replace('_', '-')}")
            if any(step.cycle is not None for step in self.cycle):
                raise ValueError("a cycle of plain steps: a cycle inside another must be written out")
        elif self.repeat != 1:
            raise ValueError("given a cycle beside repeat: cycle = [{ ... }], or leave repeat out")
        if self.sliding_direction is not None and self.sliding_distance is None:
            raise ValueError("given a sliding-distance beside sliding-direction")
        if self.impacts is not None and (self.normal_load is None or len(self.prescribed) > 1 or self.bulk):
            raise ValueError("given impacts and normal-load, and nothing else that loads or moves")
        for mode in (*NORMAL_MODES, *TANGENTIAL_MODES):
            if getattr(self, mode.force) is not None and getattr(self, mode.displacement) is not None:
                raise ValueError(f"controlled by {mode.force} or {mode.displacement}, not both".replace("_", "-"))
        return self

    @property
    def travels(self) -> bool:
        """Whether the geometry moves along the surface."""
        return self.travel_x is not None or self.travel_y is not None

    @property
    def slides(self) -> bool:
        """Whether the surfaces slide all over the contact: by a distance, or as the geometry moves."""
        return self.sliding_distance is not None or self.travels

    @property
    def bulk(self) -> dict[str, float]:
        """Prescribed bulk stress at the end of the step [Pa], by name."""
        names = (name for names in BULK_NAMES.values() for name in names)
        return {name: value for name in names if (value := getattr(self, name)) is not None}

    @property
    def prescribed(self) -> list[str]:
        """Names of the prescribed loads and motions, as written in a scene."""
        modes = (*NORMAL_MODES, *TANGENTIAL_MODES)
        names = [*(name for mode in modes for name in (mode.force, mode.displacement)), *TRAVEL]
        return [name.replace("_", "-") for name in names if getattr(self, name) is not None]


@dataclass(frozen=True, slots=True)
class Segment:
    """Part of the load history that the run repeats as a whole.

    Attributes
    ----------
    first : int
        Number of its first ramp.
    ramps : int
        Number of its ramps.
    repeat : int
        Number of repetitions.
    cycle : bool
        True if the scene defines it as a cycle.
    """

    first: int
    ramps: int
    repeat: int
    cycle: bool


def ramps_of(steps: Sequence[Step]) -> list[Step]:
    """Plain steps in order, those of each cycle once.

    Examples
    --------
    >>> there_and_back = Step(cycle=[{"shift-x": 1e-6}, {"shift-x": 0.0}], repeat=50)
    >>> [ramp.shift_x for ramp in ramps_of([Step(normal_load=1.0), there_and_back])]
    [None, 1e-06, 0.0]
    """
    return [ramp for step in steps for ramp in ([step] if step.cycle is None else step.cycle)]


def named_ramps(steps: Sequence[Step], *, again: bool = False) -> list[tuple[str, Step]]:
    """Ramps of `ramps_of` with their names in a scene; with `again`, each repeated cycle occurs twice.

    Examples
    --------
    >>> [name for name, _ in named_ramps([Step(normal_load=1.0), Step(cycle=[{"shift-x": 1e-6}], repeat=50)])]
    ['steps.0', 'steps.1.cycle.0']
    """
    out = []
    for number, step in enumerate(steps):
        name = "steps" if len(steps) == 1 else f"steps.{number}"
        if step.cycle is None:
            out.append((name, step))
            continue
        cycle_ramps = [(f"{name}.cycle.{place}", ramp) for place, ramp in enumerate(step.cycle)]
        out += cycle_ramps * (2 if again and step.repeat > 1 else 1)
    return out


def segments_of(steps: Sequence[Step]) -> list[Segment]:
    """Plain steps, and cycles, by their place among the ramps of `ramps_of`."""
    segments, first = list[Segment](), 0
    for step in steps:
        count = 1 if step.cycle is None else len(step.cycle)
        segments.append(Segment(first, count, step.repeat, step.cycle is not None))
        first += count
    return segments


def expected_points(steps: Sequence[Step], solved_cycles: Callable[[int], int] | None = None) -> int:
    """Number of solved increments; `solved_cycles` gives the solved number of repeats, by default all."""
    total = 0
    for step, segment in zip(steps, segments_of(steps), strict=True):
        solved = segment.repeat if solved_cycles is None else solved_cycles(segment.repeat)
        total += solved * sum(ramp.increments for ramp in ramps_of([step]))
    return total
