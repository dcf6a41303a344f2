"""Friction laws: bounds at cells, maps of the coefficient, what is refused, and what is refused of a stranger's law."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from eigencontact import make
from eigencontact.errors import PluginError, SceneError
from eigencontact.plugin import FrictionLaw, FrictionState
from eigencontact.plugin.friction import checked_shear_bound
from one_line import one_line_error
from plugins.wrong_answers import wrong_answers

UM = 1e-6
X, Y = UM * np.arange(-2.0, 3.0)[None, :], UM * np.arange(-1.0, 2.0)[:, None]
SHAPE = (3, 5)


def state(pressure=None, x=X, y=Y, slip_distance=0.0, time=1.0):
    shape = np.broadcast_shapes(x.shape, y.shape)
    pressure = np.full(shape, 100.0) if pressure is None else np.array(pressure, dtype=float)
    slipped = np.broadcast_to(slip_distance, shape).astype(float)
    return FrictionState(pressure=pressure, x=x, y=y, slip_distance=slipped, time=time)


def law(key, **fields):
    return make(key, kind="friction-law", **fields)


RAMP = np.arange(15.0).reshape(SHAPE)
# key, fields, expected bound at the pressures 0 ... 14 Pa
BOUNDS = {
    "coulomb": ("coulomb", {"coefficient": 0.5}, 0.5 * RAMP),
    "frictionless": ("coulomb", {"coefficient": 0.0}, 0.0 * RAMP),
    "more than 1": ("coulomb", {"coefficient": 5.0}, 5.0 * RAMP),
    "cap": (
        "shear-cap",
        {"coefficient": 0.5, "cap": 3.0},
        [[0.0, 0.5, 1.0, 1.5, 2.0], [2.5, 3.0, 3.0, 3.0, 3.0], [3.0] * 5],
    ),
    "cap with a unit": ("shear-cap", {"coefficient": 2.0, "cap": "1 MPa"}, 2.0 * RAMP),
    "circle": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": {"center": ("1 um", 0), "radius": "1 um", "coefficient": 0.5}},
        RAMP * [[0.1, 0.1, 0.1, 0.5, 0.1], [0.1, 0.1, 0.5, 0.5, 0.5], [0.1, 0.1, 0.1, 0.5, 0.1]],
    ),
    "rectangle": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [{"size": ("2.2 um", "0.4 um"), "coefficient": 0.5}]},
        RAMP * [[0.1] * 5, [0.1, 0.5, 0.5, 0.5, 0.1], [0.1] * 5],
    ),
    "turned rectangle": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [{"size": ("2.9 um", "0.2 um"), "angle": "45 deg", "coefficient": 0.5}]},
        RAMP * [[0.1, 0.5, 0.1, 0.1, 0.1], [0.1, 0.1, 0.5, 0.1, 0.1], [0.1, 0.1, 0.1, 0.5, 0.1]],
    ),
    "the last region counts": (
        "coulomb-map",
        {
            "coefficient": 0.1,
            "regions": [
                {"size": ("9 um", "9 um"), "coefficient": 0.2},
                {"center": ("-2 um", "-1 um"), "radius": "0.1 um", "coefficient": 0.0},
                {"center": ("2 um", "0 um"), "size": ("1 um", "9 um"), "coefficient": 0.3},
            ],
        },
        RAMP * [[0.0, 0.2, 0.2, 0.2, 0.3], [0.2, 0.2, 0.2, 0.2, 0.3], [0.2, 0.2, 0.2, 0.2, 0.3]],
    ),
}


@pytest.mark.parametrize("case", BOUNDS)
def test_bounds(case):
    key, fields, expected = BOUNDS[case]
    np.testing.assert_allclose(checked_shear_bound(law(key, **fields), state(RAMP)), expected, rtol=1e-15, atol=0)


@pytest.fixture
def mapped(tmp_path):
    """Write μ = 0.1 + 0.02 x/µm + 0.03 y/µm on x = -2, -1 ... 2 µm and y = -1, 0, 1 µm; give its file and the map."""
    values = 0.1 + 0.02 * X / UM + 0.03 * Y / UM

    def write(name="map.npz", **arrays):
        path = tmp_path / name
        if path.suffix == ".npz":
            np.savez(path, **({"x": X[0], "y": Y[:, 0], "coefficient": values} | arrays))
        else:
            rows = np.array([(x / UM, y / UM, v) for y, r in zip(Y[:, 0], values, strict=True)
                             for x, v in zip(X[0], r, strict=True)])  # fmt: skip
            np.savetxt(path, np.random.default_rng(3).permutation(rows), header="x y coefficient")
        return str(path)

    return write, values


@pytest.mark.parametrize("name", ["map.npz", "map.txt"])
@pytest.mark.parametrize("interpolation", ["linear", "nearest"])
def test_a_map_is_exact_at_its_points(name, interpolation, mapped):
    write, values = mapped
    unit = {} if name.endswith("npz") else {"lateral_unit": "1 um"}
    found = law("coulomb-map", file=write(name), interpolation=interpolation, **unit)
    np.testing.assert_allclose(checked_shear_bound(found, state()), 100 * values, rtol=1e-13)


def test_between_its_points_a_map_is_bilinear_and_constant_in_the_outer_half_step(mapped):
    write, _ = mapped
    file = write()
    x, y = UM * np.array([[-2.4, -1.3, 0.25, 2.4]]), UM * np.array([[-1.4], [0.6]])
    held = 0.1 + 0.02 * np.clip(x / UM, -2, 2) + 0.03 * np.clip(y / UM, -1, 1)
    np.testing.assert_allclose(law("coulomb-map", file=file).coefficients(x, y), held, rtol=1e-12)
    nearest = 0.1 + 0.02 * np.array([-2, -1, 0, 2]) + 0.03 * np.array([[-1], [1]])
    found = law("coulomb-map", file=file, interpolation="nearest").coefficients(x, y)
    np.testing.assert_allclose(found, nearest, rtol=1e-12)


def test_contact_outside_a_map_takes_the_coefficient_given_for_it_or_is_refused(mapped):
    write, values = mapped
    file, x = write(), UM * np.arange(-3.0, 3.0)[None, :]
    wide = np.concatenate([np.full((3, 1), 0.9), values], axis=1)
    np.testing.assert_allclose(law("coulomb-map", file=file, coefficient=0.9).coefficients(x, Y), wide, rtol=1e-12)
    alone = law("coulomb-map", file=file)
    with pytest.raises(SceneError, match=r"coulomb-map\.file must cover the contact .* x = -3e-06 m, y = -1e-06 m\); "):
        checked_shear_bound(alone, state(x=x))
    inner = np.where(x < -2.5 * UM, 0.0, np.full((3, 6), 100.0))
    bound = checked_shear_bound(alone, state(inner, x=x))
    np.testing.assert_allclose(bound[:, 1:], 100 * values, rtol=1e-12)
    assert not bound[:, 0].any()
    patched = law("coulomb-map", file=file, regions=[{"center": ("-3 um", 0), "size": ("1 um", "9 um"),
                                                      "coefficient": 0.9}])  # fmt: skip
    np.testing.assert_allclose(checked_shear_bound(patched, state(x=x)), 100 * wide, rtol=1e-12)


def test_a_map_answers_for_the_cells_that_it_is_asked_about():
    """It remembers the coefficients of the last cells, and no others."""
    found = law("coulomb-map", coefficient=0.1, regions=[{"radius": "0.5 um", "coefficient": 0.5}])
    for shift in (0.0, 1.0, 0.0, 2.0):
        bound = checked_shear_bound(found, state(x=X + shift * UM))
        assert [tuple(at) for at in np.argwhere(bound == 50.0)] == [(1, 2 - int(shift))]


PATCH = {"radius": 1.0, "coefficient": 0.2}
# key, fields, words of the refusal
REFUSED = {
    "negative": ("coulomb", {"coefficient": -0.1}, "coulomb.coefficient must be zero or positive, and finite [-] (got"),
    "NaN": ("coulomb", {"coefficient": float("nan")}, "coulomb.coefficient must be zero or positive, and finite [-]"),
    "infinite": ("coulomb", {"coefficient": float("inf")}, "coulomb.coefficient must be zero or positive, and finite"),
    "missing": ("coulomb", {}, "coulomb.coefficient must be given (coulomb needs it)"),
    "typo": ("coulomb", {"coeficient": 0.1}, "unknown key 'coeficient' in coulomb (coulomb); known: coefficient; did"),
    "no cap": ("shear-cap", {"coefficient": 0.1, "cap": 0.0}, "shear-cap.cap must be positive and finite [Pa] (got 0"),
    "cap of a length": ("shear-cap", {"coefficient": 0.1, "cap": "3 um"}, "shear-cap.cap must be a stress [Pa]; '3"),
    "nothing": ("coulomb-map", {"coefficient": 0.1}, "coulomb-map must have a file or regions (got neither); or set"),
    "no base": ("coulomb-map", {"regions": [PATCH]}, "coulomb-map.coefficient must be given without a file, for"),
    "no file": ("coulomb-map", {"file": "no.npz"}, "coulomb-map.file must be an existing file (got 'no.npz'); a rel"),
    "method": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [PATCH], "interpolation": "cubic"},
        "coulomb-map.interpolation must be one of 'linear' or 'nearest' (got 'cubic')",
    ),
    "region without extent": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [PATCH, {"coefficient": 0.2}]},
        "coulomb-map.regions.1 must have a size (a rectangle) or a radius (a circle) (got neither)",
    ),
    "region of both": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [PATCH | {"size": (1.0, 1.0)}]},
        "coulomb-map.regions.0 must have a size (a rectangle) or a radius (a circle) (got both)",
    ),
    "region, negative": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [PATCH | {"coefficient": -0.2}]},
        "coulomb-map.regions.0.coefficient must be zero or positive, and finite [-] (got -0.2)",
    ),
    "region, edge": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [{"size": (1.0, 0.0), "coefficient": 0.2}]},
        "coulomb-map.regions.0.size must be two positive and finite lengths (got (1.0, 0.0))",
    ),
    "region, unit": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [PATCH | {"radius": "2 N"}]},
        "coulomb-map.regions.0.radius must be a length [m]; '2 N' has the dimension",
    ),
    "region, typo": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [{"radios": 1.0, "coefficient": 0.2}]},
        "unknown key 'radios' in coulomb-map.regions.0; known: coefficient, center, size, angle, radius; did you mean",
    ),
    "region, missing": (
        "coulomb-map",
        {"coefficient": 0.1, "regions": [{"radius": 1.0}]},
        "coulomb-map.regions.0.coefficient must be given",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_refusals(case):
    key, fields, words = REFUSED[case]
    with one_line_error(words):
        law(key, **fields)


HOLED = np.full(SHAPE, 0.1)
HOLED[1, 2] = np.nan
FILES = {
    "NaN": ({"coefficient": HOLED}, "a file with finite coefficient [1]", "1 of 15 are not, the first is nan"),
    "negative": (
        {"coefficient": np.full(SHAPE, -1.0)},
        "zero or positive, and finite [-]",
        "15 of 15 are negative, the smallest is -1.0",
    ),
    "transposed": (
        {"coefficient": HOLED.T},
        "coefficient of shape (y, x) = (3, 5)",
        "coefficient has the shape (5, 3)",
    ),
    "descending": ({"x": X[0, ::-1]}, "y, x of two numbers or more each, finite and ascending", "x is not"),
    "NaN of x": (
        {"y": np.array([0.0, 1.0, np.nan])},
        "y, x of two numbers or more each, finite and ascending",
        "y is not",
    ),
    "text": ({"x": np.array(["a"])}, "an array of real numbers", "x is <U1"),
    "complex": ({"coefficient": np.full(SHAPE, 0.1 + 0.2j)}, "an array of real numbers", "coefficient is complex128"),
}


@pytest.mark.parametrize("case", FILES)
def test_refused_maps(case, mapped):
    arrays, rule, reason = FILES[case]
    file = mapped[0](**arrays)
    with pytest.raises(SceneError) as caught:
        law("coulomb-map", file=file)
    before, _, after = str(caught.value).partition(f"(got {file!r}); ")
    assert before.startswith("coulomb-map.file must be ")
    assert rule in before
    assert reason in after


# text of the file, words of the refusal
TEXTS = {
    "a hole": ("0 0 1\n1 0 1\n0 1 1\n", "a lattice with one row for every combination of its x, y"),
    "twice": ("0 0 1\n1 0 1\n0 1 1\n0 1 1\n", "a lattice with one row for every combination of its x, y"),
    "empty": ("# x y mu\n", "a text file with rows x y coefficient"),
    "two columns": ("0 0\n1 0\n", "that can be read"),
    "words": ("0 0 high\n1 0 low\n", "that can be read"),
}


@pytest.mark.parametrize("case", TEXTS)
def test_refused_texts(case, tmp_path):
    text, words = TEXTS[case]
    (tmp_path / "map.txt").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match=rf"coulomb-map\.file must be .*{words}"):
        law("coulomb-map", file=str(tmp_path / "map.txt"))


def test_an_archive_names_what_it_lacks(tmp_path):
    np.savez(tmp_path / "map.npz", x=X[0], mu=np.ones(SHAPE))
    with pytest.raises(SceneError, match=r"must be a file with y and coefficient \(got .*; it holds x, mu"):
        law("coulomb-map", file=str(tmp_path / "map.npz"))


@dataclass(frozen=True, kw_only=True)
class Stranger(FrictionLaw):
    """Answers with what it is told to."""

    key: ClassVar[str] = "stranger"

    answer: object

    def shear_bound(self, state):
        return self.answer(state) if callable(self.answer) else self.answer


WRONG = wrong_answers(SHAPE, "Pa", "points", "pressure")


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_answer_names_the_law(case):
    answer, words = WRONG[case]
    with pytest.raises(PluginError, match=rf"^shear_bound of friction law 'stranger' {words}"):
        checked_shear_bound(Stranger(answer=answer), state())


def test_out_of_contact_there_is_no_bound_whatever_the_law_says():
    pressure = np.zeros(SHAPE)
    pressure[1, 1:3] = 7.0
    bound = checked_shear_bound(Stranger(answer=lambda s: np.where(s.pressure > 0, 3.0 + s.pressure, np.nan)),
                                state(pressure))  # fmt: skip
    np.testing.assert_array_equal(bound, np.where(pressure > 0, 10.0, 0.0))


def test_a_law_may_follow_slip_and_time():
    def fading(now):
        return now.pressure * np.exp(-now.slip_distance / UM) * now.time

    bound = checked_shear_bound(Stranger(answer=fading), state(slip_distance=UM * np.log(2), time=3.0))
    np.testing.assert_allclose(bound, 150.0, rtol=1e-14)
