"""The kind *layered medium*: the field of a half-space whose constants depend on depth, under traction waves."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.arrays import FloatArray
from eigencontact.core.material import Material
from eigencontact.halfspace.media import HasResponseAtDepths
from eigencontact.plugin.component import Component

__all__ = ["HasResponseAtDepths", "LayeredMedium", "Thinning"]


class LayeredMedium(Component, ABC):
    """Half-space z >= 0 whose elastic constants depend only on z; homogeneous and isotropic below some depth.

    A subclass defines the response to tractions ``exp(i (kx x + ky y))`` on z = 0. Signs are those of
    `SurfaceInfluence`: ``"p"`` pushes along +z, ``"q_x"`` and ``"q_y"`` act on the body along +x and +y. Stress is
    positive in tension, in the order and the Mandel scaling of `COMPONENTS`. The optional ability `HasResponseAtDepths`
    saves time for stress at many depths. The framework stores influence coefficients on disk under a hash of the fields
    of the medium, the source of its module and its response to some waves. It computes them again for a medium whose
    fields are not text, numbers and dataclasses of these.

    Examples
    --------
    >>> from eigencontact import make
    >>> steel = {"young_modulus": "210 GPa", "poisson_ratio": 0.3}
    >>> hard = {"thickness": "2 um", "young_modulus": "420 GPa", "poisson_ratio": 0.3}
    >>> coated = make("bonded-layers", layers=[hard], substrate=steel)
    >>> k = np.array([1e9, 1e3])  # waves that see the coating alone, and the substrate alone
    >>> answer = coated.response("displacement", ["z"], "p", k, 0 * k, 0.0)[0]
    >>> (answer * k).real.round(14).tolist()  # 2 (1 - ν²) / E of each
    [4.33e-12, 8.66e-12]
    """

    kind: ClassVar[str] = "layered-medium"

    @property
    @abstractmethod
    def surface_material(self) -> Material:
        """Material at z = 0: for large k the surface displacement tends to that of its half-space."""

    @property
    @abstractmethod
    def deep_material(self) -> Material:
        """Material of the substrate: for k to 0 the surface displacement tends to that of its half-space."""

    @property
    def interfaces(self) -> tuple[float, ...]:
        """Depths [m], ascending, where the constants and the in-plane stresses ``xx, yy, xy`` jump."""
        return ()

    @property
    def layer_names(self) -> tuple[str, ...]:
        """Names of the layers above each of the interfaces, for laws by material."""
        return tuple(f"layer {number + 1}" for number in range(len(self.interfaces)))

    @abstractmethod
    def material_at(self, z: float, *, side: Literal["above", "below"] = "below") -> Material:
        """Return the material at depth z [m]; `side` is that of `response`."""

    @abstractmethod
    def response(
        self,
        quantity: str,
        components: Sequence[str],
        traction: str,
        kx: FloatArray,
        ky: FloatArray,
        z: float,
        *,
        side: Literal["above", "below"] = "below",
    ) -> NDArray[np.complex128]:
        """Amplitudes of the field at depth z for a unit traction wave, ``(len(components), ...)`` [m/Pa] or [-].

        Parameters
        ----------
        quantity : "displacement" or "stress"
        components : sequence of str
            Of ``"x", "y", "z"`` or of `COMPONENTS`.
        traction : "p", "q_x" or "q_y"
        kx, ky : float64
            Wavenumbers [rad/m]; they broadcast against each other.
        z : float
            Depth [m], zero or positive.
        side : "above" or "below"
            Side of an interface at the depth z: the material above or below it.

        Notes
        -----
        At kx = ky = 0 the displacement is 0 and the stress is that of a uniform traction: the component that balances
        it, and 0 in the others (see `HasWavenumberResponse`).
        """


@runtime_checkable
class Thinning(Protocol):
    """Optional ability of a layered medium: removal of material by wear."""

    def thinned(self, depth: float) -> LayeredMedium | Material:
        """Medium whose surface has lost a depth [m]: z counts from the new one. Below all layers, its substrate."""
        ...
