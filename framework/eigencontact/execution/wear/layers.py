"""Worn layers: layer thickness in the kernels, and error by the assumption of a uniform thickness.

The kernels of a layered body require layers of uniform thickness. For a body with a worn depth w(x, y), the program
uses the mean of w over the contact, weighted by the pressure. The error is the largest relative difference, over all
waves on the grid, between this response and the responses of the least and of the most worn column. If the moduli
increase or decrease monotonically with depth, the compliance of the worn layers is between these two.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.units import readable
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.wear.state import WornState
from eigencontact.model.interface import Interface
from eigencontact.model.kernels import PairCoefficients, Solids
from eigencontact.model.model import Model
from eigencontact.model.wear import WearModel
from eigencontact.plugin import LayeredMedium, Thinning

__all__ = ["WornLayers", "layers_that_wear", "refuse_unworn_kernels"]


#: Fraction of the allowed error by which the response may change before new kernels are computed (some tenths of a
#: second each).
_SHARE = 0.1
#: Remedy for layers of nonuniform thickness.
_REMEDY = (
    'describe the layers by cells: [[inclusions]] with type = "cuboid" and a material, in a body with the constants of '
    "the substrate"
)
#: Number of waves for the comparison.
_WAVES = 200


def layers_that_wear(wear: WearModel, solids: Solids) -> dict[int, LayeredMedium]:
    """Layered bodies that wear, by number of the body.

    Raises
    ------
    SceneError
        A medium does not support a worn depth.
    """
    candidates = {body: solids[body - 1] for body in wear.parts}
    media = {body: medium for body, medium in candidates.items() if isinstance(medium, LayeredMedium)}
    for body, medium in media.items():
        if not isinstance(medium, Thinning):
            raise SceneError(
                f"wear.body must be one whose layers can lose a depth (got body {body}, of medium {medium.key!r} "
                "without a method thinned); take 'bonded-layers', or let the other body wear"
            )
    return media


def refuse_unworn_kernels(model: Model) -> None:
    """Refuse an output with kernels that do not follow the worn layers.

    Raises
    ------
    SceneError
        Displacement along the surface without friction is requested for layers that wear.
    """
    assert model.wear is not None
    assert model.interface is not None
    for body in layers_that_wear(model.wear, model.interface.solids):
        if model.scene.output.tangential_displacement and model.interface.friction is None:
            raise SceneError(
                f"output.tangential-displacement must be false where body {body} has layers that wear without friction "
                f"(got true): its kernels are made once, for unworn layers; {_REMEDY}"
            )


class WornLayers:
    """Layer thickness in the kernels of a contact, updated from step to step, from stored records.

    Parameters
    ----------
    media : mapping of int to LayeredMedium
        Layered bodies that wear.
    interface : Interface
        Interface with unworn layers.
    grid : Grid
    allowed : float
        Allowed relative error of the response.

    Attributes
    ----------
    solids : Solids
        Solids with the layer thickness of the kernels.
    """

    def __init__(self, media: Mapping[int, LayeredMedium], interface: Interface, grid: Grid, allowed: float) -> None:
        self._media, self._interface, self._allowed = media, interface, allowed
        self._depths, self.solids = dict.fromkeys(media, 0.0), interface.solids
        reach, finest = max(grid.sides), min(grid.edges)
        self._waves = np.geomspace(0.5 / reach, np.pi / finest, _WAVES)

    def begin(self, step: Step, state: WornState) -> None:
        """Use the kernels of the last step, or new ones if its worn surfaces have changed since."""
        last = step.previous
        worn_depths = {body: 0.0 if last is None else last.scalars[f"layer_lost_{body}"] for body in self._media}
        self._use(worn_depths)
        if last is not None:
            self.follow(state, last.fields["pressure"])

    def follow(self, state: WornState, pressure: FloatArray) -> None:
        """Use kernels for the mean worn depth under a pressure, if they change the response enough."""
        if not pressure.any():
            return
        mean = {body: float(np.average(state.in_window(body), weights=pressure)) for body in self._media}
        if self._change(self._depths, mean) > _SHARE * self._allowed:
            self._use(mean)

    def end(self, step: Step, state: WornState) -> None:
        """Store thickness and error in the step.

        Raises
        ------
        SceneError
            The error exceeds the allowed error.
        """
        loaded = step.fields["pressure"] > 0
        error, most = 0.0, {body: float(state.in_window(body).max()) for body in self._media}
        if loaded.any():
            least = {body: float(state.in_window(body)[loaded].min()) for body in self._media}
            error = max(self._change(self._depths, least), self._change(self._depths, most))
        if not error <= self._allowed:
            deepest = max(most, key=most.__getitem__)
            raise SceneError(
                f"wear.layer-error = {self._allowed:g} must be at least the error by layers of uniform thickness (got "
                f"{error:.2g} in step {step.index}: body {deepest} is worn by up to {readable(most[deepest], 'm')}, "
                f"its layers in the kernels by {readable(self._depths[deepest], 'm')}); {_REMEDY}; or increase "
                "wear.layer-error, or use smaller increments"
            )
        step.scalars |= {f"layer_lost_{body}": depths for body, depths in self._depths.items()}
        step.scalars["layer_error"] = error

    def _use(self, depths: Mapping[int, float]) -> None:
        if depths != self._depths:
            self._depths, self.solids = dict(depths), self._thinned(depths)

    def _thinned(self, depths: Mapping[int, float]) -> Solids:
        """Solids after uniform worn depths of their surfaces."""
        thin = {body: medium.thinned(depths[body]) for body, medium in self._media.items()}  # type: ignore[attr-defined]
        first, second = (thin.get(number, body) for number, body in enumerate(self._interface.solids, 1))
        return first, second

    def _change(self, losses: Mapping[int, float], new_losses: Mapping[int, float]) -> float:
        """Largest relative change of the surface displacement by waves of pressure and shear."""
        if losses == new_losses:
            return 0.0
        k, zero = self._waves, np.zeros_like(self._waves)
        worst = 0.0
        for name, along in (("p", "z"), ("q_x", "x")):
            if name in self._interface.influences:
                first, second = (
                    PairCoefficients(
                        self._interface.influences[name], self._thinned(depths), along, self._interface.datum
                    )
                    .response(k, zero)
                    .real
                    for depths in (losses, new_losses)
                )
                worst = max(worst, float(np.abs(second / first - 1.0).max()))
        return worst
