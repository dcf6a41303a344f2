"""Advice in the error of a contact that reaches the edge of its window: a load that fits, a larger window."""

from __future__ import annotations

from dataclasses import replace
from math import floor, log10

from eigencontact.core.units import readable
from eigencontact.errors import DomainTooSmall
from eigencontact.execution.blocks.step import Step
from eigencontact.model.model import Model
from eigencontact.plugin import HasNativeGrid
from eigencontact.solvers.coarse_contact import estimate_contact
from eigencontact.solvers.control import Control

__all__ = ["load_that_fits", "with_room"]


#: Cells each way of the solves that look for a load that fits, the smallest part of the load, and the halvings of its
#: logarithm: the load is found to 3 %.
_CELLS, _LEAST, _HALVINGS = 144, 1e-3, 8
#: Part of the estimated load that is recommended: what lies between the cells of the estimate is not seen by it.
_SAFE = 0.9


def with_room(problem: DomainTooSmall, model: Model, step: Step) -> DomainTooSmall:
    """Error that also names the load step, a possible load, and changes of the scene."""
    if step.control is None:
        return problem
    name, value, unit = _driven(step.control)
    unit = model.grid.unit(unit)
    fits = load_that_fits(model, step)
    lower = f"lower the {name}"
    if fits is None:
        lower = f"no {name} from {readable(_LEAST * value, unit)} on keeps it inside, as for surfaces flat on the whole"
    elif value:
        lower += f" (about {readable(fits, unit)} fits)"
    window = " x ".join(readable(side, "m") for side in model.grid.sides)
    edges = " and ".join(problem.sides)
    return DomainTooSmall(
        f"contact must stay inside the window (in load step {step.index}, at {name} {readable(value, unit)}, it reaches"
        f" its edge along {edges}; the window is {window}, {model.window.reason}); {lower}, {_wider(model)},"
        " set numerics.boundary = 'periodic' if the surfaces repeat, or numerics.allow-contact-at-edge = true if the"
        " bodies end there",
        problem.sides,
    )


def _wider(model: Model) -> str:
    """Text on how to enlarge the window."""
    if not model.scene.grid.automatic:
        return "enlarge grid size"
    geometries = () if model.interface is None else model.interface.geometries
    native = next((geometry for geometry in geometries if isinstance(geometry, HasNativeGrid)), None)
    if native is None:
        return f"raise grid.margin ({model.scene.grid.margin:g})"
    return str(getattr(native, "larger_window", f"give the geometry {native.key!r} a larger surface"))


def _driven(control: Control) -> tuple[str, float, str]:
    """Name, value and unit of the normal control: load or approach."""
    if control.normal_load is not None:
        return "normal load", control.normal_load, "N"
    return "approach", control.approach or 0.0, "m"


def load_that_fits(model: Model, step: Step) -> float | None:
    """Load [N], or approach [m], with a contact inside the window, by coarse solutions.

    The bodies are taken without what lies in them or yields. None where not even a thousandth of the load fits.
    """
    control = step.control
    assert control is not None
    _, value, _ = _driven(control)
    interface = model.interface
    assert interface is not None
    x0, y0 = step.travel

    def inside(fraction: float) -> bool:
        forces = (
            {"normal_load": fraction * value} if control.normal_load is not None else {"approach": fraction * value}
        )
        names = ("moment_x", "moment_y")
        forces |= {name: fraction * moment for name in names if (moment := getattr(control, name)) is not None}
        contact = estimate_contact(
            model.grid,
            lambda x, y: interface.separation(x - x0, y - y0),
            interface.normal,
            replace(control, **forces),
            periodic=False,
            cells=_CELLS,
        )
        if contact is None:
            return True
        grid, ends = model.grid, ((contact.x0, contact.x1), (contact.y0, contact.y1))
        return all(
            min(ends[axis][0] - grid.center[axis], grid.center[axis] - ends[axis][1]) + 0.5 * grid.size[axis]
            > 1e-9 * max(grid.sides)
            for axis in grid.ended_axes
        )

    low, high = _LEAST, 1.0
    if value <= 0.0 or not inside(low):
        return None
    for _ in range(_HALVINGS):
        middle = (low * high) ** 0.5
        low, high = (middle, high) if inside(middle) else (low, middle)
    fits = _SAFE * low * value
    digits = 10.0 ** (floor(log10(fits)) - 1)
    return floor(fits / digits) * digits
