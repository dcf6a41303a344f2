"""Regions with one elasticity all over, and those among them that carry no stress."""

from __future__ import annotations

import numpy as np

from eigencontact.model.sources import Inhomogeneity
from eigencontact.plugin import LinearLaw

__all__ = ["is_empty", "uniform_elasticity"]


def uniform_elasticity(source: Inhomogeneity) -> LinearLaw | None:
    """Law of a region that is elastic with the same constants all over; None for others."""
    return source.law if isinstance(source.law, LinearLaw) and not source.law.varies else None


def is_empty(source: Inhomogeneity) -> bool:
    """Whether a region carries no stress at all."""
    law = uniform_elasticity(source)
    # The factors are bounded for every material; a rigid one has no stiffness to ask for.
    return law is not None and not np.any(law.factors(1.0)[1])
