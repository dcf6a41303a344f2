"""Random frictional contacts: scene k from seed k, with loads that friction can carry by construction."""

from dataclasses import dataclass, field, fields, replace

import numpy as np

from eigencontact.core.grid import Box, Grid
from eigencontact.core.material import Material, contact_modulus
from eigencontact.errors import NotConverged
from eigencontact.model.installed import installed_influence
from eigencontact.model.kernels import PairCoefficients
from eigencontact.scene.installed import installed_plugins
from eigencontact.solvers.control import Control, mode_field
from eigencontact.solvers.normal import NormalOptions, NormalSolver
from eigencontact.solvers.solution import SolverOptions
from eigencontact.solvers.tangential.compliance import MatrixOperator
from eigencontact.solvers.tangential.contact import FrictionalContact, FrictionalSolution, Sliding
from eigencontact.solvers.tangential.control import MODES, TangentialControl, mode_fields
from eigencontact.solvers.tangential.solver import TangentialOptions

TRACTIONS = {"x": "q_x", "y": "q_y", "z": "p"}
COUPLINGS = {
    "none": ("xx", "yy", "zz"),
    "partial": ("xx", "yy", "zz", "xy", "yx"),
    "one-way": ("xx", "yy", "zz", "xy", "yx", "xz", "yz"),
    "full": tuple(i + j for i in "xyz" for j in "xyz"),
}


def kernels(bodies, coupling):
    """Influence coefficients of two bodies for one level of coupling."""
    registry = installed_plugins()
    influence = {c: installed_influence(registry, name) for c, name in TRACTIONS.items()}
    return {(i, j): PairCoefficients(influence[j], bodies, i) for i, j in COUPLINGS[coupling]}


@dataclass(frozen=True, kw_only=True)
class Scene:
    """A contact and the ends of its increments."""

    seed: int
    grid: Grid
    bodies: tuple
    separation: np.ndarray
    shape: str
    friction: float
    cap: float
    coupling: str
    steps: list

    def bound(self, pressure, _before):
        return np.minimum(self.friction * pressure, self.cap)

    def contact(self, tolerance=1e-6):
        return FrictionalContact(
            self.grid,
            kernels(self.bodies, self.coupling),
            self.bound,
            NormalOptions(tolerance=tolerance, allow_contact_at_edge=True, max_iterations=2000, threads=1),
            TangentialOptions(tolerance=tolerance, threads=1),
        )

    def __str__(self):
        n = f"{self.grid.nx} x {self.grid.ny}"
        nu = ", ".join("rigid" if b is None else f"{b.young_modulus:.2g} {b.poisson_ratio:.2f}" for b in self.bodies)
        return f"scene {self.seed}: {self.shape}, {n}, {self.coupling}, friction {self.friction:.3g}, bodies {nu}"


def make_scene(seed):
    """Scene of one seed; solves frictionless contacts to know what friction can carry."""
    rng = np.random.default_rng(seed)
    grid, size = _grid(rng)
    bodies = _bodies(rng)
    modulus = contact_modulus(*bodies)
    shape, separation, load = _geometry(rng, grid, size, modulus)
    friction = float(10 ** rng.uniform(-3, np.log10(5)))
    coupling = str(rng.choice(list(COUPLINGS), p=[0.1, 0.25, 0.15, 0.5]))
    mean = load / (np.pi * size**2)
    cap = friction * mean * rng.uniform(0.5, 1.5) if rng.random() < 0.15 else np.inf
    count = int(rng.integers(1, 7))
    normals = _normal_path(rng, count, load, size)
    # Under full coupling shear changes the pressure, and by prescribed approach the load: keep well below the limit.
    delicate = coupling == "full" and shape != "sphere"
    solver = NormalSolver(
        grid, kernels(bodies, "none")["z", "z"],
        NormalOptions(tolerance=1e-4, allow_contact_at_edge=True, max_iterations=2000, threads=1),
    )  # fmt: skip
    pressures, controls = [], []
    by_approach = rng.random() < 0.3
    for given in normals:
        control, solution = given, solver.solve(separation, given)
        pressures.append(solution.pressure)
        if by_approach:
            control = Control(
                approach=solution.approach, moment_x=given.moment_x, moment_y=given.moment_y,
                tilt_x=given.tilt_x, tilt_y=given.tilt_y,
            )  # fmt: skip
        controls.append(control)
    most = 0.5 if coupling == "full" and (by_approach or delicate) else rng.choice([0.5, 0.9, 0.99])
    tangential = _tangential_path(
        rng, grid, [np.minimum(friction * p, cap) for p in pressures], most, friction * mean * size / modulus, size
    )
    return Scene(
        seed=seed, grid=grid, bodies=bodies, separation=separation, shape=shape, friction=friction, cap=float(cap),
        coupling=coupling, steps=list(zip(controls, tangential, strict=True)),
    )  # fmt: skip


def hardened(scene):
    """The same contact fully coupled, on a rigid body, friction above 1: pressure and shear change each other most."""
    rng = np.random.default_rng(10_000 + scene.seed)
    friction = max(scene.friction, float(10 ** rng.uniform(0, np.log10(5))))
    body = Material(young_modulus=scene.bodies[0].young_modulus, poisson_ratio=rng.uniform(0, 0.25))
    more = max(1.0, friction / scene.friction)
    steps = []
    for control, tangential in scene.steps:
        shifts = {name: getattr(tangential, name) for name, _ in MODES}
        longer = {name: None if value is None else more * value for name, value in shifts.items()}
        steps.append((control, replace(tangential, **longer)))
    return replace(scene, friction=friction, cap=np.inf, coupling="full", bodies=(body, None), steps=steps)


def _grid(rng):
    """Grid of 16 to 64 cells a side, square or not, and a contact radius that fits."""
    nx = int(rng.integers(16, 65))
    ny = nx if rng.random() < 0.5 else int(rng.integers(max(16, nx // 2), min(64, 2 * nx) + 1))
    dx = 10 ** rng.uniform(-7, -2)
    dy = dx if rng.random() < 0.6 else dx * rng.uniform(0.5, 2.0)
    grid = Grid(nx=nx, ny=ny, dx=dx, dy=dy)
    return grid, 0.5 * min(nx * dx, ny * dy) * rng.uniform(0.35, 0.75)


def _bodies(rng):
    young = 10 ** rng.uniform(6, 12)
    first = Material(young_modulus=young, poisson_ratio=rng.uniform(0, 0.5))
    second = Material(young_modulus=young * 10 ** rng.uniform(-2, 2), poisson_ratio=rng.uniform(0, 0.5))
    return first, None if rng.random() < 0.3 else second


def _geometry(rng, grid, size, modulus):
    """Kind of shape, separation, and a load that presses about `size` into contact."""
    y, x = grid.axes()
    kind = str(rng.choice(["sphere", "ellipse", "punch", "rough"]))
    radius = size * 10 ** rng.uniform(0.5, 2.5)
    separation = (x**2 + y**2) / (2 * radius)
    load = 4 * modulus * size**3 / (3 * radius)
    if kind == "ellipse":
        ratio, turn = rng.uniform(1.0, 3.0), rng.uniform(0, np.pi)
        u, v = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
        separation = (u**2 * ratio + v**2 / ratio) / (2 * radius)
        load /= ratio
    if kind == "punch":
        separation = np.maximum(0.0, np.hypot(x, y) - rng.uniform(0.3, 0.7) * size) ** 2 / (2 * radius)
    if kind == "rough":
        separation = separation + _roughness(rng, grid) * size**2 / radius * 10 ** rng.uniform(-2.5, 0.3)
        load *= rng.uniform(0.3, 1.0)
    return kind, separation, load


def _roughness(rng, grid):
    """Self-affine surface of unit standard deviation."""
    noise = np.fft.fft2(rng.normal(size=grid.shape))
    wave = np.hypot(*np.meshgrid(np.fft.fftfreq(grid.nx, grid.dx), np.fft.fftfreq(grid.ny, grid.dy)))
    longest = np.sort(np.unique(wave))[1]
    power = np.zeros(grid.shape)
    power[wave > 0] = np.maximum(wave[wave > 0], 3 * longest) ** -rng.uniform(1.3, 1.9)
    rough = np.fft.ifft2(noise * power).real
    return rough / rough.std()


def _factors(rng, count):
    """Factors on an amplitude: rising, falling, to and fro, or at random."""
    kind = rng.integers(5)
    step = np.arange(1, count + 1) / count
    if kind == 0:
        return step
    if kind == 1:
        return np.concatenate([[1.0], step[::-1][: count - 1] * 0.9])
    if kind == 2:
        return np.cos(np.pi * np.arange(count)) * rng.uniform(0.5, 1.0)
    if kind == 3:
        return np.sin(rng.uniform(0, 2 * np.pi) + 2 * np.pi * step)
    return rng.uniform(-1, 1, count)


def _normal_path(rng, count, load, size):
    """Normal controls: constant, rising, falling or wandering load; with tilts or moments in some."""
    kind = rng.integers(4)
    share = [np.ones(count), np.linspace(0.3, 1.0, count), np.linspace(1.0, 0.3, count), rng.uniform(0.2, 1.0, count)]
    arm = 0.15 * size * rng.uniform(-1, 1, 2) if rng.random() < 0.35 else None
    return [
        Control(normal_load=load * s)
        if arm is None
        else Control(normal_load=load * s, moment_x=load * s * arm[0], moment_y=load * s * arm[1])
        for s in share[kind]
    ]


def _tangential_path(rng, grid, bounds, most, length, size):
    """Tangential controls: each mode by a force that the bounds can carry, or by a displacement."""
    count = len(bounds)
    modes = mode_fields(grid, "xy")
    scales = np.array([1.0, 1.0, 1.0 / size])
    amounts = rng.normal(size=3) * scales * (rng.random(3) < 0.7)
    paths = np.stack([_factors(rng, count) if rng.random() < 0.5 else np.ones(count) for _ in range(3)])
    amplitude = length * 10 ** rng.uniform(-2, 1)
    kinds = rng.random(3) < 0.5
    controls = []
    for k, bound in enumerate(bounds):
        if rng.random() < 0.1:
            kinds = rng.random(3) < 0.5
        motion = amounts * paths[:, k]
        field = np.einsum("m,mkij->kij", motion, modes)
        size_ = np.hypot(*field)
        share = most * min(1.0, float(np.linalg.norm(motion / scales)))
        traction = share * bound * field / np.maximum(size_, 1e-300)
        forces = np.einsum("mkij,kij->m", modes, traction) * grid.cell_area
        given = {
            MODES[m][1 if kinds[m] else 0]: float(forces[m] if kinds[m] else amplitude * motion[m]) for m in range(3)
        }
        controls.append(TangentialControl(**given))
    return controls


@dataclass
class Course:
    """What a history took, and its last increment."""

    steps: int = 0
    halvings: int = 0
    rounds: int = 0
    most_rounds: int = 0
    tangential: int = 0
    normal: int = 0
    before: Sliding | None = field(default=None, repr=False)
    last: FrictionalSolution | None = field(default=None, repr=False)


def follow(scene, *, tolerance=1e-6, depth=4):
    """Solve all increments of a scene; those that do not converge are halved, up to `depth` times."""
    contact, course = scene.contact(tolerance), Course()
    for control, tangential in scene.steps:
        _advance(contact, scene, course, (control, tangential), depth)
    return course


def _advance(contact, scene, course, target, depth):
    before = course.last.sliding if course.last else None
    try:
        found = contact.step(scene.separation, *target, before)
    except NotConverged:
        if depth == 0:
            raise
        course.halvings += 1
        _advance(contact, scene, course, _halfway(target, course.last), depth - 1)
        _advance(contact, scene, course, target, depth - 1)
        return
    course.before, course.last = before, found
    course.steps += 1
    course.rounds += found.rounds
    course.most_rounds = max(course.most_rounds, found.rounds)
    course.tangential += found.tangential_convolutions
    course.normal += found.normal_convolutions


def _halfway(target, last):
    """Controls halfway from the last solution; before the first one nothing touches."""
    reached = {}
    if last is not None:
        reached = {f.name: getattr(last.normal, f.name) for f in fields(Control)}
        for mode, names in enumerate(MODES):
            values = (last.tangential.rigid[mode], last.tangential.forces[mode])
            reached |= dict(zip(names, map(float, values), strict=True))
    return tuple(
        type(control)(**{
            f.name: None if (value := getattr(control, f.name)) is None else 0.5 * (reached.get(f.name, 0.0) + value)
            for f in fields(control)
        })
        for control in target
    )  # fmt: skip


def errors(scene, course):
    """What the last increment violates, from the tractions alone, by one convolution with all influence coefficients.

    Gap of loaded cells and overlap of others over the largest deflection; slip of sticking cells, and slip that does
    not oppose the shear, over the largest tangential displacement; shear beyond its bound over the largest bound.
    """
    last, grid = course.last, scene.grid
    operator = MatrixOperator(grid, kernels(scene.bodies, scene.coupling), "xyz", "xyz", SolverOptions(threads=1))
    whole, p, q = Box(0, grid.ny, 0, grid.nx), last.normal.pressure, last.tangential.shear
    moved = operator.apply(np.stack([*q, p]), whole, whole)
    tilts = (last.normal.approach, last.normal.tilt_x, last.normal.tilt_y)
    gap = scene.separation + moved[2] - sum(value * mode_field(mode, grid) for mode, value in enumerate(tilts))
    loaded, deflection = p > 0, last.normal.displacement[p > 0].max()
    position = moved[:2] - np.einsum("m,mkij->kij", last.tangential.rigid, mode_fields(grid, "xy"))
    before = course.before or Sliding.at_rest(grid)
    slip, size, bound = position - before.position, np.hypot(*q), scene.bound(p, before)
    largest = np.hypot(*last.tangential.displacement)[loaded].max() or 1.0  # 0 where there is no shear at all
    stick = loaded & (size < bound * (1 - 1e-9))
    unit = q / np.where(size > 0, size, 1.0)
    along = np.einsum("kij,kij->ij", slip, unit)
    across = np.hypot(*(slip - along * unit))
    return {
        "gap": np.abs(gap[loaded]).max() / deflection,
        "overlap": max(0.0, -gap[~loaded].min(initial=0.0)) / deflection,
        "stick": np.hypot(*slip)[stick].max(initial=0.0) / largest,
        "across": across[loaded & ~stick].max(initial=0.0) / largest,
        "along": max(0.0, along[loaded & ~stick].max(initial=0.0)) / largest,
        "bound": (size - bound).max() / bound.max(),
    }
