"""The convolution engine against direct sums: every layout, parity, precision and library; storage, plans, symmetries.

Measured against the direct sum on this table, relative to the largest value: at worst 1.5e-15 in double precision
(median 3e-16) and 4.2e-7 in single (median 1.1e-7); the bounds below leave a factor of five.
"""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from close import close
from eigencontact.convolution import Convolver, Layout, convolver
from eigencontact.convolution.backends import backend
from eigencontact.convolution.layout import fast_even
from eigencontact.core.parallel import in_parallel
from eigencontact.errors import SceneError

BOUND = {"double": 8e-15, "single": 2e-6}
PARITIES = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
LIBRARIES = ["pyfftw", "scipy"]

# source cells (y, x), target cells, position of target 0 relative to source 0 in cells
LAYOUTS = {
    "one cell": ((1, 1), (1, 1), (0, 0)),
    "one cell beside another": ((1, 1), (1, 1), (0, 1)),
    "even": ((4, 6), (4, 6), (0, 0)),
    "prime": ((7, 13), (7, 13), (0, 0)),
    "odd and slender": ((1, 9), (1, 9), (0, 0)),
    "slender, other way": ((11, 1), (11, 1), (0, 0)),
    "box inside a window": ((3, 5), (9, 12), (-2, -4)),
    "window onto a box": ((9, 12), (3, 5), (2, 4)),
    "shifted": ((7, 3), (2, 2), (3, 1)),
    "column onto row": ((2, 1), (1, 3), (0, -1)),
    "half cells": ((5, 4), (6, 5), (-0.5, -0.5)),
    "half a cell along y only": ((5, 5), (1, 8), (2.5, -1)),
    "fractions of a cell": ((5, 4), (6, 3), (-0.25, 0.1)),
    "far away": ((5, 5), (4, 4), (20, -30)),
    "far away by fractions": ((5, 5), (4, 3), (-40.75, 100.5)),
    "in several batches": ((37, 50), (37, 50), (0, 0)),
}


def influence(parity):
    """A decaying function of the offset that has this parity and no other symmetry."""

    def value(y, x):
        return (y if parity[0] < 0 else 1.0) * (x if parity[1] < 0 else 1.0) / (1.0 + y**2 + 1.3 * x**2) ** 1.1

    return value


def sample(layout, function):
    return function(layout.y.lattice[:, None], layout.x.lattice[None, :])


def offsets(source, target, origin, axis):
    """Target minus source position along one axis, (targets, sources)."""
    return np.arange(target[axis])[:, None] + origin[axis] - np.arange(source[axis])[None, :]


def direct(source, target, origin, field, function):
    dy, dx = (offsets(source, target, origin, axis) for axis in (0, 1))
    kernel = function(dy[:, None, :, None], dx[None, :, None, :])
    return np.tensordot(kernel, field, 2)


@pytest.mark.parametrize("parity", PARITIES, ids=str)
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS)
def test_equals_the_direct_sum(layout, library, precision, parity):
    function, plan = influence(parity), Layout(*layout)
    field = np.random.default_rng(0).standard_normal(layout[0])
    kernel = plan.spectrum(sample(plan, function), parity, precision=precision)
    found = Convolver(plan, library=library, precision=precision).apply(field, kernel)
    expected = direct(*layout, field, function)
    # an odd kernel on a single row is zero: compare with the largest kernel value then
    scale = max(np.abs(expected).max(), 1e-3)
    assert found.dtype == (np.float64 if precision == "double" else np.float32)
    assert found.shape == layout[1]
    assert np.abs(found - expected).max() <= BOUND[precision] * scale


@pytest.mark.parametrize("parity", PARITIES, ids=str)
@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (2, 2), (4, 6), (5, 7), (7, 8), (13, 10)], ids=str)
def test_periodic_equals_the_sum_of_waves(shape, library, parity):
    """Every wave by itself, summed without an FFT; the Nyquist wave of an odd response is zero."""
    dy, dx = 0.5, 2.0
    odd = (parity[0] < 0, parity[1] < 0)

    def response(ky, kx):
        return (1j * ky if odd[0] else 1.0) * (1j * kx if odd[1] else 1.0) / (1.0 + ky**2 + 2 * kx**2)

    layout = Layout(shape, shape, periodic=True)
    ky, kx = layout.wavenumbers(dy, dx)
    assert (ky.size, kx.size) == (shape[0] // 2 + 1, shape[1] // 2 + 1)
    values = response(ky[:, None] + 0j, kx[None, :] + 0j)
    field = np.random.default_rng(1).standard_normal(shape)
    found = Convolver(layout, library=library).apply(field, layout.spectrum_from_response(values, parity))

    expected = np.zeros(shape, complex)
    y, x = np.arange(shape[0])[:, None] * dy, np.arange(shape[1])[None, :] * dx
    for my in range(shape[0]):
        for mx in range(shape[1]):
            # wavenumbers above the Nyquist one are the negative ones
            qy = 2 * np.pi * (my - shape[0] * (2 * my > shape[0])) / (shape[0] * dy)
            qx = 2 * np.pi * (mx - shape[1] * (2 * mx > shape[1])) / (shape[1] * dx)
            nyquist = (odd[0] and 2 * my == shape[0]) or (odd[1] and 2 * mx == shape[1])
            wave = np.exp(1j * (qy * y + qx * x))
            amplitude = np.vdot(wave, field) / field.size
            expected += (0.0 if nyquist else response(qy, qx)) * amplitude * wave
    assert np.abs(expected.imag).max() < 1e-13
    assert np.abs(found - expected.real).max() <= 1e-13 * max(np.abs(expected).max(), 1e-3)


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("precision", ["double", "single"])
def test_matrix_of_kernels_with_gaps(library, precision):
    """Three sources, eight targets (more than are held at a time), zero kernels, a row without any."""
    layout = Layout((5, 6), (7, 4), (-1, 1))
    rng = np.random.default_rng(2)
    parities = rng.integers(0, 4, (8, 3))
    present = rng.random((8, 3)) < 0.6
    present[4] = False
    fields = rng.standard_normal((3, 5, 6))
    rows = [
        [
            layout.spectrum(sample(layout, influence(PARITIES[q])), PARITIES[q], precision=precision) if have else None
            for q, have in zip(line, flags, strict=True)
        ]
        for line, flags in zip(parities, present, strict=True)
    ]
    engine = Convolver(layout, library=library, precision=precision)
    found = engine.apply(fields, rows)
    expected = np.array(
        [
            sum(
                (
                    direct((5, 6), (7, 4), (-1, 1), field, influence(PARITIES[q]))
                    for q, have, field in zip(line, flags, fields, strict=True)
                    if have
                ),
                start=np.zeros((7, 4)),
            )
            for line, flags in zip(parities, present, strict=True)
        ]
    )
    assert engine.count == present.sum()
    assert np.all(found[4] == 0)
    assert np.abs(found - expected).max() <= BOUND[precision] * np.abs(expected).max()


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (11, 1), (4, 6), (7, 13), (37, 50), (300, 310)], ids=str)
def test_energy_is_the_field_times_its_convolution(shape, library, periodic):
    layout = Layout(shape, shape, periodic=periodic)
    if periodic:
        ky, kx = layout.wavenumbers(1.0, 1.0)
        kernel = layout.spectrum_from_response((1.0 / (1.0 + ky[:, None] + 2.0 * kx)).astype(complex), (1, 1))
    else:
        kernel = layout.spectrum(sample(layout, influence((1, 1))), (1, 1))
    field = np.random.default_rng(1).standard_normal(shape)
    energies = [Convolver(layout, library=library, threads=threads).energy(field, kernel) for threads in (1, 2)]
    expected = float(np.sum(field * Convolver(layout, library=library).apply(field, kernel)))
    assert energies[0] == energies[1]
    assert energies[0] == close(expected, rel=1e-12)


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("precision", ["double", "single"])
def test_threads_give_the_same_bits(library, precision):
    layout = Layout((150, 170), (150, 170))
    kernel = layout.spectrum(sample(layout, influence((1, -1))), (1, -1), precision=precision)
    field = np.random.default_rng(3).standard_normal((150, 170))
    engines = [Convolver(layout, library=library, precision=precision, threads=n) for n in (1, 2)]
    assert [engine.threads for engine in engines] == [1, 2]
    one, two = (engine.apply(field, kernel) for engine in engines)
    assert np.array_equal(one, two)
    row = direct((150, 170), (1, 170), (70, 0), field, influence((1, -1)))
    assert np.abs(two[70] - row).max() <= BOUND[precision] * np.abs(row).max()


def test_planning_with_measurements_does_not_spoil_the_first_result():
    layout = Layout((20, 30), (25, 30), (-3, 0))
    kernel = layout.spectrum(sample(layout, influence((1, 1))), (1, 1))
    fields = np.random.default_rng(7).standard_normal((2, 20, 30))
    measured = Convolver(layout, library="pyfftw", effort="measure")
    expected = Convolver(layout, library="scipy").apply(fields, [[kernel, kernel], [None, kernel]])
    for _ in range(2):
        found = measured.apply(fields, [[kernel, kernel], [None, kernel]])
        assert np.abs(found - expected).max() < 3e-12


def test_small_grids_do_not_pay_for_threads():
    assert Convolver(Layout((8, 8), (8, 8)), threads=2).threads == 1


def test_an_error_in_a_thread_is_raised():
    def fail():
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        in_parallel(2, [lambda: None, fail])


# --- what is stored, and what is not done ------------------------------------------------------------------------


@pytest.mark.parametrize("parity", PARITIES, ids=str)
@pytest.mark.parametrize(("precision", "kind"), [("double", np.float64), ("single", np.float32)])
def test_spectrum_with_parity_is_real_and_a_quarter(parity, precision, kind):
    layout = Layout((30, 20), (30, 20))
    kernel = layout.spectrum(sample(layout, influence(parity)), parity, precision=precision)
    assert (layout.y.length, layout.x.length) == (64, 40)
    assert kernel.values.shape == (21, 33)
    assert kernel.values.dtype == kind
    assert kernel.nbytes == 21 * 33 * np.dtype(kind).itemsize
    assert kernel.imaginary == (parity[0] * parity[1] < 0)


@pytest.mark.parametrize(
    ("origin", "shape"), [((0.5, 0), (21, 64)), ((0, 0.5), (21, 33)), ((0.5, 0.5), (21, 64)), ((90, 0), (21, 64))]
)
def test_parity_is_given_up_only_along_the_axis_that_lacks_it(origin, shape):
    layout = Layout((30, 20), (30, 20), origin)
    kernel = layout.spectrum(sample(layout, influence((1, 1))), (1, 1))
    assert kernel.values.shape == shape
    assert kernel.values.dtype == np.complex128


@pytest.mark.parametrize(
    ("layout", "lengths"),
    [
        (((64, 64), (64, 64), (0, 0)), (128, 128)),
        (((1, 1), (1, 1), (0, 0)), (1, 1)),
        (((10, 10), (30, 30), (-10, -10)), (40, 40)),  # box in a window: parity, source rows plus target rows
        (((10, 10), (10, 10), (1000, 0)), (20, 20)),  # far away: no longer than the two boxes
    ],
)
def test_padding_is_no_longer_than_it_must_be(layout, lengths):
    plan = Layout(*layout)
    assert (plan.y.length, plan.x.length) == lengths


@pytest.mark.parametrize("n", [1, 2, 3, 13, 14, 17, 97, 127, 509, 1021, 2047])
def test_fast_lengths_are_even_smooth_and_near(n):
    length = fast_even(n)
    rest = length
    for factor in (2, 3, 5, 7, 11):
        while rest % factor == 0:
            rest //= factor
    assert rest == 1
    assert n <= length <= max(1.2 * n + 1, 4)
    assert length == 1 or length % 2 == 0


class Counting:
    """A backend that counts the plans it makes, and notes the shapes of what is transformed."""

    def __init__(self, inner):
        self.inner, self.name, self.empty = inner, inner.name, inner.empty
        self.plans, self.done = 0, []

    def _counted(self, make, kind, source, target):
        self.plans += 1
        plan = make(source, target)

        def execute():
            self.done.append((kind, source.shape))
            plan()

        return execute

    def forward(self, source, target):
        axis = "columns" if np.iscomplexobj(source) else "rows"
        return self._counted(self.inner.forward, f"{axis} forward", source, target)

    def inverse(self, source, target):
        axis = "columns" if np.iscomplexobj(target) else "rows"
        return self._counted(self.inner.inverse, f"{axis} inverse", source, target)


@pytest.fixture(params=LIBRARIES)
def counting(request, monkeypatch):
    made = Counting(backend(request.param))
    monkeypatch.setattr(convolver, "backend", lambda *_: made)
    return made


def test_rows_of_zeros_are_not_transformed(counting):
    """Along x only the 10 source rows forwards and the 30 target rows backwards, of 40 rows in the padded box."""
    layout = Layout((10, 10), (30, 30), (-10, -10))
    engine = Convolver(layout, threads=1)
    engine.apply(np.ones((10, 10)), layout.spectrum(sample(layout, influence((1, 1))), (1, 1)))
    work = {kind: sum(shape[0] for other, shape in counting.done if other == kind) for kind, _ in counting.done}
    assert work == {"rows forward": 10, "columns forward": 21, "columns inverse": 21, "rows inverse": 30}
    assert {shape[1] for _, shape in counting.done} == {40, 21}


def test_plans_and_buffers_are_made_once(counting):
    layout = Layout((9, 12), (9, 12))
    kernel = layout.spectrum(sample(layout, influence((1, 1))), (1, 1))
    engine = Convolver(layout)
    field = np.ones((9, 12))
    engine.apply(field, kernel)
    plans, memory = counting.plans, engine.nbytes
    assert plans == 4  # rows forwards and backwards, columns forwards and backwards
    for _ in range(5):
        engine.apply(field, kernel)
    assert (counting.plans, engine.nbytes, engine.count) == (plans, memory, 6)


def test_the_padded_field_is_never_held():
    """Half-transformed rows of the source or the target, and five batches of bounded size: less than the padded box."""
    layout = Layout((512, 512), (512, 512))
    engine = Convolver(layout, threads=1)
    engine.apply(np.ones((512, 512)), layout.spectrum(np.ones((513, 513)), (1, 1)))
    half_rows = 512 * 513 * 16
    assert engine.nbytes <= half_rows + 6 * convolver._BATCH_BYTES
    assert engine.nbytes < 1024 * 513 * 16


def test_results_are_fresh_memory_and_sources_untouched():
    layout = Layout((6, 5), (6, 5))
    kernel = layout.spectrum(sample(layout, influence((1, 1))), (1, 1))
    engine = Convolver(layout)
    field = np.random.default_rng(4).standard_normal((6, 5))
    field.setflags(write=False)
    first = engine.apply(field, kernel)
    kept = first.copy()
    engine.apply(-3.0 * field, kernel)
    assert np.array_equal(first, kept)
    assert np.array_equal(engine.apply(field, kernel), kept)


def test_fewer_sources_after_more_leave_no_trace():
    layout = Layout((4, 5), (4, 5))
    kernel = layout.spectrum(sample(layout, influence((1, 1))), (1, 1))
    field = np.random.default_rng(5).standard_normal((2, 4, 5))
    engine = Convolver(layout)
    engine.apply(field, [[kernel, kernel]])
    assert np.array_equal(engine.apply(field[:1], [[kernel]]), Convolver(layout).apply(field[:1], [[kernel]]))


# --- exact symmetries --------------------------------------------------------------------------------------------

SIZES = st.tuples(st.integers(1, 9), st.integers(1, 9))
EXACT = settings(deadline=None, derandomize=True, max_examples=40)


def convolve(field, parity, *, swapped=False):
    layout = Layout(field.shape, field.shape)
    function = influence(parity)
    table = sample(layout, (lambda y, x: function(x, y)) if swapped else function)
    return Convolver(layout).apply(field, layout.spectrum(table, parity[::-1] if swapped else parity))


@EXACT
@given(SIZES, st.sampled_from(PARITIES), st.integers(0, 2**32 - 1))
def test_superposition(shape, parity, seed):
    a, b = np.random.default_rng(seed).standard_normal((2, *shape))
    together = convolve(2.5 * a - 0.75 * b, parity)
    assert np.abs(together - (2.5 * convolve(a, parity) - 0.75 * convolve(b, parity))).max() < 3e-12


@EXACT
@given(SIZES, st.sampled_from(PARITIES), st.integers(0, 2**32 - 1))
def test_mirrors(shape, parity, seed):
    field = np.random.default_rng(seed).standard_normal(shape)
    value = convolve(field, parity)
    assert np.abs(convolve(field[::-1], parity) - parity[0] * value[::-1]).max() < 1e-12
    assert np.abs(convolve(field[:, ::-1], parity) - parity[1] * value[:, ::-1]).max() < 1e-12


@EXACT
@given(SIZES, st.sampled_from(PARITIES), st.integers(0, 2**32 - 1))
def test_transposition_and_quarter_turn(shape, parity, seed):
    """Exchanging the axes of field and kernel exchanges those of the result; a quarter turn adds a mirror."""
    field = np.random.default_rng(seed).standard_normal(shape)
    value = convolve(field, parity)
    turned = convolve(np.rot90(field), (parity[0], parity[1]), swapped=True)
    assert np.abs(convolve(field.T, parity, swapped=True) - value.T).max() < 1e-12
    assert np.abs(turned - parity[1] * np.rot90(value)).max() < 1e-12


@EXACT
@given(SIZES, SIZES, st.tuples(st.integers(-12, 12), st.integers(-12, 12)), st.sampled_from(PARITIES))
def test_reciprocity_of_two_boxes(source, target, origin, parity):
    """What box A does to box B is, transposed and with the kernel's parity, what B does to A."""
    rng = np.random.default_rng(6)
    a, b = rng.standard_normal(source), rng.standard_normal(target)
    there, back = Layout(source, target, origin), Layout(target, source, (-origin[0], -origin[1]))
    function = influence(parity)
    forward = Convolver(there).apply(a, there.spectrum(sample(there, function), parity))
    reverse = Convolver(back).apply(b, back.spectrum(sample(back, function), parity))
    assert abs(np.vdot(forward, b) - parity[0] * parity[1] * np.vdot(a, reverse)) < 2e-11


# --- refusals ----------------------------------------------------------------------------------------------------

SQUARE = Layout((4, 6), (4, 6))
EVEN = SQUARE.spectrum(np.ones((len(SQUARE.y.lattice), len(SQUARE.x.lattice))), (1, 1))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: Convolver(SQUARE).apply(np.ones((6, 4)), EVEN),
            r"convolution\.sources must be of shape \(1, 4, 6\) \(got \(1, 6, 4\)\)",
        ),
        (lambda: Convolver(SQUARE).apply(np.ones(24), EVEN), r"convolution\.sources must be of shape \(1, 4, 6\)"),
        (lambda: Convolver(SQUARE).apply(np.ones((4, 6)), [[EVEN]]), r"convolution\.sources must be of shape"),
        (
            lambda: Convolver(SQUARE).apply(np.ones((1, 4, 6)), [[EVEN, EVEN]]),
            r"convolution\.kernels must be rows of 1 kernels, one for each source \(got \[2\]\)",
        ),
        (
            lambda: Convolver(Layout((9, 9), (9, 9))).apply(np.ones((9, 9)), EVEN),
            r"convolution\.kernels must be of this convolver's layout",
        ),
        (lambda: SQUARE.spectrum(np.ones((4, 6)), (1, 1)), r"convolution\.table must be of shape"),
        (
            lambda: Layout((5, 5), (5, 5), periodic=True).spectrum(np.ones((3, 3)), (1, 1)),
            r"convolution\.periodic must be False where a table is given",
        ),
        (lambda: Layout((0, 4), (4, 4)).y, r"convolution\.source must be at least 1 cell \(got 0\)"),
        (lambda: Layout((4, 4), (4, 0)).x, r"convolution\.target must be at least 1 cell \(got 0\)"),
        (lambda: Layout((4, 4), (5, 4), periodic=True).y, r"convolution\.target must be the source's size"),
        (lambda: Layout((4, 4), (4, 4), (0, 0.5), periodic=True).x, r"convolution\.origin must be a whole number"),
        (lambda: Convolver(SQUARE, precision="half"), r"numerics\.precision must be 'double' or 'single' \(got 'ha"),
        (lambda: Convolver(SQUARE, threads=-1), r"numerics\.threads must be at least 1 \(got -1\)"),
        (lambda: Convolver(SQUARE, library="fftpack"), r"numerics\.library must be 'auto', 'pyfftw' or 'scipy'"),
    ],
)
def test_refusals_say_what_is_wrong(call, message):
    with pytest.raises(SceneError, match=message):
        call()


def test_works_by_itself():
    """In a fresh process with the documented example; neither plugins nor planning nor solvers are loaded."""
    code = (
        "import doctest, sys, eigencontact.convolution as c; r = doctest.testmod(c); "
        "assert r.attempted >= 7 and not r.failed; "
        "bad = [m for m in sys.modules if m.startswith(('eigencontact_plugins', 'eigencontact.planning', "
        "'eigencontact.solvers', 'eigencontact.scene', 'matplotlib'))]; assert not bad, bad"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
