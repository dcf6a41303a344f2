"""Cases of whole contacts from the folders of runs, and what has none, with the reason."""

from __future__ import annotations

from pathlib import Path

from eigencontact_verification.audit.contact_case import ContactCase
from eigencontact_verification.audit.contact_lines import contact_lines, read_contact
from eigencontact_verification.audit.contact_model import junctions
from eigencontact_verification.audit.contact_scene import ContactScene, contact_scene
from eigencontact_verification.audit.shapes import NotJudged
from eigencontact_verification.crosscheck.case import Gap

__all__ = ["contact_cases_of"]

#: Divisions of the undivided mesh by level; its size in contact radii.
_DIVISIONS, _QUICK, _REACH = (3, 6, 12), (2, 4, 8), 40.0
#: Of the undivided mesh where all is elastic: elements to a contact radius, their growth, radius and depth that keep
#: their size, in contact radii.
_ELASTIC, _GROWTH, _EXTENT = 2.0, 2.5, 1.6
#: The same where something yields, which takes many iterations: small elements along the surface, where the edge of the
#: contact wanders, and larger ones below, divided half as often.
_YIELDING, _SLOWER, _PRESSED, _FEWER, _FEW = 8.0, 1.5, 1.25, (2, 4, 8), (1, 2, 4)
#: Elements to the width of the rounded edge of a punch that is under pressure.
_EDGE = 4.0
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
        return (), (Gap(subject=name, what="whole contact", reason=str(problem)),)
    if not stored.load[: stored.straight].max(initial=0.0) > 0:
        alone = "none of its steps has a load along the axis alone"
        return (), (Gap(subject=name, what="whole contact", reason=alone),)
    gaps = [Gap(subject=name, what="whole contact: sides", reason=note) for note in scene.notes]
    if stored.straight < len(stored.load):
        rest = f"step {stored.straight + 1} and those after it have shear or a moment"
        gaps.append(Gap(subject=name, what="whole contact: later steps", reason=rest))
    a = float(stored.radius[: stored.straight].max())
    lines = contact_lines(folder, stored, scene)
    if scene.cells and not any(line.kind == "stress" for line in lines):
        none = "it stores no five points of stress near the axis in the middles of cells, between which it steps"
        gaps.append(Gap(subject=name, what="whole contact: stress", reason=none))
    case = ContactCase(
        subject=name,
        name="contact",
        parameters={
            **scene.numbers(),
            "loads": [float(load) for load in stored.load[: stored.straight]],
            "mesh": _mesh(scene, a),
            "divisions": list(_divisions(scene, quick=quick)),
            "lines": [[line.profile.name, line.kind, list(line.moments)] for line in lines],
        },
        quick=quick,
        profiles=tuple(line.profile for line in lines),
        lines=lines,
    )
    return (case,), tuple(gaps)


def _yields(scene: ContactScene) -> bool:
    return any((scene.law, *(region.get("law") for region in scene.regions)))


def _flat(scene: ContactScene) -> float:
    """Radius of the flat part of a punch; 0 without [m]."""
    return max((one.get("flat", 0.0) for one in scene.profile), default=0.0)


def _divisions(scene: ContactScene, *, quick: bool) -> tuple[int, ...]:
    if _yields(scene) or _flat(scene):
        return _FEW if quick else _FEWER
    return _QUICK if quick else _DIVISIONS


def _mesh(scene: ContactScene, a: float) -> dict[str, float]:
    """Element size, where it is kept, growth beyond, and reach [m]."""
    yields, flat = _yields(scene), _flat(scene)
    sizes = [a / _ELASTIC, *(layer["thickness"] / _PARTS for layer in scene.layers)]
    for region in scene.regions:
        both = (region["radius"], region["height"]) if region["kind"] == "ellipsoid" else ()
        sizes += [size / _PARTS for size in both]
    sizes += [r / _PARTS for r in junctions(scene.profile)]
    fine = max(min(sizes), _SMALLEST * a) if not yields else a / _YIELDING
    mesh = {"radius": a, "fine": fine, "inner": 0.0, "reach": _REACH * a}
    if 0 < flat < a:  # all of the pressure's change is under the rounded edge
        return {
            **mesh, "fine": (a - flat) / _EDGE, "inner": flat, "extent": 2 * a - flat, "deep": 0.0, "growth": _SLOWER
        }  # fmt: skip
    if yields:
        return {**mesh, "extent": _PRESSED * a, "deep": 0.0, "growth": _SLOWER}
    return {**mesh, "extent": _EXTENT * a, "deep": _EXTENT * a, "growth": _GROWTH}
