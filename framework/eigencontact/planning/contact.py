"""Planning an elastic contact: components, grid, and the blocks that its outputs need."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.errors import PlanError, SceneError
from eigencontact.hooks.registry import Registry
from eigencontact.planning.blocks import resolve
from eigencontact.planning.declare import Declaration, left_out
from eigencontact.planning.kernels import PairCoefficients, installed_influence
from eigencontact.planning.plan import Plan, sum_separations
from eigencontact.planning.window import ContactEstimate, automatic_grid, estimate_contact
from eigencontact.plugin import Geometry, HasNativeGrid
from eigencontact.scene.components import build_component
from eigencontact.scene.schema import Body, Scene, Step
from eigencontact.solvers.control import Control

__all__ = ["make_plan"]

FloatArray = NDArray[np.float64]

#: The largest plan that is accepted, as a share of the machine's memory.
_MEMORY_SHARE = 0.9


def make_plan(scene: Scene, registry: Registry) -> Plan:
    """Decide what a scene needs.

    Raises
    ------
    SceneError, PluginError, PlanError
        A component that is refused, a plugin that is missing, an output that nothing provides, a window too large
        for this machine's memory.
    """
    bodies = (_material(scene.body1), _material(scene.body2))
    geometries = tuple(
        build_component(registry, "geometry", table, _where("geometry", i, scene.geometry))
        for i, table in enumerate(scene.geometry)
    )
    observers = tuple(
        (str(table["type"]), build_component(registry, "observer", table, _where("observers", i, scene.observers)))
        for i, table in enumerate(scene.observers)
    )
    pressure = installed_influence(registry, "p")
    normal = PairCoefficients(pressure, bodies, "z")
    grid, reason = _grid(scene, geometries, normal)
    whole = ContactEstimate(-0.5 * grid.size[0], 0.5 * grid.size[0], -0.5 * grid.size[1], 0.5 * grid.size[1])
    touched = _largest_contact(scene, grid, geometries, normal) or whole
    box = (
        min(grid.ny, int(np.ceil(touched.extent[1] / grid.dy * 1.05)) + 4),
        min(grid.nx, int(np.ceil(touched.extent[0] / grid.dx * 1.05)) + 4),
    )
    material = next(body for body in bodies if body is not None)
    blocks, outputs = Declaration(scene, grid, box, geometries, observers, pressure, material).everything()
    plan = Plan(
        scene=scene,
        registry=registry,
        grid=grid,
        grid_reason=reason,
        bodies=bodies,
        geometries=geometries,
        observers=observers,
        influences={"p": pressure},
        groups=resolve(blocks, outputs),
        left_out=left_out(scene, bodies),
    )
    _check_memory(plan)
    return plan


def _where(group: str, index: int, tables: Sequence[object]) -> str:
    return group if len(tables) == 1 else f"{group}.{index}"


def _material(body: Body) -> Material | None:
    if body.rigid:
        return None
    assert body.young_modulus is not None
    assert body.poisson_ratio is not None
    return Material(young_modulus=body.young_modulus, poisson_ratio=body.poisson_ratio)


def _controls(scene: Scene) -> list[Control]:
    return [step_control(step) for step in scene.steps]


def step_control(step: Step) -> Control:
    """Control at the end of one ramp."""
    names = ("normal_load", "approach", "moment_x", "tilt_x", "moment_y", "tilt_y")
    return Control(**{name: getattr(step, name) for name in names})


def _grid(scene: Scene, geometries: tuple[Geometry, ...], normal: PairCoefficients) -> tuple[Grid, str]:
    spec = scene.grid
    native = [geometry.native_grid() for geometry in geometries if isinstance(geometry, HasNativeGrid)]
    if spec.cells is not None:
        nx, ny = spec.cells
        if spec.size is not None:
            dx, dy = spec.size[0] / nx, spec.size[1] / ny
        else:
            assert spec.spacing is not None
            dx, dy = spec.spacing
        return Grid(nx=nx, ny=ny, dx=dx, dy=dy, center=spec.center), "given in the scene"
    if spec.size is not None:
        assert spec.spacing is not None
        nx, ny = (max(1, round(size / pitch)) for size, pitch in zip(spec.size, spec.spacing, strict=True))
        return Grid(nx=nx, ny=ny, dx=spec.size[0] / nx, dy=spec.size[1] / ny, center=spec.center), "given in the scene"
    if native:
        return native[0], "the grid of the measured topography"
    if scene.numerics.boundary == "periodic":
        raise SceneError(
            "grid must be given for a periodic scene (got automatic); its size is the period: give cells and size"
        )
    controls = [control for control in _controls(scene) if control.normal_load != 0.0]
    separation = partial(sum_separations, geometries)
    start = max((_first_window(separation, normal, control) for control in controls), default=1.0)
    grid = automatic_grid(spec, separation, normal, controls, start)
    return grid, f"automatic: {spec.cells_per_contact_radius:g} cells per contact radius, margin {spec.margin:g}"


def _first_window(separation: Any, normal: PairCoefficients, control: Control) -> float:
    """Side of a square window in which load and separation balance [m].

    Found to round-off, so that a scene scaled in length gets the same grid scaled.
    """

    def rises(side: float) -> bool:
        ring = np.array([0.5, -0.5, 0.0, 0.0]) * side
        h = separation(ring, ring[::-1].copy())
        if control.normal_load is not None:
            lift = (
                normal.table(np.zeros(1), np.zeros(1), (0.5 * side, 0.5 * side))[0, 0] * control.normal_load / side**2
            )
        else:
            lift = abs(control.approach or 0.0)
        rise = float(np.min(h)) - float(separation(np.zeros(1), np.zeros(1))[0])
        return rise > float(lift) > 0.0

    low = next((2.0**exponent for exponent in range(-41, 15) if rises(2.0 ** (exponent + 1))), None)
    if low is None:
        return 1.0
    high = 2.0 * low
    while high - low > 1e-14 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if rises(middle) else (middle, high)
    return 2.0 * high


def _largest_contact(
    scene: Scene, grid: Grid, geometries: tuple[Geometry, ...], normal: PairCoefficients
) -> ContactEstimate | None:
    separation = partial(sum_separations, geometries)
    periodic = scene.numerics.boundary == "periodic"
    found: ContactEstimate | None = None
    for control in _controls(scene):
        estimate = estimate_contact(grid, separation, normal, control, periodic=periodic)
        if estimate is not None:
            found = estimate if found is None else found.join(estimate)
    return found


def _check_memory(plan: Plan) -> None:
    import os

    try:
        total = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return
    wanted = plan.cost.memory
    if wanted > _MEMORY_SHARE * total:
        largest = max(plan.blocks, key=lambda block: block.cost.memory)
        raise PlanError(
            f"plan must fit into memory, {total / 2**30:.3g} GiB (got {wanted / 2**30:.3g} GiB, most of it for block "
            f"{largest.name!r}); use fewer cells or depths, or numerics.precision = 'single'"
        )
