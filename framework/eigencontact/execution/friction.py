"""Runner of a contact with friction: pressure and shear of one load step, halved where it does not converge."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import NotConverged
from eigencontact.execution.contact import normal_options, normal_scalars
from eigencontact.execution.runners import State
from eigencontact.planning.blocks import Block
from eigencontact.planning.coupling import Coupling
from eigencontact.planning.kernels import PairCoefficients
from eigencontact.planning.plan import Plan
from eigencontact.plugin import FrictionState
from eigencontact.plugin.friction import checked_shear_bound
from eigencontact.results.records import StepRecord
from eigencontact.solvers.contact_area import contact_area
from eigencontact.solvers.control import MODES as NORMAL_MODES
from eigencontact.solvers.control import Control
from eigencontact.solvers.tangential.contact import FrictionalContact, FrictionalSolution, Sliding
from eigencontact.solvers.tangential.control import MODES, TangentialControl, mode_fields
from eigencontact.solvers.tangential.solver import TangentialOptions

__all__ = ["FrictionalContactRunner"]

FloatArray = NDArray[np.float64]

#: Times that a load step may be halved.
_HALVINGS = 5
_TRACTIONS = {"x": "q_x", "y": "q_y", "z": "p"}
#: Values of the stored field ``contact_zone``.
_SLIP, _STICK = 1.0, 2.0


class FrictionalContactRunner:
    """Pressure, shear, stick and slip. What a step needs of the last one is taken from its stored record alone."""

    def __init__(self, plan: Plan, block: Block) -> None:
        coupling, numerics = block.settings["coupling"], plan.scene.numerics
        assert isinstance(coupling, Coupling)
        assert plan.friction is not None
        self._law, self._grid, self._components = plan.friction, plan.grid, coupling.components
        self._dragged = bool(plan.sources) and coupling.level != "none"
        self._periodic = numerics.boundary == "periodic"
        coefficients = {
            (i, j): PairCoefficients(plan.influences[_TRACTIONS[j]], plan.bodies, i) for i, j in coupling.pairs
        }
        options = TangentialOptions(
            tolerance=numerics.tolerance,
            max_iterations=numerics.max_iterations,
            precision=numerics.precision,
            threads=numerics.threads,
            periodic=self._periodic,
        )
        self._contact = FrictionalContact(plan.grid, coefficients, self._bound, normal_options(numerics), options)
        self._time = 0.0

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        began = perf_counter()
        path = self._path(state)
        found = self._advance(path, self._before(state), (0.0, 1.0), 0, state)
        self._store(state, found)
        state.scalars["solve_seconds"] = perf_counter() - began

    def _bound(self, pressure: FloatArray, before: Sliding) -> FloatArray:
        y, x = self._grid.axes()
        state = FrictionState(pressure=pressure, x=x, y=y, slip_distance=before.slip_distance, time=self._time)
        return checked_shear_bound(self._law, state)

    def _before(self, state: State) -> Sliding:
        """State at the end of the last step; before the first one the surfaces are where eigenstrain has put them."""
        if state.previous is None:
            rest = Sliding.at_rest(self._grid, self._components)
            return replace(rest, position=self._residual(state.initial)) if self._dragged else rest
        return self._handed_on(state.previous)

    def _handed_on(self, last: StepRecord) -> Sliding:
        rigid = np.array([last.scalars[displacement] for displacement, _ in MODES])
        position = self._vector(last.fields, "displacement")
        position -= np.einsum("m,mkij->kij", rigid, mode_fields(self._grid, self._components))
        if self._dragged:
            position += self._residual(last.fields)
        shear = self._vector(last.fields, "shear")
        return Sliding(
            pressure=last.fields["pressure"],
            shear=shear,
            position=position,
            lift=self._contact.lift(shear),
            rigid=rigid,
            slip_distance=last.fields["slip_distance"],
            dissipated=last.fields["dissipated_energy_density"],
        )

    def _vector(self, fields: Mapping[str, FloatArray], name: str) -> FloatArray:
        return np.stack([fields[f"{name}_{c}"] for c in self._components])

    def _residual(self, fields: Mapping[str, FloatArray]) -> FloatArray:
        return self._vector(fields, "residual_displacement")

    def _path(self, state: State) -> _Path:
        assert state.control is not None
        assert state.tangential is not None
        last = state.previous
        fields = state.initial if last is None else last.fields
        name = "residual_displacement_z"
        lifted = (fields[name], state.fields[name]) if name in state.fields else None
        dragged = (self._residual(fields), self._residual(state.fields)) if self._dragged else None
        return _Path(
            separation=state.fields["separation"],
            lifted=lifted,
            dragged=dragged,
            begin={} if last is None else last.scalars,
            times=(0.0 if last is None else last.time, state.time),
            control=state.control,
            tangential=state.tangential,
        )

    def _advance(
        self, path: _Path, before: Sliding, span: tuple[float, float], depth: int, state: State
    ) -> list[FrictionalSolution]:
        """Increments from one fraction of the step to another: one, or more where one is too large to converge."""
        separation, control, tangential, offset, self._time = path.at(span[1])
        try:
            return [
                self._contact.step(
                    separation, control, tangential, before, offset=offset, progress=state.progress
                )
            ]  # fmt: skip
        except NotConverged:
            if depth == _HALVINGS:
                raise
        middle = 0.5 * (span[0] + span[1])
        first = self._advance(path, before, (span[0], middle), depth + 1, state)
        return first + self._advance(path, first[-1].sliding, (middle, span[1]), depth + 1, state)

    def _store(self, state: State, found: list[FrictionalSolution]) -> None:
        last = found[-1]
        normal, tangential, sliding = last.normal, last.tangential, last.sliding
        loaded = normal.pressure > 0
        slipped = np.any([(one.normal.pressure > 0) & ~one.tangential.stick for one in found], axis=0)
        moved = [one.tangential.slip * ((one.normal.pressure > 0) & ~one.tangential.stick) for one in found]
        vectors = {
            "displacement": tangential.displacement + last.tangential_by_pressure,
            "shear": tangential.shear,
            "slip": np.sum(moved, axis=0) * loaded,
        }
        stick = loaded & ~slipped
        state.fields |= {
            "pressure": normal.pressure,
            "gap": normal.gap,
            "displacement_z": normal.displacement + sliding.lift,
            **{f"{name}_{c}": rows[k] for name, rows in vectors.items() for k, c in enumerate(self._components)},
            "slip_distance": sliding.slip_distance,
            "dissipated_energy_density": sliding.dissipated,
            "contact_zone": np.where(stick, _STICK, np.where(loaded, _SLIP, 0.0)),
        }
        state.scalars |= normal_scalars(normal, self._grid, periodic=self._periodic)
        state.scalars |= self._scalars(found)
        state.scalars |= self._zones(loaded, stick)

    def _scalars(self, found: list[FrictionalSolution]) -> dict[str, float]:
        last = found[-1]
        forces, rigid = last.tangential.forces, last.tangential.rigid
        certificates = [one.tangential.report.certificate for one in found]
        normals = [one.normal.report.certificate for one in found]
        worst = {
            name: max(getattr(certificate, name) for certificate in certificates)
            for name in ("bound", "stick", "alignment", "load")
        }
        sizes = {
            "gap_residual": max(certificate.gap for certificate in normals if certificate is not None),
            "penetration_residual": max(certificate.penetration for certificate in normals if certificate is not None),
            "load_residual": max(worst["load"], *(one.load for one in normals if one is not None)),
        }
        return {
            **sizes,
            "tangential_load_x": float(forces[0]),
            "tangential_load_y": float(forces[1]),
            "tangential_load": float(np.hypot(forces[0], forces[1])),
            "shift_x": float(rigid[0]),
            "shift_y": float(rigid[1]),
            "shift": float(np.hypot(rigid[0], rigid[1])),
            "torsion_moment": float(forces[2]),
            "twist": float(rigid[2]),
            "dissipated_energy": float(last.sliding.dissipated.sum()) * self._grid.cell_area,
            "bound_residual": worst["bound"],
            "stick_residual": worst["stick"],
            "alignment_residual": worst["alignment"],
            "coupling_residual": max(one.coupling_residual for one in found),
            "convolutions": float(sum(one.normal_convolutions for one in found)),
            "tangential_convolutions": float(sum(one.tangential_convolutions for one in found)),
            "coupling_rounds": float(sum(one.rounds for one in found)),
            "substeps": float(len(found)),
        }

    def _zones(self, loaded: NDArray[np.bool_], stick: NDArray[np.bool_]) -> dict[str, float]:
        whole = contact_area(loaded, self._grid, periodic=self._periodic)
        inner = contact_area(stick, self._grid, periodic=self._periodic)
        return {
            "stick_radius": float(np.sqrt(max(inner, 0.0) / np.pi)),
            "slip_fraction": float(np.clip(1.0 - inner / whole, 0.0, 1.0)) if whole > 0 else 0.0,
        }


@dataclass(frozen=True, kw_only=True, slots=True)
class _Path:
    """Everything prescribed in one load step, linear from the state before to its end.

    `lifted` and `dragged` are the displacements of the surface by eigenstrain at both ends, along z and along x and y.
    """

    separation: FloatArray
    lifted: tuple[FloatArray, FloatArray] | None
    dragged: tuple[FloatArray, FloatArray] | None
    begin: Mapping[str, float]
    times: tuple[float, float]
    control: Control
    tangential: TangentialControl

    def at(self, fraction: float) -> tuple[FloatArray, Control, TangentialControl, FloatArray | None, float]:
        """Separation, controls, tangential offset and time at a fraction of the step."""
        separation = self.separation if self.lifted is None else self.separation + _between(self.lifted, fraction)
        offset = None if self.dragged is None else _between(self.dragged, fraction)
        if fraction == 1.0:
            return separation, self.control, self.tangential, offset, self.times[1]
        control = Control(**self._values(self.control, NORMAL_MODES, fraction))
        tangential = TangentialControl(**self._values(self.tangential, MODES, fraction))
        return separation, control, tangential, offset, self.times[0] + fraction * (self.times[1] - self.times[0])

    def _values(
        self, end: Control | TangentialControl, modes: tuple[tuple[str, str], ...], fraction: float
    ) -> dict[str, float]:
        values = {}
        for name in (name for pair in modes for name in pair):
            target = getattr(end, name)
            if target is not None:
                begin = self.begin.get(name, 0.0)
                values[name] = begin + fraction * (target - begin)
        return values


def _between(ends: tuple[FloatArray, FloatArray], fraction: float) -> FloatArray:
    return ends[1] if fraction == 1.0 else ends[0] + fraction * (ends[1] - ends[0])
