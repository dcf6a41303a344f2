"""Transforms of small tables by numpy: against scipy's cosine and sine transforms, and against the plain sum."""

import numpy as np
import pytest

from eigencontact.convolution import spectrum
from eigencontact.convolution.spectrum import parity_transform


@pytest.mark.parametrize("kind", [float, complex])
@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("n", [2, 3, 8, 37])
@pytest.mark.parametrize("sign", [1, -1])
def test_small_and_large_tables_are_transformed_alike(monkeypatch, sign, n, axis, kind):
    random = np.random.default_rng(n)
    table = random.normal(size=(n, 5) if axis == 0 else (5, n)).astype(kind)
    if kind is complex:
        table += 1j * random.normal(size=table.shape)
    small = parity_transform(table, axis, sign, 1)
    monkeypatch.setattr(spectrum, "_SMALL", 0)
    large = parity_transform(table, axis, sign, 1)
    assert small.dtype == large.dtype
    np.testing.assert_allclose(small, large, rtol=1e-13, atol=1e-13)
    k, j = np.arange(n)[:, None], np.arange(1, n - 1)
    inner = np.moveaxis(table, axis, 0)[1:-1]
    if sign > 0:
        ends = np.moveaxis(table, axis, 0)[[0, -1]]
        plain = ends[0] + (-1.0) ** k * ends[1] + 2 * np.cos(np.pi * k * j / (n - 1)) @ inner
    else:
        plain = 2 * np.sin(np.pi * k * j / (n - 1)) @ inner
    np.testing.assert_allclose(np.moveaxis(small, axis, 0), plain, rtol=1e-12, atol=1e-12)


def test_one_value_is_its_own_transform():
    assert parity_transform(np.array([[3.0]]), 0, 1, 1) == 3.0
    assert parity_transform(np.array([[3.0]]), 0, -1, 1) == 0.0
