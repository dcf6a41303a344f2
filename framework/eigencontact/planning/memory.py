"""Memory of a whole run: arrays, interpreter with libraries, and the process that draws pictures."""

from __future__ import annotations

import sys
from math import prod
from typing import TYPE_CHECKING

from eigencontact.core.memory import resident_bytes
from eigencontact.core.parallel import available_threads

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["results_bytes", "run_bytes"]

#: Components of the quantities of a region; others have one.
_COMPONENTS = {"stress": 6, "strain": 6, "displacement": 3, "principal": 3}

#: What the first step adds beside its arrays: parts of scipy, compiled loops, and room that the allocator keeps. Of the
#: bundled scenes 5 to 36 MB.
_STEPS = 34e6
#: Libraries that are loaded where they are needed first: those that store, those that compile the loops over cells
#: inside bodies with the parts of scipy for these (55 and 23 MB at once, more with what the loops allocate), and those
#: that draw in this process.
_STORING = 14e6
_COMPILING = 90e6
_DRAWING = 75e6
#: Process that draws: 168 to 172 MB with bundled scenes.
_PAINTER = 170e6
#: Copy of this process for each further core, beyond what the copies share: 0 (few pictures) to 71 MB.
_COPY = 50e6
#: An animation, which this process draws and encodes after the last step: 390 and 500 MB with bundled scenes.
_FILM = 500e6


def run_bytes(plan: Plan, *, stored: bool = True, painter: bool = True) -> float:
    """Largest memory of a run [bytes], of this process and the drawing process together.

    Parameters
    ----------
    plan : Plan
    stored : bool
        Whether results go to a folder, as those of the command do; without one nothing is drawn.
    painter : bool
        Whether pictures are drawn by a process of their own.
    """
    late = _STEPS
    if stored and "h5py" not in sys.modules:
        late += _STORING
    if plan.model.cells.inhomogeneities and "numba" not in sys.modules:
        late += _COMPILING
    output = plan.scene.output
    if stored and painter and output.pictures:
        late += _PAINTER + _COPY * (available_threads() - 1)
    elif stored and output.pictures and "matplotlib" not in sys.modules:
        late += _DRAWING
    if stored and output.animation:
        late += _FILM
    return resident_bytes() + late + plan.cost.peak


def results_bytes(plan: Plan) -> float:
    """Memory of the results of all load steps [bytes], as of a run without a folder.

    Fields of the surface, of the regions, and of the cells of bodies with eigenstrain.
    """
    from eigencontact.model.regions import region_lattice

    grid, model = plan.grid, plan.model
    doubles = grid.nx * grid.ny * sum(":" not in name for block in plan.blocks for name in block.requesters)
    for request in model.cells.requests:
        components = sum(_COMPONENTS.get(name, 1) for name in (*request.fields, *request.quantities))
        doubles += components * prod(region_lattice(request, grid).shape)
    state = max((sum(variable.components for variable in law.variables.values()) for law in model.laws), default=0)
    cells = sum(prod(source.lattice.shape) for source in model.cells.inhomogeneities if source.lattice is not None)
    histories = plan.steps if plan.scene.output.history == "all" else 1
    return 8.0 * (plan.steps * doubles + histories * cells * (_COMPONENTS["strain"] + state))
