"""Consistency of the parts of a scene: contact, eigenstrain, load history, regions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eigencontact.core.bulk import BULK_NAMES
from eigencontact.core.names import clashes
from eigencontact.core.rigid_modes import TANGENTIAL_MODES
from eigencontact.errors import shown
from eigencontact.scene.holding import TRAVEL
from eigencontact.scene.labels import ordinal
from eigencontact.scene.line import check_line, check_repeating
from eigencontact.scene.steps import Step, expected_points, named_ramps
from eigencontact.scene.table import ComponentTable

if TYPE_CHECKING:
    from eigencontact.scene.schema import Scene, StressRequest

__all__ = ["check_contents"]

#: Load steps of a scene.
_MOST_STEPS = 100_000
_TANGENTIAL = frozenset(name for mode in TANGENTIAL_MODES for name in mode)


def check_contents(scene: Scene) -> None:
    """Raise ValueError, with a complete sentence after ``!``, for parts that contradict each other."""
    if not (scene.geometry or scene.inclusions or scene.eigenstrain):
        raise ValueError(
            "!the scene must have a geometry, inclusions or eigenstrain (got none of them); add [geometry] for a "
            "contact, [[inclusions]] or [[eigenstrain]] for the field of a prescribed eigenstrain"
        )
    _check_steps(scene)
    _check_bulk(scene)
    check_line(scene)
    check_repeating(scene)
    for name in type(scene).model_fields:
        value = getattr(scene, name)
        for table in value if isinstance(value, list) else [value]:
            if isinstance(table, ComponentTable):
                table.check_in(scene)
    _check_eigenstrain(scene)
    _check_materials(scene)
    _check_initial(scene)
    _check_names(scene)
    for request in scene.stress:
        _check_region(scene, request)


def _check_names(scene: Scene) -> None:
    """Require distinct region names, which name files and variables; some file systems ignore case."""
    for group in ("inclusions", "eigenstrain"):
        names = [item.name or f"{item.type} {number + 1}" for number, item in enumerate(getattr(scene, group))]
        duplicate = next((number for number, name in enumerate(names) if name in names[:number]), None)
        if duplicate is not None:
            places = f"{ordinal(names.index(names[duplicate]))} and {ordinal(duplicate)}"
            raise ValueError(
                f"!{group} must have different names (got {names[duplicate]!r} twice, the {places}); rename one"
                + (", or give one table centers" if group == "inclusions" else "")
            )
    labels = [request.label for request in scene.stress]
    for number, label in enumerate(labels):
        if clashes(label):
            raise ValueError(
                "!stress region must have a name that differs from those of surface fields, numbers and files in the "
                f"results (got {label!r}); choose another name"
            )
        for earlier_label in labels[:number]:
            if earlier_label == label:
                raise ValueError(f"!stress regions must have different names (got {label!r} twice); set name")
            if earlier_label.casefold() == label.casefold():
                raise ValueError(
                    f"!stress regions must differ by more than case (got {earlier_label!r} and {label!r}); rename one"
                )


def _check_steps(scene: Scene) -> None:
    if scene.geometry and "steps" not in scene.model_fields_set:
        raise ValueError("!steps must be given")
    if scene.friction is not None and not scene.geometry:
        raise ValueError(
            "!friction must be left out of a scene without a contact (got no geometry); add [geometry], or remove "
            "[friction]"
        )
    _check_number_of_steps(scene)
    controlled = False
    for where, step in named_ramps(scene.steps):
        controls = bool({"normal-load", "approach"} & set(step.prescribed))
        controlled = controls or (controlled and scene.friction is not None)  # with friction a step keeps what was
        if scene.geometry and not controlled:
            got = ", ".join(step.prescribed) or "neither"
            raise ValueError(f"!{where} must be controlled by normal-load or approach: give one of them (got {got})")
        if step.prescribed and not scene.geometry:
            raise ValueError(
                f"!{where} must not prescribe {step.prescribed[0]} without a contact (got no geometry); "
                "add [geometry], or remove it"
            )
        if step.travels:
            _check_travel(scene, where)
        along = [name for name in step.prescribed if name.replace("-", "_") in _TANGENTIAL]
        if along and scene.friction is None:
            raise ValueError(
                f"!{where} must not prescribe {along[0]} without friction (got a frictionless contact, which carries "
                'no shear); add [friction] with type = "coulomb" and a coefficient, or leave it out'
            )
        if step.sliding_distance is not None:
            _check_sliding(scene, where, step)
    _check_spacing(scene)


def _check_bulk(scene: Scene) -> None:
    """Require elastic bodies under bulk stress, and no strain along the axes of a periodic contact with friction."""
    for where, step in named_ramps(scene.steps):
        for body, names in BULK_NAMES.items():
            name = next((name.replace("_", "-") for name in names if name in step.bulk), None)
            if name is not None and scene.bodies[body - 1].rigid:
                raise ValueError(
                    f"!{where}.{name} must act on an elastic body (got a rigid body{body}); remove it, or give "
                    f"body{body} young-modulus and poisson-ratio"
                )
    if scene.bulk_at_rest and scene.friction is not None and scene.numerics.boundary == "periodic":
        name = next(iter(scene.bulk_at_rest)).replace("_", "-")
        raise ValueError(
            f"!numerics.boundary must be 'non-periodic' with bulk stress in a contact with friction (got 'periodic', "
            f"and {name}), because a mean strain displaces the surfaces differently in each period; remove one of them"
        )


def _check_spacing(scene: Scene) -> None:
    """Require the same control in the previous step for increments even in the radius, also where a cycle repeats."""
    previous_control: str | None = ""
    for where, step in named_ramps(scene.steps, again=True):
        control = next((name for name in ("normal-load", "approach") if name in step.prescribed), None)
        final_control = control or (previous_control if scene.friction is not None else None)
        if step.spacing == "radius" and (control is None or previous_control not in ("", control)):
            pair: str = control or "neither"
            if control is not None and previous_control not in ("", control):
                pair += f" after {previous_control or 'neither'}"
            raise ValueError(
                f"!{where}.spacing must be 'even' unless this step and the previous step both prescribe normal-load, "
                f"or both approach (got 'radius' with {pair}); remove it"
            )
        previous_control = final_control


def _check_number_of_steps(scene: Scene) -> None:
    counts = [expected_points([step], scene.solved_cycles) for step in scene.steps]
    if sum(counts) > _MOST_STEPS:
        largest = max(range(len(counts)), key=counts.__getitem__)
        step, remaining = scene.steps[largest], _MOST_STEPS - sum(counts) + counts[largest]
        where = "steps" if len(scene.steps) == 1 else f"steps.{largest}"
        name = "repeat" if step.cycle else "increments"
        if step.cycle and expected_points(step.cycle) > remaining:
            place, step = max(enumerate(step.cycle), key=lambda item: item[1].increments)
            where, name = f"{where}.cycle.{place}", "increments"
        count = getattr(step, name)
        most = max(1, count * remaining // counts[largest])
        fewer = name == "repeat" and scene.wear is not None and scene.wear.cycles_per_update is not None
        raise ValueError(
            f"!{where}.{name} must give at most {_MOST_STEPS} load steps in total, because each is solved and stored "
            f"(got {shown(count)}, which gives {shown(sum(counts))}); the largest value is {most}"
            + (", or set a larger wear.cycles-per-update" if fewer else "")
        )


def _check_sliding(scene: Scene, where: str, step: Step) -> None:
    controls = [name for name in step.prescribed if name.replace("-", "_") in _TANGENTIAL | set(TRAVEL)]
    if controls:
        raise ValueError(f"!{where} must prescribe either sliding-distance or {controls[0]} (got both); use two steps")
    if scene.friction is None and scene.wear is None:
        raise ValueError(
            f"!{where}.sliding-distance must be used with friction, wear, or both (got neither); add [friction] or "
            "[wear], or remove it"
        )


def _check_travel(scene: Scene, where: str) -> None:
    if scene.friction is not None and scene.wear is None:
        raise ValueError(
            f"!{where} must not move the geometry (travel-x, travel-y) in a contact with friction (got both); remove "
            "[friction] for frictionless rolling, or prescribe shift-x and shift-y for sliding"
        )
    if scene.numerics.boundary == "periodic":
        raise ValueError(
            f"!{where} must not move the geometry (travel-x, travel-y) in a periodic scene (got numerics.boundary = "
            "'periodic'), because it would leave the window; remove one of them"
        )


def _check_eigenstrain(scene: Scene) -> None:
    if not (scene.inclusions or scene.eigenstrain):
        return
    if scene.numerics.boundary == "periodic" and scene.numerics.half_space != "periodic":
        raise ValueError(
            "!numerics.boundary must be 'non-periodic' in a scene with inclusions or eigenstrain (got 'periodic'); "
            f"their fields are those of one half-space (half-space = '{scene.numerics.half_space}'): "
            'set numerics.half-space = "periodic" as well, or leave both out'
        )
    lines = [request for request in scene.stress if request.shape in ("line", "points")]
    if scene.numerics.half_space == "periodic" and lines:
        raise ValueError(
            f"!numerics.half-space must be 'exact' for fields on lines and at points, here {lines[0].label!r} "
            "(got 'periodic'); use a plane or a volume"
        )
    for group in ("inclusions", "eigenstrain"):
        for number, item in enumerate(getattr(scene, group)):
            if scene.bodies[item.body - 1].rigid:
                raise ValueError(
                    f"!{group}.{number} must lie in an elastic body (got a rigid body{item.body}); set body, or give "
                    f"body{item.body} young-modulus and poisson-ratio"
                )
            if scene.bodies[item.body - 1].medium is not None:
                raise ValueError(
                    f"!{group}.{number} must lie in a homogeneous body (body{item.body} is a layered medium, and the "
                    "kernels of eigenstrain are those of a homogeneous half-space); set body, leave the medium out, or "
                    "describe the layers as inclusions with a material of their own"
                )


def _check_materials(scene: Scene) -> None:
    """Inhomogeneities need the exact half-space, or a full space, of one material."""
    for number, item in enumerate(scene.inclusions):
        if item.material is None:
            continue
        where = "inclusions" if len(scene.inclusions) == 1 else f"inclusions.{number}"
        if scene.numerics.half_space not in ("exact", "full-space"):
            raise ValueError(
                f"!numerics.half-space must be 'exact' or 'full-space' with {where}.material "
                f"(got {scene.numerics.half_space!r}); leave it out"
            )
        if scene.numerics.boundary == "periodic":
            raise ValueError(
                f"!numerics.boundary must be 'non-periodic' with {where}.material (got 'periodic'); leave it out"
            )
        if scene.bodies[item.body - 1].medium is not None:
            raise ValueError(
                f"!{where}.material must lie in a body of one material (body{item.body} is a layered medium); "
                "give the layers as inclusions with a material, or leave them out"
            )


def _check_initial(scene: Scene) -> None:
    """A state is one of cells with a law."""
    for number, body in enumerate(scene.bodies, start=1):
        laws = body.law is not None or any(
            item.material is not None and item.body == number for item in scene.inclusions
        )
        if body.initial is not None and not laws:
            raise ValueError(
                f"!body{number}.initial must be used with a history-dependent law (got none in body {number}); set "
                f"body{number}.law as in the earlier run"
            )


def _check_region(scene: Scene, request: StressRequest) -> None:
    if scene.bodies[request.body - 1].rigid:
        raise ValueError(
            f"!stress region {request.label!r} must lie in an elastic body (got a rigid body{request.body})"
        )
    if request.around is not None or request.refinement is not None:
        _check_close_up(scene, request)
    if scene.numerics.boundary == "periodic" and request.shape in ("line", "points"):
        raise ValueError("!stress regions of a periodic scene must be planes or volumes (got a line or points)")


def _check_close_up(scene: Scene, request: StressRequest) -> None:
    if request.around is not None and not (scene.inclusions or scene.eigenstrain):
        raise ValueError(
            f"!stress region {request.label!r} must be around an inclusion (got {request.around!r} in a scene without "
            "any); leave around out, or give start and end"
        )
    if scene.numerics.half_space in ("image-pressure", "periodic") or scene.numerics.boundary == "periodic":
        raise ValueError(
            "!numerics must be non-periodic with half-space = 'exact' or 'full-space' for regions finer than cells, "
            f"{request.label!r} (got {scene.numerics.boundary!r}, {scene.numerics.half_space!r}); "
            "leave out around and refinement"
        )
