"""Blocks of wear: separation of the worn surfaces before the contact, and wear by slip after it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from eigencontact.core.cautions import Caution, LeftOut
from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.block import Block, Cost, Run, Running
from eigencontact.execution.blocks.precision import contact_precision
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.mechanics.mechanics import Mechanics
from eigencontact.execution.mechanics.normal_contact import normal_cost
from eigencontact.execution.mechanics.separation import Separation, separation_blocks
from eigencontact.execution.wear.cautions import shift_that_wears, wear_cautions, worn_bodies
from eigencontact.execution.wear.layers import layers_that_wear, refuse_unworn_kernels
from eigencontact.execution.wear.surface import MovedContact, WornSurface
from eigencontact.execution.wear.words import left_out_of_wear, wear_lines
from eigencontact.model.exposed import Exposed
from eigencontact.model.interface import Interface
from eigencontact.model.model import Model
from eigencontact.model.wear import WearModel
from eigencontact.model.window import Window
from eigencontact.results.records import StepRecord
from eigencontact.scene.schema import Numerics

__all__ = ["Wear", "WornSeparation", "blocks_of_wear"]


#: Scalars of surfaces that wear.
_NUMBERS = (
    Number(
        name="worn_volume", unit="m3", meaning="worn volume of both bodies", headline=True,
        in_line="worn area",
    ),
    Number(
        name="max_worn_depth", unit="m", meaning="largest worn depth of both bodies together", headline=True
    ),
    Number(name="cycles", unit="1", meaning="number of cycles, with the skipped ones", headline=True),
    Number(name="jump_cycles", unit="1", meaning="cycles that the last solved cycle represents", role="effort"),
    Number(
        name="wear_energy", unit="J", meaning="work of friction of all cycles, with the skipped ones",
        headline=True, replaces="dissipated_energy",
    ),
    Number(
        name="wear_error", unit="1", role="error", estimates="worn_volume",
        meaning="estimated relative error of the worn volume by skipped cycles and by one update per cycle",
    ),
    Number(
        name="update_error", unit="1", role="error",
        meaning="relative error of the worn volume by one update per cycle; negative if the volume is too small",
    ),
)  # fmt: skip
_LAG = Number(
    name="wear_lag", unit="1", role="error",
    meaning="relative difference of the final pressure and the pressure of the wear by sliding, summed over the cells",
)  # fmt: skip
_BALANCE = Number(
    name="energy_volume_residual", unit="1",
    meaning="relative difference of the worn volume and the volume by the work of friction",
    role="certificate",
)  # fmt: skip
_LAYER_ERROR = Number(
    name="layer_error", unit="1", role="error",
    meaning="largest relative difference of the responses of the most and the least worn column",
)  # fmt: skip
_LAYERS_LOST = tuple(
    Number(name=f"layer_lost_{body}", unit="m", meaning=f"worn depth of the layers of body {body} in the kernels")
    for body in (1, 2)
)

#: Number of pressure solves on moved surfaces per step in the bundled scenes: contact that travels one cell at a time,
#: sliding, sliding cycles with jumps, and slip.
_TRAVELLING, _SLIDING, _JUMPING, _SLIPPING = 3, 9, 15, 1
#: Time of such a solve relative to a contact solve: most start from a similar pressure.
_NEAR = 0.6


class WornSeparation(Separation):
    """Gap of worn surfaces; sliding of the whole contact wears them during a step.

    Parameters
    ----------
    wear : Wear
        Block that wears the surfaces.
    """

    def __init__(self, wear: Wear) -> None:
        model = wear.model
        super().__init__(wear.interface, wear.window.grid, travels=model.travels, slides=True)
        self._wear = wear
        self.reason += ", and what has worn"
        if model.slides:
            solves = _TRAVELLING if model.travels else _JUMPING if model.repeats else _SLIDING
            self.cost = wear.solves(solves)

    def start(self, run: Run) -> Running:
        """See `Block.start`."""
        return _WornGap(super().start(run), run.started(self._wear.start))


class _WornGap:
    """Gap of worn surfaces: initial gap plus worn depth."""

    def __init__(self, new: Running, surface: WornSurface) -> None:
        self._new, self._surface = new, surface

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        self._new.advance(step)
        step.surface = self._surface.begin(step)


class Wear(Block):
    """Worn depth of the surfaces by the slip of the contact.

    Parameters
    ----------
    model : WearModel
    interface : Interface
    window : Window
    exposed : Exposed or None
        Materials at the surface.
    numerics : Numerics
        Numerics of the contact.
    contact : callable
        `Block.start` of the block that solves the contact.
    """

    name = "wear"
    settles = True
    numbers = (*_NUMBERS, _LAG, _BALANCE, _LAYER_ERROR, *_LAYERS_LOST)

    def __init__(
        self, model: WearModel, interface: Interface, window: Window, exposed: Exposed | None, numerics: Numerics,
        contact: Callable[[Run], MovedContact],
    ) -> None:  # fmt: skip
        self.model, self.interface, self.window = model, interface, window
        self._exposed, self._numerics, self._contact = exposed, numerics, contact
        layered = layers_that_wear(model, interface.solids)
        self.numbers = (
            *_NUMBERS,
            *((_LAG,) if model.slides else ()),
            *(() if model.law.volume_per_energy is None else (_BALANCE,)),
            *((_LAYER_ERROR, *(_LAYERS_LOST[body - 1] for body in layered)) if layered else ()),
        )
        bodies = " and ".join(f"body {body}" for body in model.parts)
        self.reason = f"{bodies} wear{'s' if len(model.parts) == 1 else ''} by {model.law.key!r}"
        for body in layered:
            most = model.table.layer_error
            self.reason += f"; layers of body {body} have their mean thickness in contact, error at most {most:g}"
        slips = set() if interface.friction is None else {"slip_distance", "dissipated_energy_density"}
        self.requires = frozenset({"pressure", *slips})
        self.requesters = dict.fromkeys(("worn_depth", *(f"worn_depth_{body}" for body in model.parts)), "[wear]")
        self.provides = frozenset(self.requesters)
        if not model.slides:
            self.cost = self.solves(_SLIPPING)

    def solves(self, count: float) -> Cost:
        """Cost of `count` pressure solves per step; they share the memory of the contact."""
        contact = normal_cost(self.window.grid.shape, self.window.box, self._numerics)
        return Cost(seconds_per_step=_NEAR * count * contact.seconds_per_step)

    def cycles_of(self, last: StepRecord) -> int:
        """See `Block.cycles_of`."""
        return int(last.scalars["jump_cycles"])

    def start(self, run: Run) -> WornSurface:
        """See `Block.start`."""
        grid, contact = self.window.grid, run.started(self._contact)
        return WornSurface(self.model, self.interface, grid, self._exposed, contact)

    def facts(self, model: Model) -> list[str]:
        """See `Block.facts`."""
        return wear_lines(self.model, model.scene.steps)

    def left_out(self, model: Model) -> list[LeftOut]:
        """See `Block.left_out`."""
        return left_out_of_wear(model, self.model.table)

    def foreseen(self, model: Model) -> Iterable[Caution]:
        """See `Block.foreseen`."""
        return shift_that_wears(model)

    def noticed(self, model: Model, last: StepRecord, history: Sequence[Mapping[str, float]]) -> Iterable[Caution]:
        """See `Block.noticed`."""
        return (*wear_cautions(self.model.table, model, last, history), *worn_bodies(model, last, history))


def blocks_of_wear(model: Model, mechanics: Mechanics) -> Iterator[Block]:
    """Blocks that move the surfaces, before and after the contact."""
    if model.wear is None or model.interface is None:
        return
    numerics, _ = contact_precision(model.numerics, model.window.box, coupled=bool(model.cells.inhomogeneities))
    wear = Wear(model.wear, model.interface, model.window, model.exposed, numerics, mechanics.start)
    refuse_unworn_kernels(model)
    yield from separation_blocks(model, WornSeparation(wear))
    yield wear
