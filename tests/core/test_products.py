"""Matrix products in tiles."""

import numpy as np
import pytest

from eigencontact.core.products import TILE, product


@pytest.mark.parametrize(
    "shape", [(3, 4, 5), (1, 300, 1000), (TILE, TILE, TILE), (TILE + 1, TILE, TILE), (257, 36, 257), (130, 65, 200)]
)
def test_tiles_make_up_the_product(shape):
    rng = np.random.default_rng(1)
    left, right = rng.standard_normal(shape[:2]), rng.standard_normal(shape[1:][::-1]).T
    exact = np.einsum("ik,kj->ij", left, right)
    np.testing.assert_allclose(product(left, right), exact, rtol=0, atol=1e-13 * shape[1])
