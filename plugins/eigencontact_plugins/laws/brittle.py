"""Brittle materials: loss of stiffness by tensile strain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import (
    FloatArray,
    LawStep,
    Response,
    StrainDamage,
    Variable,
    hook_for,
    require,
)
from eigencontact_plugins.laws.constants import BodyConstants
from eigencontact_plugins.laws.principal import Damaged, principal, tangent_of

__all__ = ["Brittle"]


#: Largest increase of damage, as a function of a mean, while the strain grows by `_SHARE`. The iteration between cells
#: converges at a tenth of this slope (Mazars with B κ0 = 10) and stalls at a residual of 0.35 slightly above it (B κ0 =
#: 100).
_RISE = 0.5
#: Relative growth of the strain for the slope.
_SHARE = 0.01
#: Number of test strains while the strain grows by `_SHARE`.
_PARTS = 10
#: Range of the test strains.
_STRAINS = (1e-8, 1.0)


@dataclass(frozen=True, kw_only=True)
class Brittle(BodyConstants):
    """Isotropic elasticity of stiffness ``(1 - D) E``, with D from the largest equivalent strain so far.

    The equivalent strain is that of Mazars, the root of the sum of the squares of the positive principal strains; the
    law stores its largest value κ. D(κ) never decreases: unloading is linear to the origin, and reloading follows the
    same line. Without `crack_closure` D reduces the stiffness in compression as well as in tension.

    Parameters
    ----------
    damage : StrainDamage
        D as a function of κ; with a length, as a function of the mean of κ over the neighbourhood.
    young_modulus, poisson_ratio : float, optional
        E [Pa], positive and finite, and ν [-] in [0, 0.5), of the undamaged material; by default those of the body.
    crack_closure : bool
        True if closed cracks transmit compression (J. Ladeveze, J. Lemaitre 1984): damage then acts only on tensile
        principal stresses. In uniaxial tension the stress is ``(1 - D) E ε``, in compression ``E ε``; the transverse
        strain is -ν/E times the stress, with or without damage. At constant D the stress derives from an energy.
    """

    key: ClassVar[str] = "brittle"
    example: ClassVar[dict[str, Any]] = {
        "young_modulus": "30 GPa",
        "poisson_ratio": 0.2,
        "damage": {"type": "mazars", "threshold": 1e-4, "A": 0.9, "B": 2e4},
    }
    references: ClassVar[tuple[str, ...]] = (
        "J. Mazars 1986, Eng. Fract. Mech. 25, 729",
        "J. Ladeveze, J. Lemaitre 1984, Proc. 16th IUTAM Congress (crack closure)",
    )

    symmetric: ClassVar[bool] = False
    variables: ClassVar[Mapping[str, Variable]] = {
        "equivalent_strain": Variable("1", "largest equivalent strain so far, by Mazars", elastic=True),
        "damage": Variable("1", "lost fraction of the stiffness", largest="max_damage", extent="damaged_volume"),
    }

    damage: StrainDamage
    crack_closure: bool = False

    def __post_init__(self) -> None:
        nu = self.poisson_ratio
        require(nu is None or 0 <= nu < 0.5, self.key, "poisson_ratio", nu, "in [0, 0.5) [-]")
        super().__post_init__()
        sound = isinstance(self.damage, StrainDamage) and not self.damage.damage(np.full(1, 1e-9))[0].any()
        rule = "a law of strain that is zero up to some strain"
        require(sound, self.key, "damage", getattr(self.damage, "key", None), rule)
        self.damage.averaged("equivalent_strain")
        if self.damage.length is not None:
            self._require_gradual()

    def _require_gradual(self) -> None:
        """Refuse nonlocal damage with a slope so large that the iteration would not converge."""
        strain = np.geomspace(*_STRAINS, 1 + round(np.log(_STRAINS[1] / _STRAINS[0]) / np.log1p(_SHARE / _PARTS)))
        damage = self.damage.damage(strain)[0]
        rise = damage[_PARTS:] - damage[:-_PARTS]
        worst = int(np.argmax(rise))
        steepest = f"{self.damage.key!r}, which rises by {rise[worst]:.2g} at the strain {strain[worst]:.2g}"
        rule = f"a law that rises by at most {_RISE:g} while its strain grows by {_SHARE:.0%}, where it has a length"
        require(bool(rise[worst] <= _RISE), f"{self.key}.damage", "type", steepest, f"{rule}: make the curve flatter")

    @property
    def averaged(self) -> Mapping[str, float]:
        """See `ConstitutiveLaw.averaged`."""
        return self.damage.averaged("equivalent_strain")

    @property
    def advice(self) -> str:  # type: ignore[override]
        """See `ConstitutiveLaw.advice`."""
        return "give its damage a length" if self.damage.length is None else "give its damage a larger length"

    @property
    def words(self) -> str:
        """See `ConstitutiveLaw.words`."""
        return f"brittle material ({self.damage.key})"

    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: LawStep) -> Response:
        """See `ConstitutiveLaw.update`; the tangent is that of the increment at constant means."""
        previous = before["equivalent_strain"][0]
        values, axes = principal(strain)
        stretched = np.maximum(values, 0.0)
        stretch = np.sqrt(np.sum(stretched**2, axis=0))
        largest, mean = np.maximum(previous, stretch), step.means.get("equivalent_strain")
        D, slope = self.damage.damage(largest if mean is None else np.maximum(mean[0], 0.0))
        at = Damaged.of(values, D, *self._young_and_poisson, closing=self.crack_closure)
        growing = (stretch > previous) & (mean is None)
        # Derivative of D with respect to the principal strains.
        grown = np.where(growing, slope / np.where(stretch > 0.0, stretch, 1.0), 0.0) * stretched
        tangent = tangent_of(axes, at.slopes + at.by_damage[:, None] * grown[None], at.shears)
        stress = np.einsum("ian,an->in", axes[:, :3], at.stress)
        return Response(
            stress=stress, tangent=tangent, variables={"equivalent_strain": largest[None], "damage": D[None]}
        )


eigencontact_register = hook_for(Brittle)
