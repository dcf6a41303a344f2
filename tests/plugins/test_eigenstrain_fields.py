"""Eigenstrain fields: values at points, histories, files, refusals."""

import numpy as np
import pytest

from eigencontact import EigencontactError, make
from eigencontact.core.tensors import from_mandel

ZERO = np.zeros(3)
DEPTHS = np.array([0.0, 1.0, 3.0])


def plain(field, x=ZERO, y=ZERO, z=DEPTHS, time=1.0):
    return from_mandel(field.eigenstrain(x, y, z, time))


# key, fields, plain components (6, 3) at the depths 0, 1, 3
VALUES = {
    "isotropic": ("uniform", {"value": 2.0}, np.outer([2, 2, 2, 0, 0, 0], [1, 1, 1])),
    "three": ("uniform", {"value": [1.0, 2.0, 3.0]}, np.outer([1, 2, 3, 0, 0, 0], [1, 1, 1])),
    "matrix": (
        "uniform",
        {"value": [[1.0, 6, 5], [6, 2, 4], [5, 4, 3]]},
        np.outer([1, 2, 3, 4, 5, 6], [1, 1, 1]),
    ),
    "profile": (
        "depth-profile",
        {"depths": [0.0, 2.0], "values": [4.0, 2.0], "direction": "in-plane"},
        np.outer([1, 1, 0, 0, 0, 0], [4, 3, 0]),
    ),
    "profile of one depth, weighted": (
        "depth-profile",
        {"depths": [1.0], "values": [4.0], "direction": [0.5, 0, -1]},
        np.outer([0.5, 0, -1, 0, 0, 0], [4, 4, 0]),
    ),
    "heat": (
        "thermal",
        {"expansion": 0.5, "temperature": 4.0, "decay_depth": 2.0},
        np.outer([1, 1, 1, 0, 0, 0], 2 * np.exp([0, -0.5, -1.5])),
    ),
    "heat everywhere": ("thermal", {"expansion": 0.5, "temperature": -4.0}, np.outer([1, 1, 1, 0, 0, 0], [-2, -2, -2])),
    "peened": (
        "peened-layer",
        {"peak": 3.0, "peak_depth": 1.0, "width": 2.0},
        np.outer([1, 1, -2, 0, 0, 0], 3 * np.exp([-0.5, 0.0, -2.0])),
    ),
    "peened, cosine": (
        "peened-layer",
        {"peak": 3.0, "peak_depth": 0.0, "width": 2.0, "profile": "cosine", "incompressible": False},
        np.outer([1, 1, 0, 0, 0, 0], [3, 3 * np.sqrt(0.5), 0]),
    ),
}


@pytest.mark.parametrize("case", VALUES)
def test_values(case):
    key, fields, expected = VALUES[case]
    field = make(key, kind="eigenstrain-field", **fields)
    np.testing.assert_allclose(plain(field), expected, rtol=1e-14, atol=1e-15)
    assert not field.varies
    assert field.uniform == (key == "uniform" or case == "heat everywhere")
    assert field.references


@pytest.mark.parametrize("case", VALUES)
def test_points_broadcast_and_stay_untouched(case):
    key, fields, _ = VALUES[case]
    field = make(key, kind="eigenstrain-field", **fields)
    x, y, z = np.zeros((1, 1, 4)), np.zeros((1, 3, 1)), np.arange(2.0)[:, None, None]
    kept = [axis.copy() for axis in (x, y, z)]
    values = field.eigenstrain(x, y, z, 1.0)
    assert values.shape == (6, 2, 3, 4)
    values += 1.0  # fresh memory, ours to change
    for axis, before in zip((x, y, z), kept, strict=True):
        np.testing.assert_array_equal(axis, before)


@pytest.mark.parametrize("case", VALUES)
def test_history_scales_linearly_and_holds_beyond_its_ends(case):
    key, fields, expected = VALUES[case]
    field = make(key, kind="eigenstrain-field", **fields, times=[1.0, 3.0], factors=[0.5, 1.5])
    assert field.varies
    for time, factor in ((0.0, 0.5), (1.0, 0.5), (1.5, 0.75), (3.0, 1.5), (9.0, 1.5)):
        np.testing.assert_allclose(plain(field, time=time), factor * expected, rtol=1e-13, atol=1e-15)
    assert not make(key, kind="eigenstrain-field", **fields, times=[1.0, 2.0], factors=[2.0, 2.0]).varies


@pytest.fixture(params=["npz", "nc"])
def stored(request, tmp_path):
    """Linear fields on an uneven lattice, stored; linear interpolation gives them back."""
    z, y, x = np.array([0.0, 1.0, 4.0]), np.array([-1.0, 2.0]), np.array([-2.0, 0.0, 1.0])

    def value(x, y, z):
        return np.stack([(n + 1) * x + y - n * z + n for n in range(6)])

    components = value(*(part for part in np.meshgrid(z, y, x, indexing="ij")[::-1]))
    path = tmp_path / f"field.{request.param}"
    if request.param == "npz":
        np.savez(path, x=x, y=y, z=z, eigenstrain=components)
    else:
        import xarray

        dims = ("component", "z", "y", "x")
        xarray.Dataset({"eigenstrain": (dims, components)}, coords={"x": x, "y": y, "z": z}).to_netcdf(
            path, engine="h5netcdf"
        )
    return path, value


def test_a_stored_field_is_interpolated_and_zero_outside(stored):
    path, value = stored
    field = make("from-file", file=str(path))
    random = np.random.default_rng(3)
    x, y, z = random.uniform(-2, 1, 20), random.uniform(-1, 2, 20), random.uniform(0, 4, 20)
    np.testing.assert_allclose(plain(field, x, y, z), value(x, y, z), rtol=1e-12, atol=1e-12)
    assert not plain(field, np.array([1.1]), ZERO[:1], ZERO[:1]).any()
    assert not field.uniform


def test_one_stored_value_is_isotropic(tmp_path):
    axis = np.array([0.0, 1.0])
    np.savez(tmp_path / "a.npz", x=axis, y=axis, z=axis, swelling=np.full((2, 2, 2), 3.0))
    field = make("from-file", file=str(tmp_path / "a.npz"), variable="swelling")
    np.testing.assert_allclose(plain(field, *[np.array([0.5])] * 3)[:, 0], [3, 3, 3, 0, 0, 0])


REFUSED = {
    "no such file": ("from-file", {"file": "nowhere.npz"}, "from-file.file must be an existing file"),
    "depths not ascending": (
        "depth-profile",
        {"depths": [1.0, 0.0], "values": [1.0, 2.0]},
        "depth-profile.depths must be at least one, finite and ascending [m]",
    ),
    "a value too few": (
        "depth-profile",
        {"depths": [0.0, 1.0], "values": [1.0]},
        "depth-profile.values must be 2 finite numbers, one for each of depths [-]",
    ),
    "direction": (
        "depth-profile",
        {"depths": [0.0], "values": [1.0], "direction": "up"},
        "direction",
    ),
    "heat without end": ("thermal", {"expansion": 1.0, "temperature": float("inf")}, "thermal.temperature must be fin"),
    "Celsius": ("thermal", {"expansion": 1.0, "temperature": "20 degC"}, "a difference of temperatures [K]"),
    "decay": ("thermal", {"expansion": 1.0, "temperature": 1.0, "decay_depth": 0.0}, "thermal.decay_depth must be pos"),
    "no width": ("peened-layer", {"peak": 1.0, "peak_depth": 0.0, "width": 0.0}, "peened-layer.width must be positive"),
    "above the surface": (
        "peened-layer",
        {"peak": 1.0, "peak_depth": -1.0, "width": 1.0},
        "peened-layer.peak_depth mu",
    ),
    "times without factors": ("uniform", {"value": 1.0, "times": [1.0]}, "uniform.factors must be 1 finite numbers"),
    "times back and forth": (
        "uniform",
        {"value": 1.0, "times": [1.0, 1.0], "factors": [1.0, 2.0]},
        "uniform.times must be finite and ascending [load steps]",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refusals(case):
    key, fields, words = REFUSED[case]
    with pytest.raises(EigencontactError) as caught:
        make(key, kind="eigenstrain-field", **fields)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({}, "a file with z and y and x and eigenstrain"),
        ({"eigenstrain": np.zeros((6, 2, 2, 3))}, "with eigenstrain of shape (z, y, x) = (2, 2, 2) or (6, 2, 2, 2)"),
        ({"eigenstrain": np.full((2, 2, 2), np.nan)}, "with finite eigenstrain"),
        (
            {"eigenstrain": np.zeros((2, 2, 2)), "x": [1.0, 0.0]},
            "with z, y, x of two numbers or more each, finite and ascending [m]",
        ),
    ],
)
def test_files_that_are_refused(tmp_path, content, words):
    axes = {axis: np.array([0.0, 1.0]) for axis in "xyz"} if content else {}
    np.savez(tmp_path / "a.npz", **(axes | content))
    with pytest.raises(EigencontactError) as caught:
        make("from-file", file=str(tmp_path / "a.npz"))
    assert words in str(caught.value)


def test_a_file_that_is_none_is_refused(tmp_path):
    (tmp_path / "a.npz").write_bytes(b"not a zip file")
    with pytest.raises(EigencontactError, match=r"from-file\.file must be a readable \.npy, \.npz, NetCDF or text"):
        make("from-file", file=str(tmp_path / "a.npz"))
