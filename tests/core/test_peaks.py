"""The top of a paraboloid is found from means over cells, wherever it lies in its cell."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from close import close
from eigencontact.core.peaks import peak_of_means


def means(top, curvature, edges=(1.0, 1.0), count=7):
    """Means of a paraboloid of height 1 over cells of some edges; its top lies at `top`, in cells from the middle."""
    along = []
    for offset, curve, edge in zip(top, curvature, edges, strict=True):
        ends = edge * (np.arange(count + 1) - 0.5 * count - offset)
        along.append(0.5 * curve * np.diff(ends**3) / (3.0 * edge))
    return 1.0 - (along[0][:, None] + along[1][None, :])


@given(
    top=st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5)),
    curvature=st.tuples(st.floats(0.01, 1.0), st.floats(0.01, 1.0)),
    edges=st.tuples(st.floats(0.2, 2.0), st.floats(0.2, 2.0)),
)
def test_paraboloids_are_exact(top, curvature, edges):
    assert peak_of_means(means(top, curvature, edges)) == close(1.0, rel=1e-12)


def test_without_a_maximum_along_an_axis_the_mean_counts():
    line = means((0.0, 0.0), (0.0, 0.3))
    assert peak_of_means(line) == close(1.0, rel=1e-12)
    assert peak_of_means(line[:1, :1]) == line[0, 0]
    assert peak_of_means(np.zeros((3, 3))) == 0.0


@pytest.mark.parametrize("axis", [0, 1])
def test_a_maximum_at_the_edge_of_the_grid_is_its_mean(axis):
    slope = np.moveaxis(np.tile(np.arange(5.0), (4, 1)), 1, axis)
    assert peak_of_means(slope) == 4.0
