"""Several laws by depth: for example a hardened layer, or a yielding substrate below an elastic layer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    ConstitutiveLaw,
    FloatArray,
    LawStep,
    Length,
    Response,
    Variable,
    hook_for,
    require,
)

__all__ = ["ByDepth"]


@dataclass(frozen=True, kw_only=True)
class ByDepth(ConstitutiveLaw):
    """Laws by depth: one law above each interface, and another below the last.

    A cell has the law at the depth of its centre: interfaces that do not coincide with faces of cells move by at most
    half a cell (``numerics.inclusion-pitch`` sets the height of cells). A point on an interface has the deeper law.

    Parameters
    ----------
    interfaces : tuple of float
        Depths [m], positive and ascending.
    laws : tuple of ConstitutiveLaw
        Laws from the surface down, one more than interfaces; ``{ type = "elastic" }`` is an elastic part.
    """

    key: ClassVar[str] = "by-depth"
    example: ClassVar[dict[str, Any]] = {
        "interfaces": ["2 um"],
        "laws": [
            {"type": "elastic", "young_modulus": "210 GPa", "poisson_ratio": 0.3},
            {
                "type": "j2",
                "young_modulus": "210 GPa",
                "poisson_ratio": 0.3,
                "hardening": {"type": "perfect", "yield_stress": "1 GPa"},
            },
        ],
    }
    references: ClassVar[tuple[str, ...]] = ("K. L. Johnson 1985, Contact Mechanics, section 5.8",)

    interfaces: tuple[Length, ...]
    laws: tuple[ConstitutiveLaw, ...]

    def __post_init__(self) -> None:
        depths = np.asarray(self.interfaces, dtype=float)
        good = bool(depths.size and np.all(np.isfinite(depths)) and depths[0] > 0 and np.all(np.diff(depths) > 0))
        require(good, self.key, "interfaces", self.interfaces, "one depth or more, positive and ascending [m]")
        rule = f"{depths.size + 1} laws, one more than interfaces"
        require(len(self.laws) == depths.size + 1, self.key, "laws", [law.key for law in self.laws], rule)
        for law in self.laws:
            for name, variable in law.variables.items():
                rule = f"laws that remember {name!r} alike: stored as one field"
                require(
                    self.variables[name] == variable, self.key, "laws", [other_law.key for other_law in self.laws], rule
                )

    @property
    def variables(self) -> Mapping[str, Variable]:  # type: ignore[override]
        """See `ConstitutiveLaw.variables`: variables of all laws; zero in laws without the variable."""
        return {name: variable for law in reversed(self.laws) for name, variable in law.variables.items()}

    @property
    def symmetric(self) -> bool:  # type: ignore[override]
        """See `ConstitutiveLaw`."""
        return all(law.symmetric for law in self.laws)

    @property
    def isotropic(self) -> bool:  # type: ignore[override]
        """See `ConstitutiveLaw`."""
        return all(law.isotropic for law in self.laws)

    def of_body(self, young_modulus: float, poisson_ratio: float) -> ByDepth:
        """See `ConstitutiveLaw.of_body`."""
        return replace(self, laws=tuple(law.of_body(young_modulus, poisson_ratio) for law in self.laws))

    def laws_at(
        self,
        x: FloatArray,  # noqa: ARG002
        y: FloatArray,  # noqa: ARG002
        z: FloatArray,
    ) -> list[tuple[ConstitutiveLaw, NDArray[np.bool_]]]:
        """See `ConstitutiveLaw.laws_at`."""
        layer = np.searchsorted(np.asarray(self.interfaces), z, side="right")
        return [(law, layer == number) for number, law in enumerate(self.laws)]

    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: LawStep) -> Response:
        """See `ConstitutiveLaw.update`."""
        stress, tangent = np.empty_like(strain), np.empty((6, *strain.shape))
        after = {name: np.array(values) for name, values in before.items()}
        for law, in_layer in self.laws_at(step.x, step.y, step.z):
            place = replace(step, x=step.x[in_layer], y=step.y[in_layer], z=step.z[in_layer])
            response = law.update(
                strain[:, in_layer], {name: before[name][:, in_layer] for name in law.variables}, place
            )
            stress[:, in_layer] = response.stress
            tangent[:, :, in_layer] = response.tangent if response.tangent.ndim == 3 else response.tangent[..., None]
            for name, values in response.variables.items():
                after[name][:, in_layer] = values
        return Response(stress=stress, tangent=tangent, variables=after)

    @property
    def words(self) -> str:
        """See `ConstitutiveLaw.words`."""
        return f"layers, from the surface down: {'; '.join(law.words for law in self.laws)}"


eigencontact_register = hook_for(ByDepth)
