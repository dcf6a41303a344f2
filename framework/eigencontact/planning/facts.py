"""Sizes in a plan, in units that make a wrong unit in the scene visible."""

from __future__ import annotations

from eigencontact.core.grid import Grid
from eigencontact.core.units import readable
from eigencontact.model.model import Model
from eigencontact.model.resolution import cells_per_radius
from eigencontact.model.words import nested_parameters, parameters, sizes, unit_of
from eigencontact.plugin import ConstitutiveLaw
from eigencontact.scene.schema import Scene, Step
from eigencontact.solvers.contact_estimate import ContactEstimate

__all__ = ["contact_as_data", "expected_lines", "geometry_lines", "grid_lines", "largest_loads", "law_lines"]

#: Sides of a contact that differ by less are those of a circle.
_ROUND = 0.1


def grid_lines(model: Model) -> list[str]:
    """Cells and window; for a line contact or a period along y also the meaning of loads and displacements."""
    grid, reason = model.grid, model.window.reason
    pitch, window = (" x ".join(readable(side, "m") for side in sides) for sides in (grid.edges, grid.sides))
    lines = [f"grid        {grid.nx} x {grid.ny} cells of {pitch}; {reason}", f"window      {window}"]
    if 1 not in grid.bounded_axes:
        lines[0] = f"grid        {grid.nx} strips of {pitch}; {reason}"
        lines.append("length      infinite: line contact in plane strain, loads, work and areas per metre")
    elif grid.repeats_y:
        lines.append("period      the window repeats along y: loads, work and areas are those of one period")
    if model.interface is not None and model.interface.datum is not None:
        named = "grid.datum-depth" if model.scene.grid.datum_depth is not None else "the width of the window"
        lines.append(f"datum       displacements against the depth of {readable(model.interface.datum, 'm')} ({named})")
    return lines


def geometry_lines(model: Model) -> list[str]:
    """All geometries with their sizes."""
    geometries = () if model.interface is None else model.interface.geometries
    words = [f"{geometry.key}, {sizes(geometry)}" for geometry in geometries]
    return [f"{'' if number else 'geometry':<12}{text}".rstrip(", ") for number, text in enumerate(words)]


def law_lines(model: Model) -> list[str]:
    """Constitutive laws with memory, of bodies and of regions, with hardening, damage and all parameters."""
    owners: dict[int, tuple[ConstitutiveLaw, list[str]]] = {
        id(law): (law, [f"body {body}"]) for body, law in model.bodies.laws.items()
    }
    for region in model.cells.inhomogeneities:
        if region.law.variables and not region.guessed:
            owners.setdefault(id(region.law), (region.law, []))[1].append(region.name)
    lines = []
    for law, names in owners.values():
        owner = names[0] if len(names) == 1 else f"{names[0]} ... {names[-1]}, {len(names)} regions"
        lines += [f"{owner}: {parameters(law)}", *(f"  {line}" for line in nested_parameters(law))]
    return [f"{'' if number else 'law':<12}{text}" for number, text in enumerate(lines)]


def largest_loads(scene: Scene, grid: Grid) -> str:
    """Largest of each load or motion of the history; empty without any."""
    texts = []
    for name, field in Step.model_fields.items():
        unit = grid.unit(unit_of(field.annotation))
        values = [abs(value) for step in scene.ramps if unit and (value := getattr(step, name)) is not None]
        if any(values):
            texts.append(f"{name.replace('_', '-')} {readable(max(values), unit)}")
    return f", at most {', '.join(texts)}" if texts else ""


def expected_lines(model: Model) -> list[str]:
    """Estimated size, peak pressure and resolution of the contact, as lines."""
    contact = model.window.expected
    if contact is None:
        return []
    wide, high = contact.extent
    is_round = abs(wide - high) < _ROUND * max(wide, high)
    sides = " x ".join(readable(side, "m") for side in contact.extent)
    half = "radius" if 1 in model.grid.bounded_axes else "half width"
    size = f"{half} {readable(0.25 * (wide + high), 'm')}" if is_round else f"sides {sides}"
    cells = cells_per_radius(contact, model.grid)
    restriction = ", without what lies in the bodies" if model.sources else ""
    words = f"contact of {size}, pressure up to {readable(contact.peak, 'Pa')}, {cells:.3g} cells to a {half}"
    return [f"expected    {words} (an estimate{restriction})"]


def contact_as_data(contact: ContactEstimate, grid: Grid) -> dict[str, object]:
    """Expected contact as plain data [m, Pa]."""
    return {
        "extent": list(contact.extent[: len(grid.edges)]),
        "max_pressure": contact.peak,
        "cells_per_radius": cells_per_radius(contact, grid),
    }
