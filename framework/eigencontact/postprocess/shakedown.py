"""Shakedown of a body with a law: elastic or plastic shakedown or ratchetting in each cell, from stored histories."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact import __version__
from eigencontact.core.shakedown import STATES, CycleResponse, cycle_response
from eigencontact.core.units import readable
from eigencontact.errors import SceneError, shown
from eigencontact.postprocess.answer import Answer
from eigencontact.postprocess.plot import opened
from eigencontact.postprocess.stress_cycle import cycle_steps

if TYPE_CHECKING:
    import xarray

    from eigencontact.results.stored import Results

__all__ = ["Shakedown", "shakedown"]

#: What a law must remember, before the number of the body.
_NEEDED = ("equivalent_plastic_strain", "plastic_strain")


@dataclass(frozen=True, eq=False, repr=False)
class Shakedown(Answer):
    """Response of the cells of a body to the last cycle.

    Attributes
    ----------
    dataset : xarray.Dataset
        ``state`` (see `eigencontact.core.shakedown.STATES`), ``growth`` and ``net_increment`` [-] in the cells.
    summary : dict
        ``state`` of the worst cell, ``volume`` of each state [m3], largest ``growth`` and ``net_increment`` [-] in the
        cycle, ``steps``.
    files : dict
        Files that were stored, and what they show.
    """

    def lines(self) -> list[str]:
        """Words for the terminal."""
        summary = self.summary
        volumes = [
            f"{name} {readable(volume, 'm^3')}"
            for name, volume in summary["volume"].items()
            if volume > 0.0 and name != STATES[0]
        ]
        steps = summary["steps"]
        return [
            f"body {summary['body']} over steps {steps[0]} to {steps[-1]}: {summary['state']}",
            f"volumes: {', '.join(volumes) or 'no cell has flowed'}",
            f"largest growth of the equivalent plastic strain in this cycle: {summary['growth']:.3g}",
            f"largest net increment: {summary['net_increment']:.3g}",
        ]


def shakedown(
    results: Any,
    *,
    body: Literal[1, 2] = 1,
    cycle: Literal["last", "all"] | tuple[int, int] = "last",
    tolerance: float = 1e-3,
    folder: str | Path | None = None,
) -> Shakedown:
    """Shakedown or ratchetting of the cells of a body, from the plastic strain at both ends of a cycle.

    Parameters
    ----------
    results : str, Path, xarray.Dataset or RunResult
        Of a run with ``output.history = "all"``.
    body : {1, 2}
        Body with a law that stores plastic strain.
    cycle : {"last", "all"} or (int, int)
        Cycle as in `eigencontact.fatigue`. The loads at both ends must be equal.
    tolerance : float
        Fraction of the largest equivalent plastic strain below which an increment in the cycle counts as zero.
    folder : str or Path, optional
        Folder for ``shakedown-body<number>``: ``.nc``, ``.json`` and ``.png``; by default nothing is stored.

    Raises
    ------
    SceneError, ResultsError
        Results without the plastic strain at both ends of the cycle.

    Notes
    -----
    A cell is elastic (it has never yielded), in elastic shakedown (it yielded only before this cycle), in plastic
    shakedown (it yields, and its plastic strain returns) or ratchets (its plastic strain grows by a net increment).
    The result describes this cycle; later cycles may shake down further.

    Examples
    --------
    >>> import eigencontact as ec
    >>> few = ["steps.0.increments=1", "steps.1.increments=2", "steps.2.increments=1", "output.history=all"]
    >>> coarse = ["grid.cells-per-contact-radius=4", "stress=[]", *few]
    >>> ec.shakedown(ec.run(ec.load_scene("plastic-hertz", coarse)), cycle="all").summary["state"]  # pressed once
    'ratchetting'
    """
    if not 0.0 < tolerance < 1.0:
        raise SceneError(f"tolerance must be between 0 and 1 [-] (got {shown(tolerance)})")
    with opened(results) as dataset:
        steps = [int(dataset["step"][position]) for position in cycle_steps(dataset, cycle)]
        if len(steps) < 2:
            raise SceneError(f"cycle must have at least two steps (got step {steps[0]} alone)")
        equivalent, strain = (_at_ends(dataset, f"{name}_{body}", (steps[0], steps[-1])) for name in _NEEDED)
        response = cycle_response(equivalent, strain, tolerance)
        axes = {axis: np.asarray(dataset[f"cells_{body}_{axis}"].values, dtype=float) for axis in "zyx"}
        summary = {
            "generator": f"eigencontact {__version__}",
            "body": body,
            "steps": steps,
            "tolerance": tolerance,
            "state": STATES[int(response.state.max(initial=0))],
            "volume": _volumes(dataset, response, axes),
            "growth": float(response.growth.max(initial=0.0)),
            "net_increment": float(response.net_increment.max(initial=0.0)),
        }
        answer = Shakedown(_dataset(response, axes, body), summary)
        if folder is None:
            return answer
        return answer.stored(
            folder, f"shakedown-body{body}", f"shakedown of body {body}",
            (
                "state, growth and net increment of the plastic strain in the cells",
                "volumes of the states, largest increments",
            ),
            lambda path: _draw(dataset, answer, path),
        )  # fmt: skip


def _at_ends(dataset: Results, name: str, ends: tuple[int, int]) -> np.ndarray[Any, Any]:
    """A variable of the cells after two steps."""
    if name not in dataset or dataset[name].dims[-3:] != tuple(f"cells_{name[-1]}_{axis}" for axis in "zyx"):
        raise SceneError(
            f"body must be one whose law remembers its plastic strain in cells (got {name[-1]}, without {name!r}); "
            "name the other one, or run with a law like j2"
        )
    stored = [int(step) for step in dataset["history_step"].values]
    missing = [step for step in ends if step not in stored]
    if missing:
        raise SceneError(
            f"cycle must lie within steps whose plastic strain is stored, {stored[0]} to {stored[-1]} (got "
            f'{ends[0]} to {ends[1]}); run with output.history = "all"'
        )
    return np.stack([np.asarray(dataset[name][stored.index(step)].values, dtype=float) for step in ends])


def _volumes(dataset: Results, response: CycleResponse, axes: dict[str, Any]) -> dict[str, float]:
    """Volume [m3] of the cells of each state."""
    sizes = np.broadcast_to(np.asarray(dataset.attrs["cell_size"], dtype=float), 2)
    depths = axes["z"]
    cell = float(np.prod(sizes)) * (depths[1] - depths[0] if depths.size > 1 else 2.0 * depths[0])
    return {name: float(cell * np.count_nonzero(response.state == number)) for number, name in enumerate(STATES)}


def _dataset(response: CycleResponse, axes: dict[str, Any], body: int) -> xarray.Dataset:
    import xarray

    fields = {
        "state": (response.state, ", ".join(f"{number} {name}" for number, name in enumerate(STATES))),
        "growth": (response.growth, "growth of the equivalent plastic strain in the cycle"),
        "net_increment": (response.net_increment, "equivalent strain of the net plastic strain of the cycle"),
    }
    return xarray.Dataset(
        {name: (tuple("zyx"), values, {"units": "1", "long_name": words}) for name, (values, words) in fields.items()},
        {axis: (axis, places, {"units": "m"}) for axis, places in axes.items()},
        {"source": f"eigencontact {__version__}", "body": body},
    )


def _draw(dataset: Results, answer: Shakedown, path: Path) -> str:
    from eigencontact.viz.looks import figure_look
    from eigencontact.viz.shakedown import shakedown_map
    from eigencontact.viz.style import save

    sentence = "State of the cells of the body on the section normal to y through the largest increment."
    with figure_look():
        save(shakedown_map(dataset, answer.dataset, answer.summary), path, caption=sentence)
    return sentence
