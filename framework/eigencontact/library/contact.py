"""Contact from a gap, two bodies and a load."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.core.array_types import FloatArray
from eigencontact.core.arrays import real_array
from eigencontact.core.held_arrays import PREFIX, HeldArrays, hold
from eigencontact.errors import PluginError, SceneError, require
from eigencontact.library.arguments import counts, lengths, plane
from eigencontact.library.bodies import Body
from eigencontact.library.result import ContactResult
from eigencontact.library.voxels import Voxels
from eigencontact.scene.plain import plain

__all__ = ["solve_contact"]

_SUBJECT = "solve_contact"
#: Places of a scene, and the arguments that they come from.
_ARGUMENTS = (
    (r"\b(steps(\.\d+)?[. ])?normal-load\b", "load"),
    (r"\b(steps(\.\d+)?[. ])?approach\b", "approach"),
    (r"\b(steps(\.\d+)?[. ])?tangential-load-[xy]\b", "tangential_load"),
    (r"\b(steps(\.\d+)?[. ])?shift-[xy]\b", "shift"),
    (r"\b(friction|coulomb)\.coefficient\b", "friction"),
    (r"\bsteps(\.\d+)?\.increments\b", "increments"),
    (r"\bgrid\.(cells|size|spacing|length)\b", r"\1"),
    (r"\bgrid\.datum-depth\b", "datum_depth"),
    (r"\bbody([12])\.", r"bodies.\1."),
)


def solve_contact(
    gap: Any,
    bodies: Any,
    *,
    load: Any = None,
    approach: Any = None,
    friction: Any = None,
    tangential_load: Any = None,
    shift: Any = None,
    steps: Sequence[Mapping[str, Any]] | None = None,
    increments: int = 1,
    spacing: Any = None,
    size: Any = None,
    cells: Any = None,
    length: Any = None,
    datum_depth: Any = None,
    numerics: Mapping[str, Any] | None = None,
) -> ContactResult:
    """Solve a contact: pressure, shear and gap between two bodies under a load.

    Parameters
    ----------
    gap : (ny, nx) array [m], geometry component, or several components
        Initial separation of the surfaces on the cells of the window, rows along y, with its `spacing` or `size`; or
        ``make("sphere", radius=1e-3)``, with an automatic window by default. For a line contact the array has the
        shape (nx,), (1, nx) or (nx, 1).
    bodies : HalfSpace, Layered or pair of them
        Lower body, into which z points, and upper body; None is rigid. A single body lies below a rigid one.
    load : float, text or sequence of them, optional
        Normal load [N]; a sequence has one load step per value. Give either it or `approach`. In a line contact
        this load and the tangential load are per length [N/m]: ``"400 N/mm"``.
    approach : float, text or sequence of them, optional
        Approach of the bodies from first touch [m]; in a line contact only with `datum_depth`.
    friction : float, mapping or component, optional
        Coefficient of friction, or a friction law. Without it the contact is frictionless.
    tangential_load : float, text or pair, optional
        Tangential force along x, or along x and y, of the upper body on the lower one, after the normal load [N].
    shift : float, text or pair, optional
        Motion of the upper body along x, or along x and y, in place of a tangential load [m].
    steps : sequence of mappings, optional
        Load history as the tables ``[[steps]]`` of a scene, in place of loads and motions.
    increments : int
        Number of equal increments of each step.
    spacing : float, text or pair, optional
        Edges of a cell along x and y [m].
    size : float, text or pair, optional
        Extent of the window along x and y [m].
    cells : int or pair, optional
        Number of cells along x and y; two of `cells`, `size` and `spacing` fix the window of a component.
    length : "infinite", optional
        Length of the contact along y: ``"infinite"`` makes a line contact in plane strain. `cells`, `size` and
        `spacing` are then single values, those along x; arrays of the result are of shape (1, nx).
    datum_depth : float or text, optional
        For a line contact, and a contact periodic along y only: datum depth of the displacements in each body [m],
        by default the width of the window.
    numerics : mapping, optional
        Numerical settings as the table ``[numerics]`` of a scene: ``{"boundary": "periodic"}``, or ``"periodic-y"``.

    Returns
    -------
    ContactResult

    Raises
    ------
    SceneError
        An invalid argument, with its name; `NotConverged`, `DomainTooSmall` during the solution.

    Examples
    --------
    A ball of 105 µm radius on steel, from an array of gaps:

    >>> import numpy as np, eigencontact as ec
    >>> x = (np.arange(64) - 31.5) * 0.25e-6
    >>> gap = (x**2 + x[:, None] ** 2) / (2 * 105e-6)
    >>> contact = ec.solve_contact(gap, ec.HalfSpace("210 GPa", 0.3), load="0.65 N", spacing=0.25e-6)
    >>> f"{contact.max_pressure / 1e9:.2f} GPa, {contact.radius * 1e6:.2f} um, {contact.approach * 1e9:.0f} nm"
    '8.47 GPa, 6.03 um, 349 nm'
    >>> contact.stress([[0, 0, 3e-6]]).shape
    (1, 3, 3)

    A cylinder of 10 mm, as a line contact:

    >>> x = (np.arange(64) - 31.5) * 0.01e-3
    >>> line = ec.solve_contact(
    ...     x**2 / 20e-3, ec.HalfSpace("210 GPa", 0.3), load="400 N/mm", spacing=0.01e-3, length="infinite"
    ... )
    >>> f"{line.max_pressure / 1e6:.0f} MPa, half width {line.radius * 1e6:.0f} um"
    '1713 MPa, half width 149 um'
    """
    lower, upper = _pair(bodies)
    rule = "'infinite', which makes a line contact, or left out"
    require(length is None or plain(length, f"{_SUBJECT}.length") == "infinite", _SUBJECT, "length", length, rule)
    line = {} if length is None else {"length": "infinite"}
    if datum_depth is not None:
        line["datum-depth"] = datum_depth
    geometry, window, arrays = _separation(gap, spacing, size, cells, line=length is not None)
    along = [name for name, value in (("tangential_load", tangential_load), ("shift", shift)) if value is not None]
    if along and friction is None:
        raise SceneError(
            f"{_SUBJECT}.friction must be given with {along[0]} (got None): a frictionless contact carries no shear; "
            "give a coefficient"
        )
    require(numerics is None or isinstance(numerics, Mapping), _SUBJECT, "numerics", numerics, "a table, as [numerics]")
    history = _steps(load, approach, tangential_load, shift, increments) if steps is None else _history(steps)
    if steps is not None:
        controls = {"load": load, "approach": approach, "tangential_load": tangential_load, "shift": shift}
        conflicting = [name for name, value in controls.items() if value is not None]
        require(
            not conflicting,
            _SUBJECT,
            "steps",
            f"{', '.join(conflicting)} too",
            "given alone: they hold all loads and motions",
        )
    inclusions = [
        table
        for number, body in enumerate((lower, upper), 1)
        if body is not None
        for table in body.scene_inclusions(number)
    ]
    scene: dict[str, Any] = {
        "title": "Contact",
        "body1": {"rigid": True} if lower is None else lower.scene_table(),
        "body2": {"rigid": True} if upper is None else upper.scene_table(),
        "geometry": geometry,
        "inclusions": inclusions,
        "steps": history,
        "numerics": _pitch(lower, upper) | dict(numerics or {}),
        "output": {"pictures": False},
        "grid": {**(window or {}), **line},
    }
    if friction is not None:
        law = isinstance(friction, Mapping) or is_dataclass(friction)
        scene["friction"] = friction if law else {"type": "coulomb", "coefficient": friction}
    return ContactResult(_run(scene), (lower, upper), arrays)


def _run(scene: dict[str, Any]) -> Any:
    """Result of a scene; a refusal names the argument."""
    from eigencontact.app import plan, run

    try:
        planned = plan(scene)
    except (SceneError, PluginError) as problem:
        text = str(problem)
        for place, argument in _ARGUMENTS:
            text = re.sub(place, argument, text)
        text = re.sub(r"\binclusions(?:\.(\d+))?(?=[.: ])", lambda match: _owner(scene, int(match[1] or 0)), text)
        raise type(problem)(f"{_SUBJECT}: {text}") from None
    return run(planned)


def _owner(scene: dict[str, Any], number: int) -> str:
    """Argument of the library that defines an inclusion of a scene."""
    table = scene["inclusions"][number]
    if table["type"] == "voxels" and str(table.get("file", "")).startswith(PREFIX):
        return f"Voxels.materials[{table['value']}]"
    before = sum(inclusion["body"] == table["body"] for inclusion in scene["inclusions"][:number])
    return f"HalfSpace.inclusions[{before}]"


def _pair(bodies: Any) -> tuple[Body | None, Body | None]:
    """Lower and upper body; None is rigid."""
    pair = tuple(bodies) if isinstance(bodies, list | tuple) else (bodies, None)
    rule = "a HalfSpace or Layered, or a pair of which one may be None, which is rigid"
    good = len(pair) == 2 and all(body is None or isinstance(body, Body) for body in pair) and pair != (None, None)
    require(good, _SUBJECT, "bodies", bodies, rule)
    return pair[0], pair[1]


def _separation(
    gap: Any, spacing: Any, size: Any, cells: Any, *, line: bool
) -> tuple[Any, dict[str, Any] | None, tuple[HeldArrays, ...]]:
    """Geometry of a scene, its window, and the arrays to store."""
    shapes = gap if isinstance(gap, list | tuple) else [gap]
    if all(isinstance(shape, Mapping) or is_dataclass(shape) for shape in shapes):
        window = {"spacing": None if spacing is None else lengths(spacing, 2, _SUBJECT, "spacing")}
        window["size"] = None if size is None else lengths(size, 2, _SUBJECT, "size")
        window_fields: dict[str, Any] = {name: value for name, value in window.items() if value is not None}
        if cells is not None:
            window_fields["cells"] = counts(cells, _SUBJECT, "cells")
        if len(window_fields) not in (0, 2):
            names = ", ".join(window_fields)
            raise SceneError(f"{_SUBJECT} must be given two of cells, size and spacing, or none of them (got {names})")
        return list(shapes), window_fields or None, ()
    array = _cells_of(gap, line=line)
    require(cells is None, _SUBJECT, "cells", cells, f"left out: the gap has {array.shape[1]} x {array.shape[0]} cells")
    if (spacing is None) == (size is None):
        windows = "neither" if size is None else "both"
        raise SceneError(
            f"{_SUBJECT}.spacing must be given with an array, edges of its cells [m], or size (got {windows})"
        )
    ny, nx = array.shape
    if line:
        pitch = _single(size, "size") / nx if spacing is None else _single(spacing, "spacing")
        x = (np.arange(nx) - 0.5 * (nx - 1)) * pitch
        arrays = hold(x=x, y=[-0.5, 0.5], gap=np.vstack([array, array]))  # the same for all y
        return {"type": "gap-map", "file": arrays.name}, {"cells": nx, "spacing": pitch}, (arrays,)
    if spacing is None:
        extent = lengths(size, 2, _SUBJECT, "size")
        dx, dy = extent[0] / nx, extent[1] / ny
    else:
        dx, dy = lengths(spacing, 2, _SUBJECT, "spacing")
    x, y = ((np.arange(count) - 0.5 * (count - 1)) * pitch for count, pitch in ((nx, dx), (ny, dy)))
    arrays = hold(x=x, y=y, gap=array)
    grid = {"cells": (nx, ny), "spacing": (dx, dy)}
    return {"type": "gap-map", "file": arrays.name}, grid, (arrays,)


def _cells_of(gap: Any, *, line: bool) -> FloatArray:
    """Gap on rectangular cells ``(ny, nx)``, or on the strips of a line contact ``(1, nx)`` [m]."""
    rule = "an array (nx,), (1, nx) or (nx, 1) of 2 cells or more with length='infinite' [m]"
    if not line:
        rule = "an array (ny, nx) of 2 x 2 cells or more [m]; a row (nx,) makes a line contact with length='infinite'"
    array = real_array(_array(gap), _SUBJECT, "gap", rule, "m")
    row = array.ndim in (1, 2) and array.size == max(array.shape) >= 2
    require(row if line else array.ndim == 2 and min(array.shape) >= 2, _SUBJECT, "gap", array.shape, rule)
    return plane(array.reshape(1, -1) if line else array, _SUBJECT, "gap", "m")


def _single(value: Any, name: str) -> float:
    """Length along x [m], the only one of a line contact."""
    dx, dy = lengths(value, 2, _SUBJECT, name)
    require(dx == dy, _SUBJECT, name, value, "one length, that along x, with length='infinite' [m]")
    return dx


def _array(gap: Any) -> ArrayLike:
    rule = "an array (ny, nx) [m], a geometry component as make() returns, or a sequence of components"
    array: ArrayLike = gap
    require(isinstance(gap, list | tuple) or hasattr(gap, "__array__"), _SUBJECT, "gap", gap, rule)
    return array


def _history(steps: Any) -> list[Any]:
    """Tables of prescribed steps."""
    tables = [steps] if isinstance(steps, Mapping) else steps
    require(isinstance(tables, list | tuple), _SUBJECT, "steps", steps, "a sequence of tables, as [[steps]] of a scene")
    return list(tables)


def _steps(load: Any, approach: Any, tangential: Any, shift: Any, increments: int) -> list[dict[str, Any]]:
    """Tables of the steps: the normal steps, then one along the surface."""
    if (load is None) == (approach is None):
        controls = "neither" if load is None else "both"
        raise SceneError(f"{_SUBJECT} must be given load or approach (got {controls})")
    name, argument, history = ("normal-load", "load", load) if approach is None else ("approach", "approach", approach)
    values = _listed(history, argument)
    require(len(values) > 0, _SUBJECT, argument, history, "one value or more")
    steps: list[dict[str, Any]] = [{name: value} for value in values]
    if tangential is not None and shift is not None:
        raise SceneError(f"{_SUBJECT} must be given tangential_load or shift (got both)")
    for argument, scene_name, value in (
        ("tangential_load", "tangential-load", tangential),
        ("shift", "shift", shift),
    ):
        if value is not None:
            pair = _listed(value, argument)
            rule = "one value, along x, or two, along x and y; other histories are steps=[...]"
            require(len(pair) in (1, 2), _SUBJECT, argument, value, rule)
            steps.append({f"{scene_name}-{axis}": component for axis, component in zip("xy", pair, strict=False)})
    return [{**step, "increments": increments} for step in steps]


def _listed(value: Any, name: str) -> Sequence[Any]:
    """Values of a list or an array; a single value, also as a 0-d array, is a list of one."""
    values = plain(value, f"{_SUBJECT}.{name}")
    return values if isinstance(values, list | tuple) else [values]


def _pitch(*bodies: Body | None) -> dict[str, Any]:
    """Height of the cells of a body: that of its voxels."""
    voxels = [getattr(body, "voxels", None) for body in bodies]
    heights = [item.spacing[2] for item in voxels if isinstance(item, Voxels)]
    return {"inclusion-pitch": min(heights)} if heights else {}
