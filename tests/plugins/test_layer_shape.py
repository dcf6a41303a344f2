"""Layer as an inclusion: maps of thickness, interpolation, refusals."""

import numpy as np
import pytest

import eigencontact
from close import close
from eigencontact.plugin import SceneError
from eigencontact_plugins.shapes.layer import Layer

MAP = np.array([[1.0, 2.0, 0.0], [3.0, 5.0, 1.0]])  # rows along y, columns along x


@pytest.fixture
def thickness_file(tmp_path):
    """Write a map in the format of a suffix."""

    def write(suffix, values=MAP, name="thickness"):
        path = tmp_path / f"map{suffix}"
        if suffix == ".npy":
            np.save(path, values)
        elif suffix == ".npz":
            np.savez(path, **{name: values})
        else:
            mark = {".csv": ",", ".txt": " ", ".dat": ";"}[suffix]
            path.write_text("# um\n" + "\n".join(mark.join(map(str, row)) for row in values) + "\n", encoding="utf-8")
        return str(path)

    return write


def test_a_uniform_layer_is_a_cuboid():
    layer = eigencontact.make("layer", size=["20 um", "10 um"], thickness="2 um", center=(1e-6, 0), top="1 um")
    cuboid = eigencontact.make("cuboid", center=(1e-6, 0, 2e-6), edges=(20e-6, 10e-6, 2e-6))
    np.testing.assert_allclose(layer.bounds, cuboid.bounds, rtol=1e-14)
    points = np.random.default_rng(1).uniform(-12e-6, 12e-6, (3, 4000))
    assert np.array_equal(layer.contains(*points), cuboid.contains(*points))
    assert 0 < layer.contains(*points).sum() < 4000


@pytest.mark.parametrize("suffix", [".npy", ".npz", ".txt", ".csv", ".dat"])
def test_a_map_is_bilinear_between_its_points(thickness_file, suffix):
    layer = Layer(size=(4.0, 1.0), file=thickness_file(suffix), thickness_unit=0.5, center=(10.0, -3.0))
    x, y = np.meshgrid([8.0, 10.0, 12.0], [-3.5, -2.5])
    assert np.array_equal(layer.thickness_at(x, y), 0.5 * MAP)
    assert layer.thickness_at(9.0, -3.0) == close(0.5 * (1 + 2 + 3 + 5) / 4)
    assert layer.thickness_at(11.5, -2.75) == close(0.5 * (0.25 * 0.5 + 0.75 * 2.0))
    assert layer.thickness_at(np.array([7.999, 12.001]), -3.0).tolist() == [0.0, 0.0]
    assert layer.bounds == ((8.0, -3.5, 0.0), (12.0, -2.5, 2.5))


def test_contains_fills_the_volume_of_the_map(thickness_file):
    layer = Layer(size=(4.0, 1.0), file=thickness_file(".npz", name="other"), top=0.5)
    n = 120
    x, y, z = (np.arange(n) + 0.5) / n * 4 - 2, (np.arange(n) + 0.5) / n - 0.5, (np.arange(n) + 0.5) / n * 5 + 0.5
    share = layer.contains(x[:, None, None], y[:, None], z).mean()
    trapezoids = 2.0 * 1.0 * (MAP[:, :-1] + MAP[:, 1:]).sum() / 4
    assert share * 20.0 == close(trapezoids, rel=2e-3)
    assert not layer.contains(np.array(0.0), np.array(0.0), np.array(0.49))
    assert layer.contains(np.array(0.0), np.array(0.0), np.array(0.5))


def test_no_layer_where_its_thickness_is_zero(thickness_file):
    layer = Layer(size=(4.0, 1.0), file=thickness_file(".npy"))
    assert not layer.contains(np.array(2.0), np.array(-0.5), np.array(0.0))


REFUSED = [
    ({}, r"layer must have a thickness \[m\] or a file with a map of it \(got neither\); give one"),
    ({"thickness": 1.0, "file": "map.npy"}, r"\(got both\)"),
    ({"thickness": 0.0}, r"layer.thickness must be positive and finite \[m\] \(got 0.0\)"),
    ({"thickness": 1.0, "size": (1.0, 0.0)}, r"layer.size must be two positive, finite lengths"),
    ({"thickness": 1.0, "center": (np.nan, 0.0)}, r"layer.center must be two finite"),
    ({"thickness": 1.0, "top": -1.0}, r"layer.top must be zero or positive"),
    ({"thickness": 1.0, "thickness_unit": 0.0}, r"layer.thickness_unit must be positive"),
    ({"file": "nowhere.npy"}, r"layer.file must be an existing file \(got 'nowhere.npy'\); a relative path"),
]


@pytest.mark.parametrize(("table", "message"), REFUSED)
def test_refusals(table, message):
    with pytest.raises(SceneError, match=message):
        Layer(**({"size": (4.0, 1.0)} | table))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (np.ones((1, 4)), r"a map of at least 2 x 2 numbers; it is \(1, 4\)"),
        (np.ones(4), "at least 2 x 2"),
        (np.array([[1.0, np.nan], [1, 1]]), "finite thicknesses >= 0, some of them > 0"),
        (np.array([[1.0, -1.0], [1, 1]]), "finite thicknesses"),
        (np.zeros((2, 2)), "finite thicknesses"),
        (np.array([["a", "b"], ["c", "d"]]), "an array of real numbers"),
        (np.full((2, 2), 1 + 1j), "an array of real numbers .* its type is complex128"),
    ],
)
def test_unusable_maps_are_refused(thickness_file, values, message):
    with pytest.raises(SceneError, match=message):
        Layer(size=(4.0, 1.0), file=thickness_file(".npy", values))


def test_files_of_other_kinds_are_refused(tmp_path):
    for name, content, message in (
        ("map.png", b"1", "of one of the types .npy, .npz, .txt"),
        ("map.npz", b"no archive", r"a readable .npy, .npz, .*; it holds no numbers of NumPy"),
        ("map.txt", b"1 2\n3\n", "readable map"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(SceneError, match=message):
            Layer(size=(4.0, 1.0), file=str(tmp_path / name))
