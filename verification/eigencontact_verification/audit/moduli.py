"""Elastic constants of a law as finite elements take them, and the exception for what they cannot represent."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from eigencontact.core.material import Material

__all__ = ["NotJudged", "moduli_of"]

#: Young's modulus of a void over that of the body: small, and the system stays solvable.
VOID = 1e-6


class NotJudged(Exception):
    """The finite-element models of this package cannot represent a feature; the text is the reason."""


def moduli_of(law: Any, body: Material) -> tuple[float, float]:
    """Young's modulus [Pa] and Poisson's ratio of a law; a void has `VOID` of the modulus of the body.

    Raises
    ------
    NotJudged
        The law is anisotropic, varies in space, or closes its cracks.
    """
    from eigencontact.plugin import LinearLaw

    if law.varies:
        raise NotJudged(
            f"the constants of the law {getattr(law, 'key', '')!r} vary in space, and the elements need uniform ones"
        )
    if getattr(law, "crack_closure", False):
        raise NotJudged(f"the law {law.key!r} closes its cracks, and the elements scale the whole stiffness")
    if isinstance(law, LinearLaw):
        stiffness = np.asarray(law.stiffness_matrix(), dtype=float)
        if not law.isotropic:
            raise NotJudged(f"the law {law.key!r} is anisotropic, and the elements are isotropic")
        twice_shear, lame = float(stiffness[3, 3]), float(stiffness[0, 1])
        if twice_shear == 0.0:
            return VOID * body.young_modulus, body.poisson_ratio
        nu = lame / (2.0 * lame + twice_shear)
        return twice_shear * (1.0 + nu), nu
    constants = getattr(law, "young_modulus", None), getattr(law, "poisson_ratio", None)
    if constants[0] is None or constants[1] is None:
        raise NotJudged(f"the law {law.key!r} has no attributes young_modulus and poisson_ratio")
    return float(constants[0]), float(constants[1])
