"""Warnings about the accuracy of a plan, before anything is computed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from eigencontact.core.cautions import Caution
from eigencontact.core.material import contact_modulus
from eigencontact.core.rigid_modes import TANGENTIAL_MODES
from eigencontact.core.units import readable
from eigencontact.execution.blocks.block import Block
from eigencontact.model.bodies import without_layers
from eigencontact.model.model import Model
from eigencontact.model.resolution import (
    FINE,
    cells_above,
    cells_across,
    cells_per_radius,
    edges_of_cells,
    error_above,
    percent,
    pressure_error,
)
from eigencontact.model.sources import Inhomogeneity, Patch
from eigencontact.plugin import HasNativeGrid
from eigencontact.scene.holding import held_steps
from eigencontact.scene.schema import Step
from eigencontact.scene.spacing import normal_control, spaced_by_radius, start_of_normal
from eigencontact.scene.steps import named_ramps

__all__ = ["PROMISE", "coarse_contact", "foreseen", "from_nothing", "worst_above"]

#: Share of the contact modulus that a pressure may reach: strains of a tenth, slopes of a fifth.
_STIFF = 0.2
#: Step at the seam of a periodic window, in root mean square differences of the cells beside it, that is told.
_SEAM = 3.0
#: Increments in which a contact should grow where shear follows from pressure, and the error of its stick radius times
#: their number, where they are even in the load and in the radius: of 0.733 it is 0.707, 0.723 and 0.728 in 5, 10 and
#: 20 of the former, and 0.657, 0.697 and 0.714 of the latter (scene 'fretting-mode-2').
_GROWTH, _PER_INCREMENT, _PER_EVEN_RADIUS = 5, 0.18, 0.53
#: Error of the pressure above an inhomogeneity that is not warned of, and cells across a region.
PROMISE, _ACROSS = 0.02, 4
#: Cells that the length of a law should reach: within one it does nothing, at 1.5 a neighbour weighs .31 of the cell.
_WIDE = 2
#: Error of the print over a region that yields otherwise than its body, times the cells to a radius of the contact: -22
#: and +9 % of that of finite elements were found at 8 and 12, with whole cells at its boundary. A ball of half the
#: yield stress in place of that of 'hard-inclusion-in-plastic-matrix' left 124 and 145 nm there, and leaves 139 and 140
#: nm with cut cells, which have not been compared with elements: the bound stays.
_OF_THE_PRINT = 1.8
#: Part of a cell below which a region touches the surface.
_FLUSH = 1e-3


def foreseen(model: Model, blocks: Iterable[Block]) -> tuple[Caution, ...]:
    """Warnings that follow from a scene before the run; each is one sentence with a code."""
    return (
        *_of_the_contact(model),
        *_of_the_surfaces(model),
        *_of_the_regions(model),
        *_of_the_laws(model),
        *_of_regions_that_yield(model),
        *_of_the_steps(model),
        *(caution for block in blocks for caution in block.foreseen(model)),
    )


def coarse_contact(cells: float) -> Caution:
    """Warning of a contact with few cells to a radius."""
    error = pressure_error(cells)
    words = (
        f"the contact has {cells:.2g} cells per radius, fewer than {FINE:g}: the estimated error of its largest "
        f"pressure is {percent(error)}, and area and edge are resolved to one cell"
    )
    return Caution("contact-cells", words, error)


def _of_the_contact(model: Model) -> Iterator[Caution]:
    """A contact with few cells, or with large strains."""
    contact, interface = model.window.expected, model.interface
    if contact is None or interface is None or interface.measured:
        return
    cells = cells_per_radius(contact, model.grid)
    if cells < FINE * 0.95:
        yield coarse_contact(cells)
    modulus = contact_modulus(*without_layers(interface.solids))
    if contact.peak > _STIFF * modulus:
        words = (
            f"a pressure of {readable(contact.peak, 'Pa')} is expected, {percent(contact.peak / modulus)} of the "
            f"contact modulus {readable(modulus, 'Pa')}: strains are not small, as the "
            "theory assumes; check the units of load, radius and modulus"
        )
        yield Caution("small-strain", words)


def _of_the_surfaces(model: Model) -> Iterator[Caution]:
    """Warn about surfaces finer than the cells and about periodic surfaces that do not match at the window's ends."""
    grid, interface = model.grid, model.interface
    if interface is None:
        return
    measured = [geometry for geometry in interface.geometries if isinstance(geometry, HasNativeGrid)]
    native = [(geometry.key, geometry.native_grid()) for geometry in measured]
    for key, points in native:
        pitch, native_pitch = max(((grid.dx, points.dx), (grid.dy, points.dy)), key=lambda pair: pair[0] / pair[1])
        if pitch > 1.001 * native_pitch:
            words = (
                f"cells of {readable(pitch, 'm')} are wider than the spacing {readable(native_pitch, 'm')} of the "
                f"geometry {key!r}: roughness within a cell is not resolved"
            )
            yield Caution("surface-cells", words)
    if not (native and (model.periodic or grid.repeats_y) and min(grid.shape) > 3):
        return
    y, x = grid.axes()
    ends = [0, 1, -2, -1]
    lines = {"y": interface.separation(x, y[ends])}
    if model.periodic:
        lines["x"] = interface.separation(x[:, ends], y).T
    seams = []
    for axis, (first, second, last_but_one, last) in lines.items():
        step, *neighbours = (float(np.sqrt(np.mean(h**2))) for h in (first - last, last - last_but_one, second - first))
        seams.append((step / (max(neighbours) or np.inf), axis, step, max(neighbours)))
    ratio, axis, step, usual = max(seams)
    if ratio > _SEAM:
        words = (
            f"the surfaces have a step of {readable(step, 'm')} (root mean square) where the periodic window repeats "
            f"along {axis}, but only {readable(usual, 'm')} between the neighbouring cells: the surface is not periodic"
        )
        yield Caution("periodic-seam", words)


@dataclass(frozen=True, slots=True)
class Above:
    """An inhomogeneity below a contact: cells between its top and the surface, and ratios of stiffness."""

    source: Inhomogeneity
    cells: float
    ratios: tuple[float, float]

    @property
    def error(self) -> float:
        """Estimated error of that pressure."""
        return error_above(self.cells, *self.ratios)


def worst_above(model: Model, body: int) -> Above | None:
    """Inhomogeneity of a body whose cells cause the largest error of the pressure above it.

    None without a contact, and where every inhomogeneity touches the surface, has no cells, or has no linear law.
    """
    regions = model.cells.inhomogeneities
    sources = [source for source in regions if source.body == body and source.lattice is not None and not source.whole]
    if not (sources and model.interface):
        return None
    from eigencontact.execution.interiors.swept_cells import stiffness_ratios

    ratios_of: dict[int, tuple[float, float]] = {}
    matrix, candidates = model.bodies.half_space(body), list[Above]()
    for source in sources:
        height = source.shape.bounds[0][2]
        if source.lattice is None or height < _FLUSH * source.lattice.edges[0] or not source.law.linear:
            continue
        ratios = ratios_of.setdefault(id(source.law), stiffness_ratios(matrix, source.law, sources))
        candidates.append(Above(source, float(height / max(edges_of_cells(source, model.grid))), ratios))
    return max(candidates, key=lambda above: above.error, default=None)


def _of_the_regions(model: Model) -> Iterator[Caution]:
    """Regions inside the bodies with few cells."""
    for body in (1, 2):
        worst = worst_above(model, body)
        if worst is not None and worst.error > PROMISE:
            words = (
                f"{worst.source.name!r} has {worst.cells:.2g} cells between its top and the surface: the estimated "
                f"error of the pressure above it is {percent(worst.error)} of the larger of the pressures with and "
                f"without it; {percent(PROMISE)} needs {cells_above(PROMISE, *worst.ratios):.2g} cells"
            )
            yield Caution("inclusion-cells", words, worst.error)
    coarse = [
        (cells_across(source, model.grid), source.name)
        for source in model.sources
        if not isinstance(source.shape, Patch)
    ]
    cells, name = min(coarse, default=(np.inf, ""))
    if cells < _ACROSS * (1.0 - 1e-6):
        words = (
            f"{name!r} has {cells:.2g} cells across its narrowest extent, fewer than {_ACROSS}: only its volume and "
            "its mean stress are resolved"
        )
        yield Caution("inclusion-cells", words)


def _of_the_laws(model: Model) -> Iterator[Caution]:
    """Warn about the shortest averaging radius of laws that spans few cells."""
    lengths = [
        (radius / max(edges_of_cells(source, model.grid)), radius, source.name)
        for source in model.cells.inhomogeneities
        if source.lattice is not None
        for radius in source.law.averaged.values()
    ]
    cells, radius, name = min(lengths, default=(np.inf, 0.0, ""))
    if cells < _WIDE * (1.0 - 1e-6):
        words = (
            f"the length {readable(radius, 'm')} of the law of {name!r} is {cells:.2g} cells, fewer than {_WIDE}: its "
            "means hardly extend beyond a cell, and with softening the result depends on the cell size; set a larger "
            "length or use finer cells"
        )
        yield Caution("law-length", words)


def _of_regions_that_yield(model: Model) -> Iterator[Caution]:
    """Warn about yielding regions in a yielding body, whose residual imprint converges slowly."""
    contact = model.window.expected
    sources = [
        source
        for source in model.cells.inhomogeneities
        if source.body in model.bodies.laws and source.lattice is not None and not isinstance(source.shape, Patch)
    ]
    nonlinear = [source for source in sources if not source.law.linear]
    if not nonlinear or contact is None:
        return
    radius = 0.25 * sum(contact.extent)
    cells, name = min(
        (radius / max(edges_of_cells(source, model.grid)), source.name) for source in nonlinear if source.lattice
    )
    error = _OF_THE_PRINT / cells
    if error > PROMISE:
        words = (
            f"{name!r} has its own yield law in a body that yields, with {cells:.2g} cells per contact radius: the "
            f"estimated error of the residual imprint is {percent(error)}; compare with finer cells"
        )
        yield Caution("law-regions", words, error)


def _of_the_steps(model: Model) -> Iterator[Caution]:
    """Increments too large for a contact that grows under friction, or for a turn of the motion."""
    interface = model.interface
    if interface is None or interface.friction is None:
        return
    names = [name for name, _ in named_ramps(model.scene.steps)]
    steps = held_steps(model.scene.ramps)
    loaded = list(from_nothing(steps))
    if interface.coupling.joins_normal and loaded and not interface.measured:
        graded = (
            frozenset[int]() if model.window.growth is None else spaced_by_radius(model.scene.steps, friction=True)[0]
        )
        errors = {
            number: (_PER_EVEN_RADIUS if number in graded else _PER_INCREMENT) / steps[number].increments
            for number in loaded
            if steps[number].increments < _GROWTH
        }
        worst = max(errors, key=errors.__getitem__, default=None)
        if worst is not None:
            count = steps[worst].increments
            words = (
                f"the contact grows in {count} increment{'s' if count > 1 else ''} in {names[worst]}, and cells that "
                "come into contact within an increment stick at once: the estimated error of the stick radius is "
                f"{percent(errors[worst])}; increase the increments of this step"
            )
            yield Caution("load-steps", words, errors[worst])
    for number in _turns(steps):
        if steps[number].increments == 1:
            words = (
                f"{names[number]} reverses the tangential motion in one increment: the path between its ends, and its "
                "loop, are not resolved; increase its increments"
            )
            yield Caution("load-steps", words)
            return


def from_nothing(steps: Sequence[Step]) -> Iterator[int]:
    """Held steps in which a contact begins."""
    for number, step in enumerate(steps):
        control = normal_control(step)
        if control is not None and getattr(step, control) > 0.0:
            start = start_of_normal(steps[number - 1] if number else None, control)
            if start is not None and start <= 0.0:
                yield number


def _turns(steps: Sequence[Step]) -> Iterator[int]:
    """Steps whose tangential loads or motions reverse those of the previous step."""
    names = [name for mode in TANGENTIAL_MODES for name in mode]
    values = np.array([[getattr(step, name) or 0.0 for name in names] for step in steps])
    moves = np.diff(values, axis=0, prepend=0.0)
    for number in range(1, len(steps)):
        if float((moves[number] * moves[number - 1]).sum()) < 0.0 and _alike(steps[number - 1], steps[number], names):
            yield number


def _alike(first: Step, second: Step, names: Sequence[str]) -> bool:
    """Whether two steps prescribe the same loads and motions."""
    return all((getattr(first, name) is None) == (getattr(second, name) is None) for name in names)
