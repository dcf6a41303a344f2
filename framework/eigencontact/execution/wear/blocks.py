"""Blocks of wear: the separation of worn surfaces before the contact, and wear by what it slipped after it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.block import Block, Cost, Run, Running
from eigencontact.execution.blocks.precision import contact_precision
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.mechanics.exposed_material import ExposedMaterial
from eigencontact.execution.mechanics.mechanics import Mechanics
from eigencontact.execution.mechanics.normal_contact import normal_cost
from eigencontact.execution.mechanics.separation import Separation
from eigencontact.execution.wear.layers import layers_that_wear
from eigencontact.execution.wear.surface import MovedContact, WornSurface
from eigencontact.model.model import Model
from eigencontact.results.records import StepRecord

__all__ = ["Wear", "WornSeparation", "blocks_of_wear"]


#: Scalars of surfaces that wear.
_NUMBERS = (
    Number(
        name="worn_volume", unit="m3", meaning="volume that both bodies have lost", headline=True
    ),
    Number(
        name="max_worn_depth", unit="m", meaning="largest depth that both bodies together have lost", headline=True
    ),
    Number(name="cycles", unit="1", meaning="cycles done, those between solved ones included", headline=True),
    Number(name="jump_cycles", unit="1", meaning="cycles that the last solved one stands for", role="effort"),
    Number(
        name="wear_energy", unit="J", meaning="work of friction that wore, that of cycles between solved ones included",
        headline=True, replaces="dissipated_energy",
    ),
    Number(
        name="wear_error", unit="1", role="error", estimates="worn_volume",
        meaning="estimated error of the worn volume by jumps over cycles and by one update a cycle, relative",
    ),
    Number(
        name="update_error", unit="1", role="error",
        meaning="share of one update a cycle in the error of the worn volume; negative where too little is lost",
    ),
)  # fmt: skip
_LAG = Number(
    name="wear_lag", unit="1", role="error",
    meaning="pressure of the step less that by which it slid to it, summed over the cells, relative",
)  # fmt: skip
_BALANCE = Number(
    name="energy_volume_residual", unit="1", meaning="worn volume less that by the work of friction, relative",
    role="certificate",
)  # fmt: skip
_LAYER_ERROR = Number(
    name="layer_error", unit="1", role="error",
    meaning="largest difference of the answers of the most and the least worn column, relative",
)  # fmt: skip
_LAYERS_LOST = tuple(
    Number(name=f"layer_lost_{body}", unit="m", meaning=f"depth that the kernels take off the layers of body {body}")
    for body in (1, 2)
)

#: Pressures under moved surfaces that a step needs, as the bundled scenes do: where the contact travels a cell at a
#: time, where it slides, where it slides in cycles of which most are jumped over, and where it slips.
_TRAVELLING, _SLIDING, _JUMPING, _SLIPPING = 3, 9, 15, 1
#: Time of one of them by that of a contact, as most start from a pressure near by.
_NEAR = 0.6


class WornSeparation(Separation):
    """The gap of surfaces that have worn; sliding all over the contact wears them on the way to a step."""

    def __init__(self, model: Model, wear: Wear) -> None:
        ramps = model.scene.ramps
        travels = any(ramp.travels for ramp in ramps)
        super().__init__(model.geometries, model.grid, "slides" if travels else "")
        self._wear = wear
        self.why += ", and what has worn"
        if any(ramp.slides for ramp in ramps):
            jumps = any(step.repeat > 1 for step in model.scene.steps)
            self.cost = _moving(model, _TRAVELLING if travels else _JUMPING if jumps else _SLIDING)

    def start(self, run: Run) -> Running:
        """See `Block.start`."""
        return _WornGap(super().start(run), run.started(self._wear.start))


class _WornGap:
    """The gap of worn surfaces: that of new ones, and the depth that the surfaces have lost."""

    def __init__(self, new: Running, surface: WornSurface) -> None:
        self._new, self._surface = new, surface

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        self._new.advance(step)
        step.surface = self._surface.begin(step)


class Wear(Block):
    """Depth that the surfaces lose by what the contact slipped.

    Parameters
    ----------
    model : Model
    contact : callable
        `Block.start` of the block that solves the contact.
    """

    name = "wear"
    settles = True
    numbers = (*_NUMBERS, _LAG, _BALANCE, _LAYER_ERROR, *_LAYERS_LOST)

    def __init__(self, model: Model, contact: Callable[[Run], MovedContact]) -> None:
        assert model.wear is not None
        assert model.scene.wear is not None
        layered, slides = layers_that_wear(model), any(ramp.slides for ramp in model.scene.ramps)
        self.numbers = (
            *_NUMBERS,
            *((_LAG,) if slides else ()),
            *(() if model.wear.volume_per_energy is None else (_BALANCE,)),
            *((_LAYER_ERROR, *(_LAYERS_LOST[body - 1] for body in layered)) if layered else ()),
        )
        self._model, self._contact = model, contact
        bodies = model.scene.wear.parts
        which = " and ".join(f"body {body}" for body in bodies)
        self.why = f"{which} wear{'s' if len(bodies) == 1 else ''} by {model.wear.key!r}"
        for body in layered:
            most = model.scene.wear.layer_error
            self.why += f"; the layers of body {body} are as thick as their mean in contact, up to an error of {most:g}"
        slips = {"slip_distance", "dissipated_energy_density"} if model.friction is not None else set()
        self.requires = frozenset({"pressure", *slips})
        self.wanted = dict.fromkeys(("worn_depth", *(f"worn_depth_{body}" for body in bodies)), "[wear]")
        self.provides = frozenset(self.wanted)
        if not slides:
            self.cost = _moving(model, _SLIPPING)

    def cycles_of(self, last: StepRecord) -> int:
        """See `Block.cycles_of`."""
        return int(last.scalars["jump_cycles"])

    def start(self, run: Run) -> WornSurface:
        """See `Block.start`."""
        return WornSurface(self._model, run.started(self._contact))


def _moving(model: Model, solves: float) -> Cost:
    """Price of so many pressures a step; their memory is that of the contact."""
    contact = normal_cost(model.grid.shape, model.contact_box, contact_precision(model)[0])
    return Cost(seconds_per_step=_NEAR * solves * contact.seconds_per_step)


def blocks_of_wear(model: Model, mechanics: Mechanics) -> Iterator[Block]:
    """What moves the surfaces, before and after the contact."""
    wear = Wear(model, mechanics.start)
    yield WornSeparation(model, wear)
    if model.exposed is not None:
        yield ExposedMaterial(model.exposed)
    yield wear
