"""Which blocks a scene could use, which outputs it wants, and what it leaves out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from eigencontact.convolution import Layout
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.planning.blocks import Block
from eigencontact.planning.cost import normal_cost, sampling_seconds, stress_cost, superposition_cost
from eigencontact.planning.kernels import KernelUse
from eigencontact.planning.regions import RegionLattice, region_lattice
from eigencontact.plugin import Geometry, HasReferencePressure, SurfaceInfluence
from eigencontact.scene.schema import Scene, StressRequest

__all__ = ["CONTACT", "ContactDeclaration", "observer_block", "region_block"]

#: Surface fields of every contact.
CONTACT = frozenset({"pressure", "gap", "displacement_z"})


@dataclass(frozen=True, slots=True)
class ContactDeclaration:
    """Facts of a scene that the blocks of its contact are declared from.

    Attributes
    ----------
    box : (int, int)
        Cells along (y, x) that the contact will occupy, by estimate.
    influence : SurfaceInfluence
        Of the pressure.
    material : Material
        An elastic body, for timing the coefficients.
    strained : tuple of int
        Bodies (1, 2) that have eigenstrain.
    """

    scene: Scene
    grid: Grid
    box: tuple[int, int]
    geometries: Sequence[Geometry]
    influence: SurfaceInfluence
    material: Material
    strained: tuple[int, ...] = ()

    def everything(self) -> tuple[list[Block], dict[str, str]]:
        """Blocks that the contact could use; outputs that are wanted of it, and who asked for each."""
        scene = self.scene
        blocks = [self._separation(), self._normal()]
        outputs = dict.fromkeys(sorted(CONTACT), "every run")
        if scene.output.tangential_displacement:
            blocks.append(self._tangential())
            outputs |= dict.fromkeys(("displacement_x", "displacement_y"), "output.tangential-displacement")
        alone = len(self.geometries) == 1 and not self._periodic and not self.strained
        if alone and isinstance(self.geometries[0], HasReferencePressure):
            blocks.append(self._reference())
            outputs["reference_pressure"] = "pictures"
        for request in scene.stress:
            blocks.append(self._stress(request))
            outputs[f"stress:{request.label}"] = f"[[stress]] {request.label!r}"
        return blocks, outputs

    @property
    def _periodic(self) -> bool:
        return self.scene.numerics.boundary == "periodic"

    def _separation(self) -> Block:
        return Block(
            name="separation",
            runner="separation",
            provides=frozenset({"separation"}),
            why="the initial gap of the geometry " + " + ".join(geometry.key for geometry in self.geometries),
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
            kernels=(KernelUse("displacement z", "pressure p", self.influence.key, text),),
            cost=normal_cost(
                grid.shape, box, periodic=self._periodic, precision=numerics.precision, threads=numerics.threads
            ),
        )

    def _tangential(self) -> Block:
        numerics, key = self.scene.numerics, self.influence.key
        layout = Layout(self.grid.shape, self.grid.shape, periodic=self._periodic)
        sampling = sampling_seconds(self.influence, self.material)
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

    def _stress(self, request: StressRequest) -> Block:
        lattice = region_lattice(request, self.grid)
        sampling = sampling_seconds(self.influence, self.material)
        numerics = self.scene.numerics
        if lattice.points is not None:
            cost = superposition_cost(len(lattice.points), self.box, sampling, threads=numerics.threads)
            text, count = f"{len(lattice.points)} points, superposed directly", 1
        else:
            layout = self._layout(lattice)
            depths = lattice.depths.size
            cost = stress_cost(layout, depths, sampling, precision=numerics.precision, threads=numerics.threads)
            text, count = f"{lattice.target[1]} x {lattice.target[0]} points at {depths} depths", depths
        inner = {f"eigenstrain:{request.label}"} if request.body in self.strained else set()
        return Block(
            name=f"stress-{request.label}",
            runner="stress",
            requires=frozenset({"pressure"} | inner),
            provides=frozenset({f"stress:{request.label}"}),
            why=f"[[stress]] asks for {request.shape} {request.label!r} in body {request.body}",
            kernels=(KernelUse("stress (6 components)", "pressure p", self.influence.key, text, count),),
            cost=cost,
            settings={"request": request, "lattice": lattice},
        )

    def _layout(self, lattice: RegionLattice) -> Layout:
        """Transform from a contact in the middle of the window to the lattice."""
        if self._periodic:
            return Layout(self.grid.shape, self.grid.shape, periodic=True)
        first = [(n - b) // 2 for n, b in zip(self.grid.shape, self.box, strict=True)]
        return Layout(self.box, lattice.target, (lattice.origin[0] - first[0], lattice.origin[1] - first[1]))


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
