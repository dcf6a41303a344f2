"""Wearing surfaces: they move by each increment, by a cycle, or by many cycles at once.

The pressure on a surface decreases while it wears. An update therefore uses the pressure during the wear: for a
constant rate k [m/(Pa cycle)], `eigencontact.solvers.moving_surface` integrates ``dw/dN = k p(w)`` by implicit steps,
which have no stability limit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.step import CyclePlace, Step
from eigencontact.execution.blocks.surface import Surface
from eigencontact.execution.mechanics.exposed_material import exposed_facts
from eigencontact.execution.wear.jumps import MOST, Jumps, against_deflection, ahead
from eigencontact.execution.wear.layers import WornLayers, layers_that_wear
from eigencontact.execution.wear.rate import Rate, energy_of, filled, quotient, rate_of
from eigencontact.execution.wear.state import recalled, store, updated
from eigencontact.model.exposed import Exposed
from eigencontact.model.interface import Interface
from eigencontact.model.kernels import Solids
from eigencontact.model.wear import WearModel
from eigencontact.plugin import FrictionState, NamesMaterials, WearState
from eigencontact.plugin.friction import checked_shear_bound
from eigencontact.solvers.control import Control
from eigencontact.solvers.moving_surface import moved

__all__ = ["MovedContact", "WornSurface"]


#: Fraction of the error of a jump for the integration at a fixed rate.
_INTEGRATION = 0.1
#: Largest number of halvings of a sliding path that exposes another material.
_HALVINGS = 7
#: Smallest ratio of the pressures at the start and the end of a cycle in cells whose wear represents whole cycles.
_THROUGHOUT = 0.5
#: The error is relative to the added depth, but to no less than this fraction of the total worn depth.
_LEAST = 0.02


class MovedContact(Protocol):
    """Contact of worn surfaces; it computes new kernels if the bodies have changed."""

    def pressed(
        self, surface: Surface, control: Control, fields: Mapping[str, FloatArray], springs: FloatArray | None,
        start: FloatArray | None,
    ) -> FloatArray:  # fmt: skip
        """Pressure under displaced surfaces; see `eigencontact.execution.blocks.contact.Contact.pressed`."""
        ...

    def softness(self, solids: Solids | None) -> float:
        """Displacement of the centre of a cell by a unit pressure on it [m/Pa]; `solids` as in `Surface`."""
        ...


class WornSurface:
    """Wearing surfaces, updated from step to step, from stored records.

    Parameters
    ----------
    wear : WearModel
    interface : Interface
        Interface with unworn layers.
    grid : Grid
    exposed : Exposed or None
        Materials at the surface.
    contact : MovedContact
        Contact of the scene.
    """

    def __init__(
        self, wear: WearModel, interface: Interface, grid: Grid, exposed: Exposed | None, contact: MovedContact
    ) -> None:
        media = layers_that_wear(wear, interface.solids)
        self._layers = WornLayers(media, interface, grid, wear.table.layer_error) if media else None
        self._law, self._friction, self._grid = wear.law, interface.friction, grid
        self._contact, self._parts, self._exposed = contact, wear.parts, exposed
        self._at_once, self._travels = wear.by_increment, wear.travels
        self._jumps = Jumps(wear.table, grid, contact.softness(self.solids))
        self._opening = wear.table.error or 1e-2
        self._tolerance = _INTEGRATION * self._opening
        self._by_material = any(isinstance(law, NamesMaterials) for law in (self._law, self._friction))
        # Within a cycle, increments with immediate update and sliding move the surfaces.
        self._within = self._at_once or wear.slides

    @property
    def worn_depths(self) -> dict[int, FloatArray]:
        """Worn depth ``(ny, nx)`` [m] of each body that wears, in coordinates of the window."""
        return {body: self._state.in_window(body) for body in self._state.depth}

    @property
    def solids(self) -> Solids | None:
        """Solids with the layer thickness of the kernels; None if no layers wear."""
        return None if self._layers is None else self._layers.solids

    @property
    def _exposed_facts(self) -> dict[str, Any]:
        """Exposed material, for the states of laws."""
        exposed = self._exposed
        return {} if exposed is None else exposed_facts(exposed, exposed.at(self.worn_depths.get(exposed.body)))

    def begin(self, step: Step) -> Surface:
        """Surfaces at the start of a step, from unworn surfaces at the same position.

        Skipped cycles before the step wear the surfaces, and sliding of the whole contact during the step as well.
        """
        travel = step.travel if self._travels else None
        self._new, self._state = step.surface, recalled(step.previous, self._parts, self._grid, travel)
        cycle, slide = step.cycle, step.surface.slide
        moved = self._state.memory.pop("update", None) is not None
        if self._layers is not None:
            self._layers.begin(step, self._state)
        if cycle is not None and cycle.begins:
            pressure = np.zeros(self._grid.shape) if step.previous is None else step.previous.fields["pressure"]
            if cycle.skipped:
                moved = True
                pressure = self._skip(step, cycle.skipped)
            self._note_start(step, pressure)
        if slide is not None and not (cycle is not None and cycle.settling):
            self._slid = self._slide(step, slide.distance)
        return replace(self._worn_by(self._state.total), worn_depths=self.worn_depths, moved=moved)

    def _worn_by(self, depth: FloatArray) -> Surface:
        """Surfaces after a common worn depth ``(ny, nx)`` [m]."""
        assert self._new.separation is not None
        return replace(self._new, separation=self._new.separation + depth, solids=self.solids)

    def advance(self, step: Step) -> None:
        """Wear by the slip of a solved step, or by the cycle that ends with it; stores the results in the step."""
        cycle, memory = step.cycle, self._state.memory
        if cycle is not None and cycle.settling:
            store(self._state, step, self._grid, travels=self._travels)
            if self._layers is not None:
                self._layers.end(step, self._state)
            return
        at_once = cycle is None or self._at_once
        peak = _peak(step, memory)
        if "start_slip" in memory:
            memory["peak_pressure"] = peak
        slip, energy = (_increase(step, name) for name in ("slip_distance", "dissipated_energy_density"))
        if step.surface.slide is not None:
            difference = float(np.abs(step.fields["pressure"] - self._expected).sum())
            step.scalars["wear_lag"] = difference / max(float(self._expected.sum()), np.finfo(float).tiny)
            self._count(self._slid, step.fields["pressure"])
            if "start_slip" in memory:  # the increment has already worn the surfaces
                memory["start_slip"] = memory["start_slip"] + slip
                memory["start_dissipated"] = memory["start_dissipated"] + energy
        elif at_once:
            rate, _ = self._wear(step, slip, energy, peak, amplitude=0.0)
            self._count(rate, step.fields["pressure"])
        if cycle is not None and cycle.ends:
            self._end_cycle(step, cycle, peak)
        store(self._state, step, self._grid, travels=self._travels)
        if self._layers is not None:
            self._layers.end(step, self._state)
        alpha, volume = self._law.volume_per_energy, step.scalars["worn_volume"]
        if alpha is not None:
            missing = abs(volume - alpha * step.scalars["wear_energy"])
            step.scalars["energy_volume_residual"] = missing / volume if volume > 0 else 0.0

    def _note_start(self, step: Step, pressure: FloatArray) -> None:
        """Store the values at the start of a cycle; `pressure` is that of the surfaces after skipped cycles."""
        state, zero = self._state, np.zeros(self._grid.shape)
        fields = {} if step.previous is None else step.previous.fields
        if self._within:
            state.memory |= {"start_depth": state.sum_of_depths, "start_energy": state.energy}
            if not self._travels:
                state.memory |= {"start_pressure": pressure, "cycle_depth": zero}
        if self._travels and 2 in state.depth:
            state.memory["start_depth_2"] = state.depth[2]
        if self._friction is not None and not self._at_once:
            state.memory["start_slip"] = fields.get("slip_distance", zero)
            state.memory["start_dissipated"] = fields.get("dissipated_energy_density", zero)

    def _skip(self, step: Step, cycles: int) -> FloatArray:
        """Wear by the cycles between the last solved one and this step, under the load at the end of the last one.

        Returns the pressure after them.
        """
        last = step.previous
        assert last is not None
        assert step.control is not None
        if self._travels and not self._state.memory["rate"].any():
            self._repeat(cycles)
            return last.fields["pressure"]
        modes = {name: last.scalars[name] for name in step.control.prescribed_names}
        pressure, memory = last.fields["pressure"], self._state.memory
        depth = Rate(pressed=memory["rate"], steady=memory["steady"]).depth(pressure)
        rate = ahead(memory, 0.5 * (cycles + 1))
        after = self._move(Control(**modes), last.fields, rate, cycles, depth, memory["cycle_energy"], pressure)
        if self._layers is not None:
            self._layers.follow(self._state, after)
        self._state.cycles += cycles
        return after

    def _repeat(self, cycles: int) -> None:
        """Wear by `cycles` repetitions of the last cycle at any pressure; each body in its own coordinates."""
        state, memory = self._state, self._state.memory
        second = memory.get("steady_2", 0.0)
        depth_of = {1: memory["steady"] - second, 2: second}
        state.depth = {body: depth + cycles * depth_of[body] for body, depth in state.depth.items()}
        state.energy = state.energy + cycles * memory["cycle_energy"]
        state.cycles += cycles

    def _slide(self, step: Step, distance: float, halvings: int = _HALVINGS) -> Rate:
        """Wear by sliding of the whole contact, with the pressure at the end of the step; returns its rate.

        A path that would remove too much of a material not exposed at its start is halved.
        """
        assert step.control is not None
        fields = {} if step.previous is None else step.previous.fields
        pressure = self._contact.pressed(self._worn_by(self._state.total), step.control, fields, None, None)
        shear = np.zeros_like(pressure)
        if self._friction is not None:
            y, x = self._grid.axes()
            slipped = fields.get("slip_distance", shear)
            state = FrictionState(
                pressure=pressure, x=x, y=y, slip_distance=slipped, time=step.time, **self._exposed_facts
            )
            shear = checked_shear_bound(self._friction, state)
        slip, zero = np.where(pressure > 0, distance, 0.0), np.zeros_like(pressure)
        rate = rate_of(self._law, self._law_state(step, pressure, shear, slip, zero, shear * slip))
        if halvings and self._overshoot(rate.depth(pressure)) > self._opening:
            rates = [self._slide(step, 0.5 * distance, halvings - 1) for _ in range(2)]
            return Rate(pressed=rates[0].pressed + rates[1].pressed, steady=rates[0].steady + rates[1].steady)
        after = self._expected = self._move(
            step.control, fields, rate, 1, rate.depth(pressure), shear * slip, pressure
        )  # fmt: skip
        if self._layers is not None:
            self._layers.follow(self._state, after)
        return rate

    def _wear(
        self, step: Step, slip: FloatArray, energy: FloatArray, peak: FloatArray, *, amplitude: float
    ) -> tuple[Rate, FloatArray]:
        """Wear by a solved increment or cycle; returns its rate and energy.

        `amplitude` is the slip amplitude relative to the slip path. The worn depth of cells without final pressure is
        at most the deflection under their largest pressure `peak`: at this depth they lose contact.
        """
        pressure, fields = step.fields["pressure"], step.fields
        shear = np.hypot(fields.get("shear_x", 0.0 * pressure), fields.get("shear_y", 0.0))
        rate = rate_of(self._law, self._law_state(step, pressure, shear, slip, amplitude * slip, energy))
        depth = rate.depth(pressure)
        rate = replace(rate, steady=np.minimum(rate.steady, self._contact.softness(self.solids) * peak))
        assert step.control is not None
        before = self._state.total
        self._move(step.control, fields, rate, 1, depth, energy, pressure)
        update = self._state.total - before
        if update.any():
            self._state.memory["update"] = update
        return rate, energy_of(rate.depth(pressure), depth, energy, 1.0)

    def _count(self, rate: Rate, pressure: FloatArray) -> None:
        """Add the wear of an increment to that of the cycle, by the law at the final pressure of the increment."""
        memory = self._state.memory
        if "cycle_depth" in memory:
            memory["cycle_depth"] = memory["cycle_depth"] + rate.depth(pressure)

    def _end_cycle(self, step: Step, cycle: CyclePlace, peak: FloatArray) -> None:
        """Wear by a whole cycle, and set the number of cycles that it represents."""
        state, pressure = self._state, step.fields["pressure"]
        memory, rate, energy = state.memory, None, np.zeros_like(pressure)
        within = self._within and not np.array_equal(state.sum_of_depths, memory["start_depth"])
        if "start_slip" in memory:
            energy = step.fields["dissipated_energy_density"] - memory["start_dissipated"]
            slip = step.fields["slip_distance"] - memory["start_slip"]
            rate, energy = self._wear(step, slip, energy, peak, amplitude=0.25)
            self._count(rate, pressure)
        state.cycles += 1.0
        if rate is None or within:
            # The surfaces moved within the cycle. Wear also lowers the pressure within it, so that a quotient of worn
            # depth and final pressure is not the rate: the law's depth at the final pressure of each increment is.
            depth, energy = state.sum_of_depths - memory["start_depth"], state.energy - memory["start_energy"]
            if self._travels:
                rate = Rate(pressed=np.zeros_like(depth), steady=depth)
            else:
                law_depth, loaded = memory["cycle_depth"], pressure > 0
                rate = Rate(pressed=quotient(law_depth, pressure, loaded), steady=np.where(loaded, 0.0, law_depth))
                # A cell that touches only since a part of the cycle has worn less than in a whole one.
                throughout = loaded & (memory["start_pressure"] >= _THROUGHOUT * pressure)
                rate = filled(rate, throughout if throughout.any() else loaded)
                energy = energy_of(rate.depth(pressure), depth, energy, 1.0)
        start = memory.get("start_depth_2")
        self._jumps.decide(
            state, cycle, rate, energy, pressure, float(peak.max()), in_its_end=not (within or self._at_once)
        )
        while state.jump > 1 and self._overshoot(state.jump * rate.depth(pressure)) > self._opening:
            state.jump //= 2
        if cycle.repeats_after == 0:  # the last jump has an error as well, and no other jump follows
            state.memory, state.jump = updated(memory), 1
        elif start is not None:
            state.memory["steady_2"] = state.depth[2] - start

    def _overshoot(self, depth: FloatArray) -> float:
        """Fraction of a worn depth [m] below the exposed material, by volume; 0 if one law serves all materials."""
        exposed = self._exposed
        if exposed is None or exposed.body not in self._parts or not self._by_material or not depth.any():
            return 0.0
        return exposed.share_below(self.worn_depths[exposed.body], self._parts[exposed.body] * depth)

    def _law_state(
        self, step: Step, pressure: FloatArray, shear: FloatArray, slip: FloatArray, amplitude: FloatArray,
        energy: FloatArray,
    ) -> WearState:  # fmt: skip
        """State for the wear law."""
        y, x = self._grid.axes()
        return WearState(
            pressure=pressure, shear=shear, slip=slip, slip_amplitude=amplitude, energy=energy,
            worn_depth=self._state.total, total_energy=self._state.energy, x=x, y=y, time=step.time,
            **{"material": np.zeros(pressure.shape, dtype=np.intp), **self._exposed_facts},
        )  # fmt: skip

    def _move(
        self, control: Control, fields: Mapping[str, FloatArray], rate: Rate, cycles: int, depth: FloatArray,
        energy: FloatArray, pressure: FloatArray,
    ) -> FloatArray:  # fmt: skip
        """Move the surfaces by a number of cycles of a rate; `depth` and `energy` are those of the solved cycle.

        Returns the pressure on the moved surfaces.
        """
        state, added = self._state, np.zeros_like(pressure)
        least = _LEAST * float(state.total.sum())
        self._refuse_too_much(rate, cycles, pressure)
        if rate.nonzero:
            motion = moved(
                lambda depth_so_far, springs, start: self._contact.pressed(
                    self._worn_by(depth_so_far), control, fields, springs, start
                ),
                state.total, pressure, rate.pressed, cycles, steady=rate.steady, tolerance=self._tolerance,
                least=least,
            )  # fmt: skip
            added, pressure = motion.depth, motion.pressure
            state.wear(added, self._parts)
            state.error += motion.error * max(float(added.sum()), least) * self._grid.cell_area
        state.energy = state.energy + energy_of(added, depth, energy, cycles)
        return pressure

    def _refuse_too_much(self, rate: Rate, cycles: int, pressure: FloatArray) -> None:
        """Refuse a worn depth that exceeds the deflection by more than the resolution of floating-point numbers."""
        share = cycles * against_deflection(rate, pressure, self._contact.softness(self.solids))
        if share > 10.0 * MOST:
            raise SceneError(
                f"wear law {self._law.key!r} must wear less than {10.0 * MOST:g} times what the surface deflects in "
                f"one update (got {share:.2g} times, {float(rate.depth(pressure).max()):.2g} m if the pressure "
                "stayed); lower its coefficient, or slide less in an increment"
            )


def _increase(step: Step, name: str) -> FloatArray:
    """Increase of a cumulative field in a step."""
    if name not in step.fields:
        return np.zeros_like(step.fields["pressure"])
    return step.fields[name] if step.previous is None else step.fields[name] - step.previous.fields[name]


def _peak(step: Step, memory: Mapping[str, FloatArray]) -> FloatArray:
    """Largest pressure of each cell in a step, or so far in the present cycle [Pa]."""
    peak = step.fields["pressure"]
    if step.previous is not None:
        peak = np.maximum(peak, step.previous.fields["pressure"])
    return np.maximum(peak, memory["peak_pressure"]) if "peak_pressure" in memory else peak
