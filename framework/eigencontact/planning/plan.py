"""The plan of a run: components built, grid chosen, blocks and kernels in order, cost predicted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.errors import EigencontactError, PluginError
from eigencontact.hooks.registry import Registry
from eigencontact.planning.blocks import Block, Cost
from eigencontact.planning.kernels import Bodies, KernelUse
from eigencontact.planning.sources import Source
from eigencontact.plugin import Component, FrictionLaw, Geometry, Observer, SurfaceInfluence
from eigencontact.scene.schema import Scene

__all__ = ["LeftOut", "Plan"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Something this package could model and this run does not."""

    what: str
    why: str


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Everything decided before anything is computed.

    Attributes
    ----------
    scene : Scene
        The scene.
    registry : Registry
        Where its components came from.
    grid : Grid
        Cells, given or chosen.
    bodies : two of Material, LayeredMedium or None
        Elastic constants, the same everywhere or layered; None is rigid.
    geometries, observers, influences
        Components; without geometries there is no contact.
    sources : tuple of Source
        Regions with eigenstrain.
    friction : FrictionLaw or None
        Bound of the shear; None where the contact has no friction.
    groups : list of tuples of Block
        In order; a tuple of more than one block is solved together.
    left_out : sequence of LeftOut
        What is not modelled, and why.
    grid_reason : str
        Where the grid came from.
    files : tuple of Path
        Data files that the scene names.
    """

    scene: Scene
    registry: Registry
    grid: Grid
    grid_reason: str
    bodies: Bodies
    geometries: tuple[Geometry, ...]
    observers: tuple[tuple[str, Observer], ...]
    influences: dict[str, SurfaceInfluence]
    sources: tuple[Source, ...]
    groups: list[tuple[Block, ...]]
    left_out: Sequence[LeftOut]
    friction: FrictionLaw | None = None
    files: tuple[Path, ...] = ()

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self.scene.label

    @property
    def components(self) -> list[Component]:
        """Every plugin component that the plan uses."""
        used: list[Component] = [*self.influences.values(), *self.geometries]
        used += dict.fromkeys(body for body in self.bodies if isinstance(body, Component))
        for source in self.sources:
            used += [source.shape] if isinstance(source.shape, Component) else []
            used.append(source.field)
        used += [] if self.friction is None else [self.friction]
        return used + [observer for _, observer in self.observers]

    def half_space(self, body: int) -> Material:
        """Constants of a body (1 or 2) that is a homogeneous half-space; eigenstrain lies in no other."""
        found = self.bodies[body - 1]
        assert isinstance(found, Material)
        return found

    @property
    def blocks(self) -> list[Block]:
        """Blocks in order of execution."""
        return [block for group in self.groups for block in group]

    @property
    def kernels(self) -> list[KernelUse]:
        """Every influence coefficient that will be built."""
        return [kernel for block in self.blocks for kernel in block.kernels]

    @property
    def steps(self) -> int:
        """Number of load steps, ramps counted in increments."""
        return sum(step.increments for step in self.scene.steps)

    @property
    def cost(self) -> Cost:
        """Predicted memory [bytes] beyond the libraries, and time."""
        return sum((block.cost for block in self.blocks), Cost())

    @property
    def seconds(self) -> float:
        """Predicted wall time of all steps [s]."""
        return self.cost.seconds_once + self.steps * self.cost.seconds_per_step

    def separation(self, travel: tuple[float, float] = (0.0, 0.0)) -> FloatArray:
        """Sum of the geometries on the grid, moved to a place (x, y) [m], ``(ny, nx)`` [m]."""
        y, x = self.grid.axes()
        return sum_separations(self.geometries, x - travel[0], y - travel[1])

    def explain(self) -> str:
        """Return the plan in words."""
        from eigencontact.planning.explain import explain

        return explain(self)

    def to_dict(self) -> dict[str, object]:
        """Return the plan as plain data for JSON."""
        from eigencontact.planning.explain import as_data

        return as_data(self)


def sum_separations(geometries: Sequence[Geometry], x: FloatArray, y: FloatArray) -> FloatArray:
    """Sum of separations at points that broadcast [m]."""
    shape = np.broadcast_shapes(x.shape, y.shape)
    total = np.zeros(shape)
    for geometry in geometries:
        try:
            total += geometry.separation(x, y)
        except EigencontactError:
            raise
        except Exception as problem:
            raise PluginError(
                f"geometry {geometry.key!r} must return numbers that broadcast to shape {shape} "
                f"(got {type(problem).__name__}: {problem})"
            ) from problem
    return total
