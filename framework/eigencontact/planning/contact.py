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
from eigencontact.planning.blocks import Block, resolve
from eigencontact.planning.cost import normal_cost, stress_cost
from eigencontact.planning.kernels import KernelUse, PairCoefficients
from eigencontact.planning.plan import LeftOut, Plan, sum_separations
from eigencontact.planning.window import ContactEstimate, automatic_grid, estimate_contact
from eigencontact.plugin import Geometry, HasNativeGrid, HasReferencePressure, SurfaceInfluence
from eigencontact.scene.components import build_component
from eigencontact.scene.schema import Body, Scene, Step, StressRequest
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
    pressure = _influence(registry, "p")
    normal = PairCoefficients(pressure, bodies, "z")
    grid, reason = _grid(scene, geometries, normal)
    whole = ContactEstimate(-0.5 * grid.size[0], 0.5 * grid.size[0], -0.5 * grid.size[1], 0.5 * grid.size[1])
    touched = _largest_contact(scene, grid, geometries, normal) or whole
    box = (
        min(grid.ny, int(np.ceil(touched.extent[1] / grid.dy * 1.05)) + 4),
        min(grid.nx, int(np.ceil(touched.extent[0] / grid.dx * 1.05)) + 4),
    )
    blocks, outputs = _declare(scene, grid, geometries, observers, box, pressure)
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
        left_out=_left_out(scene, bodies),
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


def _influence(registry: Registry, traction: str) -> SurfaceInfluence:
    """Return the installed influence of one traction component."""
    found = [entry for entry in registry.of_kind("surface-influence") if entry.component.traction == traction]  # type: ignore[attr-defined]
    if len(found) != 1:
        names = ", ".join(f"{entry.key!r} ({entry.origin})" for entry in found) or "none"
        broken = "".join(f"; {item}" for item in registry.broken)
        raise PlanError(f"traction {traction!r} must have one installed surface influence (got {names}){broken}")
    component: SurfaceInfluence = found[0].component()
    return component


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
    """Side of a square window in which load and separation balance, by order of magnitude [m]."""
    for exponent in range(-40, 16):
        side = 2.0**exponent
        ring = np.array([0.5, -0.5, 0.0, 0.0]) * side
        h = separation(ring, ring[::-1].copy())
        if control.normal_load is not None:
            lift = (
                normal.table(np.zeros(1), np.zeros(1), (0.5 * side, 0.5 * side))[0, 0] * control.normal_load / side**2
            )
        else:
            lift = abs(control.approach or 0.0)
        if float(np.min(h)) - float(separation(np.zeros(1), np.zeros(1))[0]) > lift > 0:
            return 2.0 * side
    return 1.0


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


def _declare(
    scene: Scene,
    grid: Grid,
    geometries: tuple[Geometry, ...],
    observers: Sequence[tuple[str, object]],
    box: tuple[int, int],
    pressure: SurfaceInfluence,
) -> tuple[list[Block], dict[str, str]]:
    """Blocks that this scene could use, and the outputs it wants."""
    numerics = scene.numerics
    periodic = numerics.boundary == "periodic"
    effort: dict[str, Any] = {"precision": numerics.precision, "threads": numerics.threads}
    key = pressure.key
    box_text = f"{box[1]} x {box[0]} of {grid.nx} x {grid.ny} cells"
    blocks = [
        Block(
            name="separation",
            runner="separation",
            provides=frozenset({"separation"}),
            why="the initial gap of the geometry " + " + ".join(geometry.key for geometry in geometries),
        ),
        Block(
            name="normal-contact",
            runner="normal-contact",
            requires=frozenset({"separation"}),
            provides=frozenset({"pressure", "gap", "displacement_z"}),
            why="pressure, contact area, approach",
            kernels=(KernelUse("displacement z", "pressure p", key, f"surface, {box_text}"),),
            cost=normal_cost(grid.shape, box, periodic=periodic, **effort),
        ),
    ]
    outputs = dict.fromkeys(("pressure", "gap", "displacement_z"), "every run")
    if scene.output.tangential_displacement:
        blocks.append(
            Block(
                name="tangential-displacement",
                runner="tangential-displacement",
                requires=frozenset({"pressure"}),
                provides=frozenset({"displacement_x", "displacement_y"}),
                why="output.tangential-displacement = true",
                kernels=tuple(KernelUse(f"displacement {c}", "pressure p", key, "surface, whole window") for c in "xy"),
                cost=stress_cost(box, grid.shape, 1, packed=True, **effort),
            )
        )
        outputs |= dict.fromkeys(("displacement_x", "displacement_y"), "output.tangential-displacement")
    if len(geometries) == 1 and isinstance(geometries[0], HasReferencePressure) and not periodic:
        blocks.append(
            Block(
                name="reference-pressure",
                runner="reference-pressure",
                requires=frozenset({"pressure"}),
                provides=frozenset({"reference_pressure"}),
                why=f"geometry {geometries[0].key!r} has a closed form, drawn beside the result",
            )
        )
        outputs["reference_pressure"] = "pictures"
    for request in scene.stress:
        blocks.append(_stress_block(request, grid, box, key, effort))
        outputs[f"stress:{request.label}"] = f"[[stress]] {request.label!r}"
    for number, (name, _) in enumerate(observers):
        blocks.append(
            Block(
                name=f"observer-{number}-{name}",
                runner="observer",
                requires=frozenset({"pressure", "gap", "displacement_z"}),
                provides=frozenset({f"observed:{number}"}),
                why=f"[[observers]] {name!r}",
                settings={"number": number},
            )
        )
        outputs[f"observed:{number}"] = f"[[observers]] {name!r}"
    return blocks, outputs


def _stress_block(request: StressRequest, grid: Grid, box: tuple[int, int], key: str, effort: dict[str, Any]) -> Block:
    from eigencontact.planning.regions import region_lattice

    lattice = region_lattice(request, grid)
    scattered = lattice.points is not None
    if scattered:
        assert lattice.points is not None
        points = len(lattice.points)
        pairs = points * box[0] * box[1] * 0.8
        from eigencontact.planning.blocks import Cost

        cost = Cost(memory=2.5e8 if pairs > 1e6 else 250.0 * pairs, seconds_per_step=9e-7 * pairs)
        text = f"{points} points, superposed directly"
    else:
        cost = stress_cost(box, lattice.target, lattice.depths.size, packed=lattice.on_cells, **effort)
        text = f"{lattice.target[1]} x {lattice.target[0]} points at {lattice.depths.size} depths"
    return Block(
        name=f"stress-{request.label}",
        runner="stress",
        requires=frozenset({"pressure"}),
        provides=frozenset({f"stress:{request.label}"}),
        why=f"[[stress]] asks for {request.shape} {request.label!r} in body {request.body}",
        kernels=(KernelUse("stress (6 components)", "pressure p", key, text, 1 if scattered else lattice.depths.size),),
        cost=cost,
        settings={"request": request, "lattice": lattice},
    )


def _left_out(scene: Scene, bodies: tuple[Material | None, Material | None]) -> list[LeftOut]:
    out = [
        LeftOut(
            "shear tractions q_x, q_y and their kernels", "the scene prescribes no tangential load and has no friction"
        ),
    ]
    elastic = [body for body in bodies if body is not None]
    if len(elastic) == 2 and elastic[0] == elastic[1]:
        out.append(
            LeftOut("a second kernel for body 2", "both bodies have the same constants: one kernel, counted twice")
        )
    if None in bodies:
        number = bodies.index(None) + 1
        out.append(LeftOut(f"deflection and stress of body {number}", "it is rigid"))
    if not scene.stress:
        out.append(LeftOut("sub-surface stress", "no [[stress]] region asks for it"))
    if not scene.output.tangential_displacement:
        out.append(LeftOut("displacement along x and y", "output.tangential-displacement is false"))
    if scene.numerics.boundary == "non-periodic":
        out.append(LeftOut("periodic images", 'numerics.boundary = "non-periodic": the half-space is exact'))
    return out


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
