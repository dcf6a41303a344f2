"""Which blocks a scene could use, which outputs it wants, and what it leaves out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eigencontact.convolution import Layout
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.planning.blocks import Block, Cost
from eigencontact.planning.bodies import kernel_key, layered_bodies
from eigencontact.planning.cost import (
    friction_cost,
    normal_cost,
    sampling_seconds,
    stress_cost,
    superposition_cost,
)
from eigencontact.planning.coupling import Coupling
from eigencontact.planning.kernels import Bodies, KernelUse, Solid
from eigencontact.planning.layered_cost import layered_sampling_seconds, layered_stress_cost, layered_surface_cost
from eigencontact.planning.regions import RegionLattice, region_lattice
from eigencontact.plugin import Geometry, HasReferencePressure, SurfaceInfluence
from eigencontact.scene.holding import TRAVEL
from eigencontact.scene.schema import Scene, StressRequest

__all__ = ["AT_ONCE", "CONTACT", "ContactDeclaration", "friction_fields", "observer_block", "region_block"]

#: Surface fields of every contact.
CONTACT = frozenset({"pressure", "gap", "displacement_z"})

#: Depths of a close-up whose coefficients are held at once.
AT_ONCE = 16

#: Traction along each direction, and what it is called.
_TRACTIONS = {"x": "q_x", "y": "q_y", "z": "p"}
_WORDS = {"q_x": "shear q_x", "q_y": "shear q_y", "p": "pressure p"}


def friction_fields(coupling: Coupling | None) -> frozenset[str]:
    """Surface fields that a contact with friction has besides those of every contact; none without friction."""
    if coupling is None:
        return frozenset()
    vectors = {f"{name}_{c}" for name in ("displacement", "shear", "slip") for c in coupling.components}
    return frozenset(vectors | {"slip_distance", "dissipated_energy_density", "contact_zone"})


@dataclass(frozen=True, slots=True)
class ContactDeclaration:
    """Facts of a scene that the blocks of its contact are declared from.

    Attributes
    ----------
    box : (int, int)
        Cells along (y, x) that the contact will occupy, by estimate.
    influences : mapping of str to SurfaceInfluence
        By traction: of the pressure, with friction of the shear too.
    bodies : two of Material, LayeredMedium or None
        What the bodies are made of.
    strained : tuple of int
        Bodies (1, 2) that have eigenstrain.
    coupling : Coupling or None
        What friction models; None without friction.
    """

    scene: Scene
    grid: Grid
    box: tuple[int, int]
    geometries: Sequence[Geometry]
    influences: Mapping[str, SurfaceInfluence]
    bodies: Bodies
    strained: tuple[int, ...] = ()
    coupling: Coupling | None = None

    def everything(self) -> tuple[list[Block], dict[str, str]]:
        """Blocks that the contact could use; outputs that are wanted of it, and who asked for each."""
        scene = self.scene
        contact = self._normal() if self.coupling is None else self._frictional(self.coupling)
        blocks = [self._separation(), contact]
        outputs = dict.fromkeys(sorted(CONTACT), "every run")
        outputs |= dict.fromkeys(sorted(friction_fields(self.coupling)), "every run with friction")
        if scene.output.tangential_displacement and self.coupling is None:
            blocks.append(self._tangential())
            outputs |= dict.fromkeys(("displacement_x", "displacement_y"), "output.tangential-displacement")
        alone = len(self.geometries) == 1 and not self._periodic
        if alone and isinstance(self.geometries[0], HasReferencePressure):
            block = self._homogeneous() if layered_bodies(self.bodies) or self.strained else self._reference()
            blocks.append(block)
            outputs |= dict.fromkeys(block.provides, "pictures")
        if self.coupling is not None:
            blocks.append(self._shear_bound())
            outputs["shear_bound"] = "pictures"
            if "reference_pressure" in outputs and not self.coupling.joins_normal:
                blocks.append(self._reference_shear())
                outputs |= dict.fromkeys(("reference_shear_x", "reference_shear_y"), "pictures")
        for request in scene.stress:
            blocks.append(self._stress(request))
            outputs[f"stress:{request.label}"] = f"[[stress]] {request.label!r}"
        return blocks, outputs

    @property
    def _periodic(self) -> bool:
        return self.scene.numerics.boundary == "periodic"

    def _key(self, traction: str) -> str:
        return kernel_key(self.influences[traction], self.bodies)

    def _sampling(self, *bodies: Solid | None) -> float:
        """Time of six stress coefficients at one point [s]; the dearest of these bodies counts."""
        homogeneous = [sampling_seconds(self.influences["p"], body) for body in bodies if isinstance(body, Material)]
        layered = [
            layered_sampling_seconds(self.influences["p"], body, periodic=self._periodic)
            for body in layered_bodies(bodies)
        ]
        return max(homogeneous + layered)

    def _layered(self, tractions: Sequence[str]) -> Cost:
        """Surface coefficients of layered bodies, beyond those of homogeneous ones."""
        influences = [self.influences[name] for name in tractions]
        return layered_surface_cost(influences, self.bodies, self.grid.shape, self.box, periodic=self._periodic)

    def _separation(self) -> Block:
        rolls = any(getattr(step, name) is not None for step in self.scene.steps for name in TRAVEL)
        return Block(
            name="separation",
            runner="separation",
            provides=frozenset({"separation"}),
            why="the initial gap of the geometry "
            + " + ".join(geometry.key for geometry in self.geometries)
            + (", which rolls along the surface" if rolls else ""),
            settings={"rolls": rolls},
        )

    def _normal(self) -> Block:
        grid, box, numerics = self.grid, self.box, self.scene.numerics
        text = f"surface, {box[1]} x {box[0]} of {grid.nx} x {grid.ny} cells"
        return Block(
            name="normal-contact",
            runner="normal-contact",
            requires=frozenset({"separation"} | ({"residual_displacement_z"} if self.strained else set())),
            provides=CONTACT,
            why="pressure, contact area, approach",
            kernels=(KernelUse("displacement z", "pressure p", self._key("p"), text),),
            cost=normal_cost(
                grid.shape, box, periodic=self._periodic, precision=numerics.precision, threads=numerics.threads
            )
            + self._layered(["p"]),
        )

    def _frictional(self, coupling: Coupling) -> Block:
        grid, box, numerics = self.grid, self.box, self.scene.numerics
        needed = {"separation"}
        if self.strained:
            needed |= {"residual_displacement_z"}
            needed |= {f"residual_displacement_{c}" for c in "xy" if coupling.level != "none"}
        text = f"surface, {box[1]} x {box[0]} of {grid.nx} x {grid.ny} cells"
        uses = [(i, _TRACTIONS[j]) for i, j in coupling.pairs]
        return Block(
            name="frictional-contact",
            runner="frictional-contact",
            requires=frozenset(needed),
            provides=CONTACT | friction_fields(coupling),
            why="pressure and shear with friction, stick and slip",
            kernels=tuple(
                KernelUse(f"displacement {i}", _WORDS[name], self._key(name), text) for i, name in uses
            ),
            cost=friction_cost(
                grid.shape, box, coupling.pairs, periodic=self._periodic, precision=numerics.precision,
                threads=numerics.threads,
            )
            + self._layered([name for _, name in uses]),
            settings={"coupling": coupling},
        )  # fmt: skip

    def _tangential(self) -> Block:
        numerics, key = self.scene.numerics, self._key("p")
        layout = Layout(self.grid.shape, self.grid.shape, periodic=self._periodic)
        sampling = self._sampling(*self.bodies)
        return Block(
            name="tangential-displacement",
            runner="tangential-displacement",
            requires=frozenset({"pressure"}),
            provides=frozenset({"displacement_x", "displacement_y"}),
            why="output.tangential-displacement = true",
            kernels=tuple(KernelUse(f"displacement {c}", "pressure p", key, "surface, whole window") for c in "xy"),
            cost=stress_cost(layout, 1, sampling, precision=numerics.precision, threads=numerics.threads, kernels=2),
        )

    def _reference(self) -> Block:
        return Block(
            name="reference-pressure",
            runner="reference-pressure",
            requires=frozenset({"pressure"}),
            provides=frozenset({"reference_pressure"}),
            why=f"geometry {self.geometries[0].key!r} has a closed form, drawn beside the result",
        )

    def _homogeneous(self) -> Block:
        what = "on the bare substrate" if layered_bodies(self.bodies) else "without inclusions and eigenstrain"
        return Block(
            name="homogeneous-pressure",
            runner="reference-pressure",
            requires=frozenset({"pressure"}),
            provides=frozenset({"homogeneous_pressure"}),
            why=f"geometry {self.geometries[0].key!r} has a closed form {what}, drawn beside the result",
        )

    def _shear_bound(self) -> Block:
        return Block(
            name="shear-bound",
            runner="shear-bound",
            requires=frozenset({"pressure", "slip_distance"}),
            provides=frozenset({"shear_bound"}),
            why="what the friction law allows, drawn beside the shear",
        )

    def _reference_shear(self) -> Block:
        return Block(
            name="reference-shear",
            runner="reference-shear",
            requires=frozenset({"pressure", "shear_bound"}),
            provides=frozenset({"reference_shear_x", "reference_shear_y"}),
            why=f"geometry {self.geometries[0].key!r} has a closed form of the shear while it rises in one direction",
        )

    def _stress(self, request: StressRequest) -> Block:
        lattice = region_lattice(request, self.grid)
        tractions = ("p",) if self.coupling is None else self.coupling.tractions
        body = self.bodies[request.body - 1]
        sampling = self._sampling(body)
        numerics = self.scene.numerics
        if lattice.points is not None:
            sampling *= len(tractions)
            cost = superposition_cost(len(lattice.points), self.box, sampling, threads=numerics.threads)
            text, count, tables = f"{len(lattice.points)} points, superposed directly", 1, len(lattice.points)
        else:
            my, mx = lattice.finer
            layout = self._layout(lattice)
            depths = lattice.depths.size * my * mx
            cost = stress_cost(
                layout, depths, sampling, precision=numerics.precision, threads=numerics.threads,
                tractions=len(tractions),
            )  # fmt: skip
            if lattice.finer != (1, 1):  # made anew in each step, few depths at a time
                seconds = cost.seconds_once + cost.seconds_per_step
                cost = Cost(seconds_per_step=seconds, transient=cost.memory * min(1.0, AT_ONCE / depths))
            text = f"{lattice.target[1]} x {lattice.target[0]} points at {lattice.depths.size} depths"
            count = depths
            tables = depths
        cost += layered_stress_cost(
            self.influences["p"], body, tables=tables * len(tractions), periodic=self._periodic,
            threads=numerics.threads, anew=lattice.points is not None,
        )  # fmt: skip
        inner = {f"eigenstrain:{request.label}"} if request.body in self.strained else set()
        return Block(
            name=f"stress-{request.label}",
            runner="stress",
            requires=frozenset({"pressure"} | {f"shear_{name[-1]}" for name in tractions if name != "p"} | inner),
            provides=frozenset({f"stress:{request.label}"}),
            why=f"[[stress]] asks for {request.shape} {request.label!r} in body {request.body}",
            kernels=tuple(
                KernelUse("stress (6 components)", _WORDS[name], kernel_key(self.influences[name], [body]), text, count)
                for name in tractions
            ),
            cost=cost,
            settings={"request": request, "lattice": lattice, "tractions": tractions},
        )

    def _layout(self, lattice: RegionLattice) -> Layout:
        """Transform from a contact in the middle of the window to the lattice."""
        if self._periodic:
            return Layout(self.grid.shape, self.grid.shape, periodic=True)
        first = [(n - b) // 2 for n, b in zip(self.grid.shape, self.box, strict=True)]
        target = tuple(-(-n // m) for n, m in zip(lattice.target, lattice.finer, strict=True))
        return Layout(self.box, (target[0], target[1]), (lattice.origin[0] - first[0], lattice.origin[1] - first[1]))


def region_block(request: StressRequest, grid: Grid) -> Block:
    """Fields of a region in a scene without contact: those of eigenstrain, and what is read off them."""
    return Block(
        name=f"stress-{request.label}",
        runner="region",
        requires=frozenset({f"eigenstrain:{request.label}"}),
        provides=frozenset({f"stress:{request.label}"}),
        why=f"[[stress]] asks for {request.shape} {request.label!r} in body {request.body}",
        settings={"request": request, "lattice": region_lattice(request, grid)},
    )


def observer_block(number: int, name: str, fields: frozenset[str]) -> Block:
    """One observer, which sees the surface fields."""
    return Block(
        name=f"observer-{number}-{name}",
        runner="observer",
        requires=fields,
        provides=frozenset({f"observed:{number}"}),
        why=f"[[observers]] {name!r}",
        settings={"number": number},
    )
