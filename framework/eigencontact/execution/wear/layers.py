"""Layers that wear: how thick the kernels take them to be, and what error it means that they are not so everywhere.

The kernels of a layered body are those of layers of uniform thickness. Where a body has lost a depth w(x, y), they are
made for the mean of w over the contact, weighted by the pressure. The error is the largest relative difference, over
all waves that the grid carries, between that answer and the answers of the least and of the most worn column. For
moduli that rise or fall with depth throughout, the compliance of the worn layers lies between those two.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.units import readable
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.wear.state import WornState
from eigencontact.model.kernels import Bodies, PairCoefficients
from eigencontact.model.model import Model
from eigencontact.plugin import LayeredMedium, Thinning

__all__ = ["WornLayers", "layers_that_wear"]

FloatArray = NDArray[np.float64]

#: Part of the error allowed by which the answer may change until kernels are made anew, some tenths of a second each.
_SHARE = 0.1
#: What to do where layers are not uniform enough.
_REMEDY = (
    'describe the layers by cells: [[inclusions]] with type = "cuboid" and a material, in a body with the constants of '
    "the substrate"
)
#: Waves that are compared.
_WAVES = 200


def layers_that_wear(model: Model) -> dict[int, LayeredMedium]:
    """Layered bodies that wear, by number.

    Raises
    ------
    SceneError
        A medium that cannot lose a depth, or an output that its kernels do not follow.
    """
    if model.scene.wear is None:
        return {}
    media = {body: model.bodies[body - 1] for body in model.scene.wear.parts}
    found = {body: medium for body, medium in media.items() if isinstance(medium, LayeredMedium)}
    for body, medium in found.items():
        if not isinstance(medium, Thinning):
            raise SceneError(
                f"wear.body must be one whose layers can lose a depth (got body {body}, of medium {medium.key!r} "
                "without a method thinned); take 'bonded-layers', or let the other body wear"
            )
        if model.scene.output.tangential_displacement and model.friction is None:
            raise SceneError(
                f"output.tangential-displacement must be false where body {body} has layers that wear without friction "
                f"(got true): its kernels are made once, for unworn layers; {_REMEDY}"
            )
    return found


class WornLayers:
    """The thickness of layers in the kernels of a contact, from step to step; all of it comes from stored records.

    Parameters
    ----------
    model : Model
        With a layered body that wears.

    Attributes
    ----------
    bodies : Bodies
        Bodies with layers of the thickness that the kernels have.
    """

    def __init__(self, model: Model) -> None:
        assert model.scene.wear is not None
        self._model, self._allowed = model, model.scene.wear.layer_error
        self._media = layers_that_wear(model)
        self._lost, self.bodies = dict.fromkeys(self._media, 0.0), model.bodies
        reach, finest = max(model.grid.size), min(model.grid.dx, model.grid.dy)
        self._waves = np.geomspace(0.5 / reach, np.pi / finest, _WAVES)

    def begin(self, step: Step, state: WornState) -> None:
        """Kernels of the last step; or, where its surfaces have worn since, those for them."""
        last = step.previous
        lost = {body: 0.0 if last is None else last.scalars[f"layer_lost_{body}"] for body in self._media}
        self._use(lost)
        if last is not None:
            self.follow(state, last.fields["pressure"])

    def follow(self, state: WornState, pressure: FloatArray) -> None:
        """Kernels for the mean depth that surfaces have lost under a pressure, if that changes their answer enough."""
        if not pressure.any():
            return
        mean = {body: float(np.average(state.seen(body), weights=pressure)) for body in self._media}
        if self._change(self._lost, mean) > _SHARE * self._allowed:
            self._use(mean)

    def end(self, step: Step, state: WornState) -> None:
        """Thickness and error into a step.

        Raises
        ------
        SceneError
            The error is larger than allowed.
        """
        loaded = step.fields["pressure"] > 0
        error, most = 0.0, {body: float(state.seen(body).max()) for body in self._media}
        if loaded.any():
            least = {body: float(state.seen(body)[loaded].min()) for body in self._media}
            error = max(self._change(self._lost, least), self._change(self._lost, most))
        if not error <= self._allowed:
            deepest = max(most, key=most.__getitem__)
            raise SceneError(
                f"wear.layer-error must hold for layers that are taken as uniform (got an error of {error:.2g} in step "
                f"{step.index}, allowed {self._allowed:g}: body {deepest} has lost up to "
                f"{readable(most[deepest], 'm')}, in the kernels {readable(self._lost[deepest], 'm')}); {_REMEDY}; or "
                "allow more, or wear in smaller increments"
            )
        step.scalars |= {f"layer_lost_{body}": lost for body, lost in self._lost.items()}
        step.scalars["layer_error"] = error

    def _use(self, lost: Mapping[int, float]) -> None:
        if lost != self._lost:
            self._lost, self.bodies = dict(lost), self._bodies(lost)

    def _bodies(self, lost: Mapping[int, float]) -> Bodies:
        """Bodies whose surfaces have lost uniform depths."""
        thin = {body: medium.thinned(lost[body]) for body, medium in self._media.items()}  # type: ignore[attr-defined]
        first, second = (thin.get(number, body) for number, body in enumerate(self._model.bodies, 1))
        return first, second

    def _change(self, one: Mapping[int, float], other: Mapping[int, float]) -> float:
        """Largest relative difference of the answers to waves, of pressure and of shear along them."""
        if one == other:
            return 0.0
        k, still = self._waves, np.zeros_like(self._waves)
        worst = 0.0
        for name, along in (("p", "z"), ("q_x", "x")):
            if name in self._model.influences:
                first, second = (
                    PairCoefficients(self._model.influences[name], self._bodies(lost), along).response(k, still).real
                    for lost in (one, other)
                )
                worst = max(worst, float(np.abs(second / first - 1.0).max()))
        return worst
