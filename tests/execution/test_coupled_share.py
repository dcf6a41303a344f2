"""Share of the compliance that a contact over soft regions is solved with."""

import numpy as np
import pytest

from eigencontact.execution.mechanics.coupled import _ComplianceRatio, _Round


@pytest.mark.parametrize("largest", [0.5, 2.0, 3.7, 7.383, 11.0, 40.0])
def test_every_ratio_that_was_seen_shrinks_in_a_round(largest):
    """Ratios R/S from 0 on: a round leaves |R/S - θ| / (1 + θ) of an error. 7.383 is a void 1.05 radii deep."""
    seen, one, share = _ComplianceRatio(), np.ones((1, 2, 2)), 0.0
    for number in range(4):
        total = number * one
        residual = largest * max(number - 1, 0) * one  # no compliance from the first round to the second
        share = seen.share(_Round(traction=total, elastic=total, residual=residual))
    assert (largest - share) / (1.0 + share) < 0.91
