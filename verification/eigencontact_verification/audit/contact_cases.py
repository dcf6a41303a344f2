"""Cases of whole contacts from the folders of runs, and what has none, with the reason."""

from __future__ import annotations

from pathlib import Path

from eigencontact_verification.audit.contact_case import ContactCase
from eigencontact_verification.audit.contact_lines import contact_lines, read_contact
from eigencontact_verification.audit.contact_model import junctions
from eigencontact_verification.audit.contact_scene import ContactScene, contact_scene
from eigencontact_verification.audit.shapes import NotJudged
from eigencontact_verification.campaign.case import Gap

__all__ = ["contact_cases_of"]

#: Elements to a contact radius are `_FINE` (where something yields, else `_ELASTIC`, which needs few iterations) times
#: these parts; growth of the undivided mesh; its size in contact radii.
_FINE, _ELASTIC, _DIVISIONS, _QUICK, _GROWTH, _EXTENT, _REACH = 1.2, 2.0, (3, 6, 12), (2, 4, 8), 2.5, 1.6, 40.0
#: Elements of the undivided mesh to the thickness of a layer or the semi-axis of an inclusion, and least size of all.
_PARTS, _SMALLEST = 1.0, 0.25


def contact_cases_of(folder: str | Path, *, quick: bool = True) -> tuple[tuple[ContactCase, ...], tuple[Gap, ...]]:
    """The case of a run whose contact is of revolution, and what it leaves out; or no case, and why.

    Parameters
    ----------
    folder : str or Path
        Folder of the run, or its ``results.nc``.
    quick : bool
        Lighter meshes.
    """
    name = Path(folder).parent.name if Path(folder).suffix == ".nc" else Path(folder).name
    try:
        stored = read_contact(folder)
        name = stored.name
        scene = contact_scene(stored.text, float(stored.radius[: stored.straight].max(initial=0.0)))
    except NotJudged as problem:
        return (), (Gap(kernel=name, what="whole contact", reason=str(problem)),)
    if not stored.load[: stored.straight].max(initial=0.0) > 0:
        alone = "none of its steps has a load along the axis alone"
        return (), (Gap(kernel=name, what="whole contact", reason=alone),)
    gaps = [Gap(kernel=name, what="whole contact: sides", reason=note) for note in scene.notes]
    if stored.straight < len(stored.load):
        rest = f"step {stored.straight + 1} and those after it have shear or a moment"
        gaps.append(Gap(kernel=name, what="whole contact: later steps", reason=rest))
    a = float(stored.radius[: stored.straight].max())
    lines = contact_lines(folder, stored, scene)
    case = ContactCase(
        kernel=name,
        name="contact",
        parameters={
            **scene.numbers(),
            "loads": [float(load) for load in stored.load[: stored.straight]],
            "mesh": _mesh(scene, a),
            "divisions": list(_QUICK if quick else _DIVISIONS),
            "lines": [[line.profile.name, line.kind, list(line.moments)] for line in lines],
        },
        quick=quick,
        profiles=tuple(line.profile for line in lines),
        lines=lines,
    )
    return (case,), tuple(gaps)


def _mesh(scene: ContactScene, a: float) -> dict[str, float]:
    """Element size, extent and reach [m]."""
    yields = [scene.law, *(region.get("law") for region in scene.regions)]
    sizes = [a / (_FINE if any(yields) else _ELASTIC), *(layer["thickness"] / _PARTS for layer in scene.layers)]
    for region in scene.regions:
        both = (region["radius"], region["height"]) if region["kind"] == "ellipsoid" else ()
        sizes += [size / _PARTS for size in both]
    sizes += [r / _PARTS for r in junctions(scene.profile)]
    fine = max(min(sizes), _SMALLEST * a)
    return {"radius": a, "fine": fine, "extent": _EXTENT * a, "reach": _REACH * a, "growth": _GROWTH}
