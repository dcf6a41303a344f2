"""Volume sums against direct sums: every kind of layout, both libraries, both precisions, both ways of multiplying.

Relative to the largest value, at worst 8e-16 in double precision and 2.9e-7 in single were measured on these tables.
"""

from functools import cache

import numpy as np
import pytest

from eigencontact.convolution.compiling import can_compile, planes_repay
from eigencontact.convolution.volume import VolumeConvolver
from eigencontact.convolution.volume_layout import VolumeKernels, VolumeLayout
from eigencontact.convolution.weighted_sums import WeightedSums
from eigencontact.errors import SceneError

BOUND = {"double": 4e-15, "single": 1.5e-6}
LOOPS = ["numpy", pytest.param("compiled", marks=pytest.mark.skipif(not can_compile(), reason="no numba"))]

# source cells (z, y, x), target cells, position of target 0 relative to source 0 in cells
LAYOUTS = {
    "one cell": ((1, 1, 1), (1, 1, 1), (0, 0, 0)),
    "even": ((4, 6, 8), (4, 6, 8), (0, 0, 0)),
    "odd": ((3, 5, 7), (3, 5, 7), (0, 0, 0)),
    "box inside a window": ((2, 3, 4), (5, 7, 9), (-1, -2, -3)),
    "window onto a box": ((5, 7, 9), (2, 3, 4), (1, 2, 3)),
    "deeper window": ((3, 4, 2), (4, 4, 2), (5, 0, 0)),
    "half a cell deeper": ((4, 3, 5), (6, 3, 5), (0.5, 0, 0)),
    "half a cell along y": ((4, 3, 5), (3, 3, 5), (0, 0.5, 0)),
    "quarter of a cell along x": ((4, 3, 5), (3, 3, 4), (0, 0, 0.25)),
    "off along every axis": ((4, 3, 5), (3, 4, 4), (-0.5, 0.5, 0.25)),
    "far away": ((2, 3, 2), (3, 2, 4), (12, -14, 15)),
    "line onto a deeper line": ((1, 1, 6), (5, 1, 6), (2, 0, 0)),
    "column": ((9, 1, 1), (9, 1, 1), (0, 0, 0)),
    "in several pieces": ((6, 40, 3), (6, 40, 3), (0, 0, 0)),
}
SOURCES = ((1, 1), (1, 1), (-1, 1), (1, -1))
OUTPUTS = ((-1, -1), (1, 1), (-1, 1))
MIRROR = 1.5  # sum of the depths of source 0 and target 0, in cells


def influence(parity, number):
    """A decaying function of the offset with this parity along (z, y, x)."""

    def value(z, y, x):
        odd = (z if parity[0] < 0 else 1.0) * (y if parity[1] < 0 else 1.0) * (x if parity[2] < 0 else 1.0)
        return odd / (1.0 + z**2 + 1.2 * y**2 + (1.3 + 0.1 * number) * x**2) ** 1.3

    return value


class Problem:
    """Random coefficients of random kernels between all sources and outputs, powers 0 to 2."""

    def __init__(self, layout, precision="double"):
        rng = np.random.default_rng(3)
        self.layout = VolumeLayout(*layout)
        self.table, parities, self.correlations = {}, [], []
        for output, a in enumerate(OUTPUTS):
            for source, b in enumerate(SOURCES):
                for power in range(3):
                    for _ in range(rng.integers(0, 3)):
                        parities.append((int(rng.choice([-1, 1])), a[0] * b[0], a[1] * b[1]))
                        self.correlations.append(bool(rng.random() < 0.6))
                        number = len(parities) - 1
                        self.table.setdefault((output, power), {})[number, source] = rng.standard_normal()
        self.functions = [influence(parity, number) for number, parity in enumerate(parities)]
        self.kernels = VolumeKernels(self.layout, parities, self.correlations, precision=precision)
        for number, function in enumerate(self.functions):
            self.kernels.fill(number, self.sample(function, correlation=self.correlations[number]))
        self.depths = 1.0 + 0.3 * np.arange(self.layout.target[0])
        self.eigen = rng.standard_normal((len(SOURCES), *self.layout.source))

    def sample(self, function, *, correlation):
        z = self.layout.lattice_sum + MIRROR if correlation else self.layout.z.lattice
        return function(z, self.layout.y.lattice[:, None], self.layout.x.lattice[:, None, None])

    def sums(self):
        return WeightedSums(self.kernels, self.table, sources=SOURCES, outputs=OUTPUTS)

    def direct(self):
        source, target, origin = self.layout.source, self.layout.target, self.layout.origin
        grids = [np.arange(t)[:, None] - np.arange(s) + o for s, t, o in zip(source, target, origin, strict=True)]
        both = np.arange(target[0])[:, None] + np.arange(source[0]) + MIRROR
        out = np.zeros((len(OUTPUTS), *target))
        for (output, power), terms in self.table.items():
            for (number, field), value in terms.items():
                z = both if self.correlations[number] else grids[0]
                kernel = self.functions[number](
                    z[:, None, None, :, None, None], grids[1][:, None, None, :, None], grids[2][:, None, None, :]
                )
                kernel = np.broadcast_to(kernel, (*target, *source))
                out[output] += value * (self.depths**power)[:, None, None] * np.tensordot(kernel, self.eigen[field], 3)
        return out


def error(found, expected):
    return np.abs(found - expected).max() / np.abs(expected).max()


@cache
def direct_sum(name):
    """Sum of a layout, which depends neither on the precision nor on the loops."""
    return Problem(LAYOUTS[name]).direct()


@pytest.mark.parametrize("loops", LOOPS)
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("name", LAYOUTS)
def test_equals_the_direct_sum(name, precision, loops):
    problem = Problem(LAYOUTS[name], precision)
    found = VolumeConvolver(problem.sums(), problem.depths, loops=loops).apply(problem.eigen)
    assert found.dtype == (np.float64 if precision == "double" else np.float32)
    assert error(found, direct_sum(name)) < BOUND[precision]
    if precision == "single":
        assert error(found, direct_sum(name)) > 1e-9


@pytest.mark.parametrize("layout", ["odd", "off along every axis"])
def test_scipy_in_the_place_of_pyfftw(layout):
    problem = Problem(LAYOUTS[layout])
    found = VolumeConvolver(problem.sums(), problem.depths, library="scipy", loops="numpy").apply(problem.eigen)
    assert error(found, problem.direct()) < BOUND["double"]


@pytest.mark.parametrize("loops", LOOPS)
def test_repeated_calls_and_sources_that_vanish(loops):
    problem = Problem(LAYOUTS["box inside a window"])
    convolver = VolumeConvolver(problem.sums(), problem.depths, loops=loops, threads=2)
    whole = problem.eigen.copy()
    first = convolver.apply(whole)
    parts = []
    for kept in ([0, 2], [1], [3]):
        part = np.zeros_like(whole)
        part[kept] = whole[kept]
        parts.append(convolver.apply(part))
    assert error(sum(parts), first) < BOUND["double"]
    np.testing.assert_array_equal(convolver.apply(whole), first)
    np.testing.assert_array_equal(problem.eigen, whole)
    assert not convolver.apply(np.zeros_like(whole)).any()


def test_threads_do_not_change_the_answer():
    problem = Problem(((20, 20, 20), (20, 20, 20), (0, 0, 0)))
    one, two = (VolumeConvolver(problem.sums(), problem.depths, threads=n, loops="numpy") for n in (1, 2))
    assert two.threads == 2
    np.testing.assert_array_equal(one.apply(problem.eigen), two.apply(problem.eigen))


def test_rows_that_follow_from_others_are_not_transformed():
    problem = Problem(LAYOUTS["odd"])
    table = {(0, 1): {(0, 0): 1.0, (1, 1): 2.0}, (1, 1): {(0, 0): 0.5}, (2, 1): {(1, 1): -4.0}}
    kernels = VolumeKernels(problem.layout, [(1, 1, 1)] * 2, [False, True])
    for number in range(2):
        kernels.fill(number, problem.sample(influence((1, 1, 1), number), correlation=number > 0))
    sums = WeightedSums(kernels, table, sources=[(1, 1)] * 4, outputs=[(1, 1)] * 3)
    assert len(sums.rows_of(range(4))) == 2
    found = VolumeConvolver(sums, problem.depths).apply(problem.eigen)
    np.testing.assert_allclose(found[0], 2.0 * found[1] - 0.5 * found[2], atol=1e-14)
    assert np.abs(found[2]).max() > 0.1


def test_octants_are_stored():
    whole = VolumeLayout((8, 8, 8), (8, 8, 8))
    assert whole.spectrum_shape == (9, 9, 9)
    assert VolumeKernels(whole, [(1, 1, 1)] * 3, [True] * 3).nbytes == 3 * 2 * 8 * 9**3
    assert VolumeKernels(whole, [(1, 1, 1)] * 3, [True] * 3, precision="single").nbytes == 3 * 2 * 4 * 9**3


@pytest.mark.skipif(not can_compile(), reason="no numba")
@pytest.mark.parametrize(("applications", "expected"), [(1, False), (60, False), (240, True)])
def test_loops_are_compiled_where_they_repay_their_import(applications, expected):
    """4 000 padded points gain 2 ms an application; numba is there after 0.25 s."""
    problem = Problem(((8, 8, 8), (8, 8, 8)))
    convolver = VolumeConvolver(problem.sums(), problem.depths, applications=applications)
    assert convolver.compiled is expected


@pytest.mark.skipif(not can_compile(), reason="no numba")
def test_many_planes_are_summed_in_a_compiled_loop_where_that_repays_its_import():
    # 192 sources and 3 targets on planes of 64 x 64 cells gain 7 ms an application
    pairs = 192 * 3
    assert [planes_repay(pairs, pairs * 128 * 65, applications) for applications in (1, 20, 60)] == [False, False, True]


def test_refusals():
    problem = Problem(LAYOUTS["odd"])
    kernels = VolumeKernels(problem.layout, [(1, 1, 1)], [False])
    with pytest.raises(SceneError, match=r"kernels\[0\]\.parity must be \(-1, 1\)"):
        WeightedSums(kernels, {(0, 0): {(0, 0): 1.0}}, sources=[(1, 1)], outputs=[(-1, 1)])
    with pytest.raises(SceneError, match=r"convolution\.table must be of shape"):
        problem.kernels.fill(0, np.zeros((2, 2, 2)))
    with pytest.raises(SceneError, match=r"convolution\.depths must be of shape"):
        VolumeConvolver(problem.sums(), [0.0])
    with pytest.raises(SceneError, match=r"convolution\.sources must be of shape"):
        VolumeConvolver(problem.sums(), problem.depths).apply(np.zeros((4, 3, 5, 6)))
    with pytest.raises(SceneError, match=r"numerics\.loops must be"):
        VolumeConvolver(problem.sums(), problem.depths, loops="c")
