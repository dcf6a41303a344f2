"""Layer below a surface after shot peening, rolling or laser shocks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from eigencontact.plugin import FloatArray, Length, TimedField, hook_for, require

__all__ = ["PeenedLayer"]


@dataclass(frozen=True, kw_only=True)
class PeenedLayer(TimedField):
    """Eigenstrain of a peened layer: equal along x and y, largest at a depth below the surface.

    Parameters
    ----------
    peak : float
        Largest in-plane eigenstrain [-]; positive stretches the layer, which is then in compression.
    peak_depth : float
        z_p [m], depth of the largest eigenstrain.
    width : float
        w [m]. Profile ``"gaussian"``: exp(-2 (z - z_p)²/w²). ``"cosine"``: cos(pi (z - z_p)/(2 w)) for |z - z_p| < w,
        zero beyond.
    profile : "gaussian" or "cosine"
        Form of the profile.
    incompressible : bool
        True if the eigenstrain along z is minus twice the in-plane eigenstrain, as for plastic flow.
    times, factors : tuple of float
        History; see `TimedField`.

    Notes
    -----
    In a layer that is wide compared with its depth the stress is biaxial and local, -E e(z)/(1 - nu) along x and y,
    independent of the eigenstrain along z. A measured residual stress profile therefore determines the eigenstrain;
    both profiles were proposed for this stress.

    Examples
    --------
    >>> field = PeenedLayer(peak=2e-3, peak_depth=50e-6, width=100e-6)
    >>> field.eigenstrain(np.zeros(1), np.zeros(1), np.array([50e-6]), 1.0)[:3, 0].tolist()
    [0.002, 0.002, -0.004]
    """

    key: ClassVar[str] = "peened-layer"
    example: ClassVar[dict[str, Any]] = {"peak": 2e-3, "peak_depth": "100 um", "width": "50 um"}
    references: ClassVar[tuple[str, ...]] = (
        "A. M. Korsunsky, J. Strain Anal. 40 (2005) 817, doi:10.1243/030932405X30984 (peening as an eigenstrain)",
        "G. T. Robertson, The Shot Peener 11 (1997) 46 (Gaussian profile)",
        "Y. F. Al-Obaid, Mech. Mater. 19 (1995) 251, doi:10.1016/0167-6636(94)00036-G (cosine profile)",
    )

    peak: float
    peak_depth: Length
    width: Length
    profile: Literal["gaussian", "cosine"] = "gaussian"
    incompressible: bool = True

    def __post_init__(self) -> None:
        super().__post_init__()
        require(np.isfinite(self.peak), self.key, "peak", self.peak, "finite [-]")
        require(0 <= self.peak_depth < np.inf, self.key, "peak_depth", self.peak_depth, "zero or positive, finite [m]")
        require(0 < self.width < np.inf, self.key, "width", self.width, "positive and finite [m]")
        require(self.profile in ("gaussian", "cosine"), self.key, "profile", self.profile, "'gaussian' or 'cosine'")

    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Mandel eigenstrain at factor 1; see `TimedField`."""
        depth = np.broadcast_to(z, np.broadcast_shapes(x.shape, y.shape, z.shape))
        at = (depth - self.peak_depth) / self.width
        gaussian = self.profile == "gaussian"
        course = np.exp(-2.0 * at**2) if gaussian else np.cos(0.5 * np.pi * np.clip(at, -1.0, 1.0))
        tensor = np.array([1.0, 1.0, -2.0 if self.incompressible else 0.0, 0.0, 0.0, 0.0])
        return np.asarray(np.multiply.outer(tensor, self.peak * course))


eigencontact_register = hook_for(PeenedLayer)
