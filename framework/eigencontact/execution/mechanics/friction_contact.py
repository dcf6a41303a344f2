"""Contact with friction: pressure and shear, stick and slip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.bulk import dragged, relative_strain
from eigencontact.core.numbers import Number
from eigencontact.core.tractions import ALONG
from eigencontact.execution.blocks.contact import (
    COUPLING_RESIDUAL,
    Contact,
    ContactAnswer,
    Fields,
    normal_options,
    scaled_forces,
)
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.blocks.precision import contact_precision
from eigencontact.execution.blocks.surface import Slide
from eigencontact.execution.mechanics.exposed_material import exposed_facts
from eigencontact.execution.mechanics.friction_cost import friction_cost, pressed_share
from eigencontact.execution.mechanics.normal_contact import (
    NORMAL_FIELDS,
    NORMAL_NUMBERS,
    cell_deflection,
    layers_cost,
    normal_scalars,
    normal_work,
    scaled_normal,
    surface_kernels,
)
from eigencontact.model.bodies import without_layers
from eigencontact.model.exposed import Exposed
from eigencontact.model.interface import Interface
from eigencontact.model.window import Window
from eigencontact.plugin import FrictionState
from eigencontact.plugin.friction import checked_shear_bound
from eigencontact.results.records import StepRecord
from eigencontact.scene.schema import Numerics, Step
from eigencontact.solvers.contact_area import contact_area, radius_of_area
from eigencontact.solvers.control import Control
from eigencontact.solvers.tangential.control import MODES, mode_fields

if TYPE_CHECKING:
    from eigencontact.solvers.tangential.contact import FrictionalSolution, Sliding

__all__ = ["ContactWithFriction", "friction_fields"]


#: Values of the stored field ``contact_zone``.
_SLIP, _STICK = 1.0, 2.0
#: Scalars of a contact with friction, in addition to those of every contact.
FRICTION_NUMBERS = (
    Number(name="tangential_load_x", unit="N", meaning="tangential load along x, on body 1"),
    Number(name="tangential_load_y", unit="N", meaning="tangential load along y, on body 1"),
    Number(name="tangential_load", unit="N", meaning="magnitude of the tangential load", headline=True),
    Number(name="shift_x", unit="m", meaning="shift of body 2 against body 1 along x"),
    Number(name="shift_y", unit="m", meaning="shift of body 2 against body 1 along y"),
    Number(name="shift_magnitude", unit="m", meaning="shift, magnitude", headline=True, label="shift"),
    Number(name="torsion_moment", unit="N m", meaning="torsion moment about the z axis, on body 1"),
    Number(name="twist", unit="rad", meaning="twist of body 2 against body 1 about the z axis, from x to y"),
    Number(name="stick_radius", unit="m", meaning="radius of the circle of equal stick area", scatters=True,
           in_line="half width of the stick zone"),
    Number(
        name="slip_fraction", unit="1", meaning="slipping part of the contact area", headline=True, scatters=True
    ),
    Number(
        name="dissipated_energy", unit="J", meaning="work of friction in the solved increments",
        headline=True,
    ),
    Number(name="bound_residual", unit="1", meaning="relative excess of the shear over its bound", role="certificate"),
    Number(name="stick_residual", unit="1", meaning="relative slip of sticking cells", role="certificate"),
    Number(
        name="alignment_residual", unit="1", meaning="relative slip across the shear, or along it, of slipping cells",
        role="certificate",
    ),
    COUPLING_RESIDUAL,
    Number(
        name="coupling_rounds", unit="1", meaning="iterations of normal and tangential contact", role="effort",
        over="sum",
    ),
    Number(
        name="tangential_convolutions", unit="1", meaning="convolutions of the tangential operator", role="effort",
        over="sum",
    ),
)  # fmt: skip


def friction_fields(components: str) -> frozenset[str]:
    """Additional surface fields of a contact with shear along some directions."""
    if not components:
        return frozenset()
    vectors = {f"{name}_{c}" for name in ("displacement", "shear", "slip") for c in components}
    return frozenset(vectors | {"slip_distance", "dissipated_energy_density", "contact_zone"})


class ContactWithFriction(Contact):
    """Pressure, shear, stick and slip. A step needs only the stored record of the last step.

    Parameters
    ----------
    interface : Interface
        Interface with a friction law.
    window : Window
    numerics : Numerics
    exposed : Exposed or None
        Materials at the surface, for laws that distinguish them.
    ramps : sequence of Step
        Load history, for the predicted time.
    coupled : bool
        Whether inhomogeneities are iterated together with the contact.
    """

    name, reason = "frictional-contact", "pressure and shear with friction, stick and slip"
    numbers = (*NORMAL_NUMBERS, *FRICTION_NUMBERS)
    accumulated = frozenset({"slip_distance", "dissipated_energy_density"})

    def __init__(
        self, interface: Interface, window: Window, numerics: Numerics, exposed: Exposed | None,
        ramps: Sequence[Step], *, coupled: bool,
    ) -> None:  # fmt: skip
        assert interface.friction is not None
        coupling, pairs = interface.coupling, interface.coupling.pairs
        self._law, self._grid = interface.friction, window.grid
        self._substrates = without_layers(interface.solids)
        self._numerics, self.precisions = contact_precision(numerics, window.box, coupled=coupled)
        self._facts = partial(exposed_facts, exposed)
        if exposed is not None:
            self.requires = self.requires | {"exposed_material"}
        self._components, self._periodic = coupling.components, numerics.boundary == "periodic"
        self.directions = f"{coupling.components}z"
        self.fields = NORMAL_FIELDS | friction_fields(coupling.components)
        self._coefficients = {(i, j): interface.pair(i, j) for i, j in pairs}
        self.kernels = surface_kernels(interface, window, pairs)
        tractions = [ALONG[j].name for _, j in pairs]
        self.cost = friction_cost(window.grid.shape, window.box, coupling, self._numerics, pressed_share(ramps))
        self.cost += layers_cost(interface, window, tractions, periodic=self._periodic)

    def start(self) -> None:
        """See `Contact.start`."""
        from eigencontact.solvers.tangential.contact import FrictionalContact
        from eigencontact.solvers.tangential.solver import TangentialOptions

        numerics = self._numerics
        options = TangentialOptions(
            tolerance=numerics.tolerance,
            max_iterations=numerics.max_iterations,
            precision=numerics.precision,
            threads=numerics.threads,
            periodic=self._periodic,
        )
        self._contact = FrictionalContact(
            self._grid, self._coefficients, self._bound, normal_options(numerics), options
        )  # fmt: skip
        self._time, self._scale = 0.0, 1.0
        self._material: NDArray[np.intp] | None = None

    def _bound(self, pressure: FloatArray, before: Sliding) -> FloatArray:
        """Shear bound of the law for scaled tractions."""
        y, x = self._grid.axes()
        state = FrictionState(
            pressure=pressure / self._scale if self._scale != 1.0 else pressure,
            x=x, y=y, slip_distance=before.slip_distance, time=self._time, **self._facts(self._material),
        )  # fmt: skip
        return self._scale * checked_shear_bound(self._law, state)

    def recall(self, last: StepRecord | None, offset: Fields, bulk: Mapping[str, float]) -> Sliding:
        """See `Contact.recall`; before the first step eigenstrain and bulk stress displace the surfaces."""
        from eigencontact.solvers.tangential.contact import Sliding

        moved = self._moved(offset, bulk)
        carried = 0.0 if moved is None else moved
        if last is None:
            initial_state = Sliding.at_rest(self._grid, self._components)
            return replace(initial_state, position=initial_state.position + carried)
        rigid = np.array([last.scalars[displacement] for displacement, _ in MODES])
        position = self._vector(last.fields, "displacement")
        position -= np.einsum("m,mkij->kij", rigid, mode_fields(self._grid, self._components))
        shear = self._vector(last.fields, "shear")
        return Sliding(
            pressure=last.fields["pressure"],
            shear=shear,
            position=position + carried,
            lift=self._contact.lift(shear),
            rigid=rigid,
            slip_distance=last.fields["slip_distance"],
            dissipated=last.fields["dissipated_energy_density"],
        )

    def _sliding_path(self, slide: Slide | None) -> FloatArray | None:
        """Sliding path of body 2 on body 1 for sliding of the whole contact, along the shear directions [m]."""
        if slide is None:
            return None
        along = dict(zip("xy", slide.direction, strict=True))
        return slide.distance * np.array([along[c] for c in self._components])

    def _vector(self, fields: Mapping[str, FloatArray], name: str) -> FloatArray:
        return np.stack([fields[f"{name}_{c}"] for c in self._components])

    def _moved(self, offset: Fields, bulk: Mapping[str, float]) -> FloatArray | None:
        """Tangential displacement of body 1 minus body 2 by interiors and bulk stress [m]; None without both."""
        moved = np.stack([offset[c] for c in self._components]) if offset else None
        if not bulk:
            return moved
        (y, x), (x0, y0) = self._grid.axes(), self._grid.center
        strain = relative_strain(bulk, self._substrates, grid=self._grid)
        along = dragged(strain, x - x0, y - y0)
        stretched = along[["xy".index(c) for c in self._components]]
        return stretched if moved is None else moved + stretched

    def solve(
        self,
        increment: Increment,
        memory: Any,
        offset: Fields,
        *,
        softer: float = 0.0,
        tolerance: float | None = None,
        start: ContactAnswer | None = None,
    ) -> ContactAnswer:
        """See `Contact.solve`."""
        assert increment.control is not None
        assert increment.tangential is not None
        surface = increment.surface
        assert surface.separation is not None
        self._time, self._scale, self._material = increment.times[1], 1.0 + softer, surface.exposed
        scaled = self._contact.step(
            surface.separation + offset["z"] if "z" in offset else surface.separation,
            scaled_forces(increment.control, self._scale),
            scaled_forces(increment.tangential, self._scale),
            _scaled_sliding(memory, self._scale) if softer else memory,
            offset=self._moved(offset, increment.bulk[1]),
            tolerance=tolerance,
            start=None if start is None else _scaled(start.solution, self._scale),
            slide=self._sliding_path(surface.slide),
            moved=surface.moved,
            progress=increment.progress,
        )
        solution = _scaled(scaled, 1.0 / self._scale)
        along = solution.tangential.displacement + solution.tangential_by_pressure
        rows = dict(zip(self._components, range(len(self._components)), strict=True))
        return ContactAnswer(
            tractions={
                "pressure": solution.normal.pressure,
                **{ALONG[c].field: solution.tangential.shear[k] for c, k in rows.items()},
            },
            displacement={
                "z": solution.normal.displacement + solution.sliding.lift,
                **{c: along[k] for c, k in rows.items()},
            },
            memory=solution.sliding,
            solution=solution,
            counts={
                "iterations": normal_work(solution.normal)["iterations"],
                "convolutions": float(solution.normal_convolutions),
                "tangential_convolutions": float(solution.tangential_convolutions),
            },
        )

    def pressed(
        self,
        control: Control,
        separation: FloatArray,
        fields: Fields,
        springs: FloatArray | None,
        start: FloatArray | None,
    ) -> FloatArray:
        """See `Contact.pressed`."""
        if fields:
            separation = separation + self._contact.lift(self._vector(fields, "shear"))
        return self._contact.normal.solve(separation, control, start=start, springs=springs).pressure

    @property
    def softness(self) -> float:
        """See `Contact.softness`."""
        return cell_deflection(self._coefficients["z", "z"], self._grid)

    def results(self, answers: Sequence[ContactAnswer]) -> tuple[dict[str, FloatArray], dict[str, float]]:
        """See `Contact.results`; slip and slip distance are summed over the increments."""
        solutions: list[FrictionalSolution] = [answer.solution for answer in answers]
        last = solutions[-1]
        normal, tangential, sliding = last.normal, last.tangential, last.sliding
        loaded = normal.pressure > 0
        slipping = [(solution.normal.pressure > 0) & ~solution.tangential.stick for solution in solutions]
        moved = [solution.tangential.slip * where for solution, where in zip(solutions, slipping, strict=True)]
        stick = loaded & ~np.any(slipping, axis=0)
        vectors = {
            "displacement": tangential.displacement + last.tangential_by_pressure,
            "shear": tangential.shear,
            "slip": np.sum(moved, axis=0) * loaded,
        }
        fields = {
            "pressure": normal.pressure,
            "gap": normal.gap,
            "displacement_z": normal.displacement + sliding.lift,
            **{f"{name}_{c}": rows[k] for name, rows in vectors.items() for k, c in enumerate(self._components)},
            "slip_distance": sliding.slip_distance,
            "dissipated_energy_density": sliding.dissipated,
            "contact_zone": np.where(stick, _STICK, np.where(loaded, _SLIP, 0.0)),
        }
        scalars = normal_scalars(normal, self._grid, periodic=self._periodic)
        return fields, scalars | self._scalars(solutions) | self._zones(loaded, stick)

    def _scalars(self, solutions: list[FrictionalSolution]) -> dict[str, float]:
        last = solutions[-1]
        forces, rigid = last.tangential.forces, last.tangential.rigid
        certificates = [solution.tangential.report.certificate for solution in solutions]
        normals = [solution.normal.report.certificate for solution in solutions]
        worst = {
            name: max(getattr(certificate, name) for certificate in certificates)
            for name in ("bound", "stick", "alignment", "load")
        }
        return {
            "gap_residual": max(certificate.gap for certificate in normals if certificate is not None),
            "penetration_residual": max(certificate.penetration for certificate in normals if certificate is not None),
            "load_residual": max(worst["load"], *(solution.load for solution in normals if solution is not None)),
            "tangential_load_x": float(forces[0]),
            "tangential_load_y": float(forces[1]),
            "tangential_load": float(np.hypot(forces[0], forces[1])),
            "shift_x": float(rigid[0]),
            "shift_y": float(rigid[1]),
            "shift_magnitude": float(np.hypot(rigid[0], rigid[1])),
            "torsion_moment": float(forces[2]),
            "twist": float(rigid[2]),
            "dissipated_energy": float(last.sliding.dissipated.sum()) * self._grid.cell_area,
            "bound_residual": worst["bound"],
            "stick_residual": worst["stick"],
            "alignment_residual": worst["alignment"],
            "coupling_residual": max(solution.coupling_residual for solution in solutions),
            "coupling_rounds": float(sum(solution.rounds for solution in solutions)),
        }

    def _zones(self, loaded: NDArray[np.bool_], stick: NDArray[np.bool_]) -> dict[str, float]:
        whole = contact_area(loaded, self._grid, periodic=self._periodic)
        inner = contact_area(stick, self._grid, periodic=self._periodic)
        return {
            "stick_radius": radius_of_area(max(inner, 0.0), self._grid),
            "slip_fraction": float(np.clip(1.0 - inner / whole, 0.0, 1.0)) if whole > 0 else 0.0,
        }


def _scaled_sliding(sliding: Sliding, factor: float) -> Sliding:
    """State of a contact with scaled tractions; displacements do not change."""
    names = ("pressure", "shear", "lift", "dissipated")
    return replace(sliding, **{name: factor * getattr(sliding, name) for name in names})


def _scaled(solution: FrictionalSolution, factor: float) -> FrictionalSolution:
    """Solution with scaled tractions, forces and displacements by tractions; motions, gap and slip do not change."""
    if factor == 1.0:
        return solution
    tangential = solution.tangential
    names = ("shear", "displacement", "forces")
    return replace(
        solution,
        normal=scaled_normal(solution.normal, factor),
        tangential=replace(tangential, **{name: factor * getattr(tangential, name) for name in names}),
        sliding=_scaled_sliding(solution.sliding, factor),
        tangential_by_pressure=factor * solution.tangential_by_pressure,
    )
