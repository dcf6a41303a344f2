"""The window of a contact, and how much of it the contact will fill."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError
from eigencontact.model.bodies import without_layers
from eigencontact.model.contact_estimate import ContactEstimate
from eigencontact.model.contact_growth import ContactGrowth, contact_growth
from eigencontact.model.grids import given_grid
from eigencontact.model.kernels import Bodies, PairCoefficients
from eigencontact.model.resolution import refuse_coarse
from eigencontact.model.separation import sum_separations
from eigencontact.model.window import Separation, automatic_grid, close_estimate, estimate_contact
from eigencontact.plugin import Geometry, HasNativeGrid, SurfaceInfluence
from eigencontact.scene.holding import held_steps, held_travel
from eigencontact.scene.schema import Scene, Step
from eigencontact.scene.steps import named_ramps, spaced_by_radius
from eigencontact.solvers.control import Control

__all__ = ["ContactWindow", "contact_window", "contacts_of_steps"]

FloatArray = NDArray[np.float64]

#: Share of the window that a contact takes at least where a coarse solve over all of it shows its size.
_PLAIN = 0.3
#: Cells around the estimate of a contact, which itself is larger by some coarse cells.
_AROUND = 4


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactWindow:
    """Window of a contact.

    Attributes
    ----------
    grid : Grid
        Its cells.
    reason : str
        Where they came from.
    box : (int, int)
        Cells along (y, x) that the contact will occupy, by estimate.
    expected : ContactEstimate or None
        The largest contact of the load history, on homogeneous bodies or layers, without what lies in them; None where
        none is found.
    growth : ContactGrowth or None
        Of its radius; None where no load step is even in the radius.
    """

    grid: Grid
    reason: str
    box: tuple[int, int]
    expected: ContactEstimate | None = None
    growth: ContactGrowth | None = None


def contact_window(
    scene: Scene, bodies: Bodies, geometries: tuple[Geometry, ...], pressure: SurfaceInfluence
) -> ContactWindow:
    """Choose window and box of the contact of a scene by coarse solves; eigenstrain is not looked at here."""
    normal = PairCoefficients(pressure, bodies, "z")
    grid, reason = _grid(scene, geometries, normal)
    whole = ContactEstimate(-0.5 * grid.size[0], 0.5 * grid.size[0], -0.5 * grid.size[1], 0.5 * grid.size[1])
    found = contacts_of_steps(scene, grid, geometries, normal)
    touched = reduce(ContactEstimate.join, [contact for contact, _, _ in found]) if found else whole
    box = tuple(
        _box_size(extent / edge, size)
        for extent, edge, size in zip(touched.extent[::-1], (grid.dy, grid.dx), grid.shape, strict=True)
    )
    expected = _expected(found, grid, normal)
    measured = any(isinstance(geometry, HasNativeGrid) for geometry in geometries)
    if expected is not None and not (measured or scene.numerics.allow_coarse):
        refuse_coarse(expected, grid)
    growth = None if measured else _growth(scene, found)
    _refuse_radius(scene, growth)
    return ContactWindow(grid=grid, reason=reason, box=(box[0], box[1]), expected=expected, growth=growth)


def _box_size(cells: float, size: int) -> int:
    """Cells along one side of a box that holds a contact of so many cells, by coarse estimate.

    A contact in the middle of the window has an even number of cells where the window has. Half of the coefficients are
    images of the others then, and the price halves.
    """
    box = int(np.ceil(cells)) + _AROUND
    return min(size, box + (size - box) % 2)


def _controls(scene: Scene) -> list[Control]:
    steps = held_steps(scene.ramps) if scene.friction is not None else scene.ramps
    return [step_control(step) for step in steps]


def step_control(step: Step) -> Control:
    """Control at the end of one ramp."""
    names = ("normal_load", "approach", "moment_x", "tilt_x", "moment_y", "tilt_y")
    return Control(**{name: getattr(step, name) for name in names})


def _grid(scene: Scene, geometries: tuple[Geometry, ...], normal: PairCoefficients) -> tuple[Grid, str]:
    spec = scene.grid
    given = given_grid(spec)
    if given is not None:
        return given, "given in the scene"
    native = next((geometry for geometry in geometries if isinstance(geometry, HasNativeGrid)), None)
    if native is not None:
        return native.native_grid(), f"the grid that the geometry {native.key!r} brings"
    if scene.numerics.boundary == "periodic":
        raise SceneError(
            "grid must be given for a periodic scene (got automatic); its size is the period: give cells and size"
        )
    pairs = zip(_controls(scene), held_travel(scene.ramps), strict=True)
    controls = [(control, travel) for control, travel in pairs if 0.0 not in (control.normal_load, control.approach)]
    separation = partial(sum_separations, geometries)
    # A first guess needs no layers, and asks for cells of a hundred sizes.
    bare = PairCoefficients(normal.influence, without_layers(normal.bodies), "z")
    start = max((_first_window(separation, bare, control) for control, _ in controls), default=1.0)
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


def contacts_of_steps(
    scene: Scene, grid: Grid, geometries: tuple[Geometry, ...], normal: PairCoefficients
) -> list[tuple[ContactEstimate, Control, Separation]]:
    """Contact at the end of each step, on coarse cells over the whole window, and what it is the contact of."""
    periodic = scene.numerics.boundary == "periodic"
    found: list[tuple[ContactEstimate, Control, Separation]] = []
    for control, (x0, y0) in zip(_controls(scene), held_travel(scene.ramps), strict=True):

        def separation(x: FloatArray, y: FloatArray, x0: float = x0, y0: float = y0) -> FloatArray:
            return sum_separations(geometries, x - x0, y - y0)

        estimate = estimate_contact(grid, separation, normal, control, periodic=periodic)
        if estimate is not None:
            found.append((estimate, control, separation))
    return found


def _growth(scene: Scene, found: Sequence[tuple[ContactEstimate, Control, Separation]]) -> ContactGrowth | None:
    """Growth of the contact where a load step is even in its radius."""
    if not (found and any(spaced_by_radius(scene.steps, friction=scene.friction is not None))):
        return None
    contact, control, separation = max(found, key=lambda one: min(one[0].extent))
    growth, loaded = contact_growth(separation, contact, control), [one for one in found if one[1].normal_load]
    if growth is None or control.normal_load is not None or not loaded:
        return growth
    # The largest contact has no load of its own: another step gives the scale of the loads.
    contact, control, _ = max(loaded, key=lambda one: min(one[0].extent))
    at_contact = float(np.interp(0.5 * np.sqrt(np.prod(contact.extent)), growth.radius, growth.normal_load))
    assert control.normal_load is not None
    return replace(growth, normal_load=growth.normal_load * control.normal_load / at_contact)


def _refuse_radius(scene: Scene, growth: ContactGrowth | None) -> None:
    if growth is not None:
        return
    for where, step in named_ramps(scene.steps):
        if step.spacing == "radius" and step.increments > 1:
            raise SceneError(
                f"{where}.spacing must be 'even' unless the gap rises on all sides of one place (got 'radius', and a "
                "contact without one radius); leave it out"
            )


def _expected(
    found: Sequence[tuple[ContactEstimate, Control, Separation]], grid: Grid, normal: PairCoefficients
) -> ContactEstimate | None:
    """The largest of the contacts; looked at closely where the window shows no more than some cells of it."""
    if not found:
        return None
    contact, control, separation = max(found, key=lambda one: min(one[0].extent))
    if max(share / side for share, side in zip(contact.extent, grid.size, strict=True)) > _PLAIN:
        return contact
    return close_estimate(grid, separation, normal, control) or contact
