"""State of an earlier run as the initial state of a run: read from its results, and moved to other cells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.errors import SceneError
from eigencontact.model.initial import InitialState, overlaps
from eigencontact.plugin import ConstitutiveLaw
from eigencontact.results.reader import results_file
from eigencontact.results.records import HistoryRecord
from eigencontact.results.stepfile import read_attributes, read_history, stored_steps
from eigencontact.scene.schema import Scene

__all__ = ["initial_states", "moved_state"]


#: Allowed fraction of a stored variable outside the cells of a law with this variable.
_LARGEST_OMISSION = 1e-6


def initial_states(scene: Scene) -> dict[int, InitialState]:
    """Initial states of the bodies of a scene, by body; the paths in the scene are absolute.

    Raises
    ------
    ResultsError
        Results that are missing, unfinished or damaged.
    SceneError
        The results have no such step, or no state of the body after it.
    """
    states = {}
    for body, table in ((1, scene.body1.initial), (2, scene.body2.initial)):
        if table is None:
            continue
        where, file = f"body{body}.initial", results_file(table.results)
        steps = stored_steps(file)
        step = steps[-1] if table.step is None else table.step
        if step not in steps:
            raise SceneError(f"{where}.step must be one that {file} holds, {steps[0]} to {steps[-1]} (got {step})")
        history = read_history(file, str(read_attributes(file)["scene_hash"]), step)
        records = {name: item for name, item in history.items() if item.body == body and item.coords and not item.finer}
        if not records:
            raise SceneError(
                f"{where}.step must be one whose history is stored (got {step}, after which {file} holds nothing of "
                f"cells of body {body}); the last is, or all with output.history = 'all'"
            )
        states[body] = InitialState(where=where, records=records)
    return states


def moved_state(
    state: InitialState,
    laws: list[tuple[ConstitutiveLaw, NDArray[np.intp]]],
    coords: Mapping[str, FloatArray],
    edges: tuple[float, float, float],
) -> dict[str, HistoryRecord]:
    """Transfer a state to the cells of a lattice: unchanged in equal cells, as means in others.

    Parameters
    ----------
    state : InitialState
    laws : list of (law, cells)
        Flat indices of the cells of each law; the variables of these laws are transferred.
    coords : mapping of str to (n,)
        Centres of the cells along z, y, x [m].
    edges : (float, float, float)
        (dz, dy, dx) [m].

    Raises
    ------
    SceneError
        A stored variable has values in cells without a law for it.
    """
    weights = [overlaps(state.coords[a], coords[a], edge) for a, edge in zip("zyx", edges, strict=True)]
    whole_cells = all(np.array_equal(weight, weight.astype(bool)) for weight in weights)
    shape, moved = tuple(len(coords[axis]) for axis in "zyx"), {}
    for name, record in state.records.items():
        values = np.einsum("ckji,Kk,Jj,Ii->cKJI", record.values, *weights, optimize=True)
        if name == f"equivalent_eigenstrain_{record.body}":
            if whole_cells:  # start of the iteration; other cells give no start
                moved[name] = replace(record, values=values, coords=dict(coords))
            continue
        plain, cells = name.removesuffix(f"_{record.body}"), np.zeros(shape, dtype=bool)
        for law, places in laws:
            variable = law.variables.get(plain)
            if variable is not None:
                rule = f"of [{variable.unit}] with {variable.components} components"
                stored = f"[{record.unit}] with {len(record.values)}"
                if stored != rule.removeprefix("of ").removesuffix(" components"):
                    raise SceneError(f"{plain!r} of {state.where} must be {rule}, as {law.key!r} has it (got {stored})")
                cells.ravel()[places] = True
        total = float(np.abs(values).sum())
        omitted = float(np.abs(values[:, ~cells]).sum())
        if omitted > _LARGEST_OMISSION * total:
            raise SceneError(
                f"{plain!r} of {state.where} must be in cells with a law that has this variable "
                f"(got {100 * omitted / total:.2g} % of it in other cells); "
                f"set {state.where.split('.')[0]}.law as in the earlier run"
            )
        moved[name] = replace(record, values=np.where(cells, values, 0.0), coords=dict(coords))
    return moved
