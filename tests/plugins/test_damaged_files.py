"""Files of components that are empty, cut off, damaged, text, or full of what is no real number: named, never used."""

import numpy as np
import pytest

import eigencontact as ec

AXIS = np.linspace(-5e-6, 5e-6, 5)
#: Contents of a good file, the array that holds its values, and what makes the component.
GOOD = {
    "from-file": ({"x": AXIS, "y": AXIS, "z": AXIS, "eigenstrain": np.full((5, 5, 5), 1e-3)}, "eigenstrain", {}),
    "layer": ({"thickness": np.full((5, 5), 1e-6)}, "thickness", {"size": (1e-6, 1e-6)}),
    "coulomb-map": ({"x": AXIS, "y": AXIS, "coefficient": np.full((5, 5), 0.1)}, "coefficient", {}),
    "topography": ({"heights": np.outer(AXIS, AXIS), "dx": 1e-6, "dy": 1e-6}, "heights", {}),
}


def cut(raw):
    return raw[: len(raw) // 2]


def flipped(raw):
    out = bytearray(raw)
    out[len(out) // 2] ^= 0xFF
    return bytes(out)


BYTES = {
    "empty": lambda _raw: b"",
    "cut": cut,
    "cut at the end": lambda raw: raw[:-30],
    "text": lambda _raw: b"hello\n",
    "flipped": flipped,
    "start of an archive": lambda _raw: b"PK\x03\x04" + bytes(100),
}
VALUES = {
    "complex": lambda values: values + 1j,
    "booleans": lambda values: values > 0,
    "texts": lambda values: values.astype(str),
    "objects": lambda values: values.astype(object),
    "infinite": lambda values: np.full_like(values, np.inf),
    "one dimension": lambda values: values.ravel(),
    "none": lambda values: values[:0],
}


@pytest.mark.parametrize("key", GOOD)
@pytest.mark.parametrize("damage", [*BYTES, *VALUES])
def test_a_file_that_is_none_is_refused_by_name(damage, key, tmp_path):
    content, name, parameters = GOOD[key]
    path = tmp_path / "data.npz"
    np.savez(path, **content)
    ec.make(key, file=str(path), **parameters)
    if damage in BYTES:
        path.write_bytes(BYTES[damage](path.read_bytes()))
    else:
        np.savez(path, **{**content, name: VALUES[damage](content[name])})
    with pytest.raises(ec.EigencontactError, match=rf"^{key}\.file must be ") as caught:
        ec.make(key, file=str(path), **parameters)
    assert "data.npz" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("key", ["from-file", "coulomb-map"])
@pytest.mark.parametrize("axis", [AXIS + 0j, AXIS[::-1], AXIS * np.nan, np.array([-np.inf, *AXIS[1:]]), AXIS > 0])
def test_axes_that_are_none_are_refused(axis, key, tmp_path):
    content, _, parameters = GOOD[key]
    np.savez(tmp_path / "data.npz", **{**content, "x": axis})
    with pytest.raises(ec.EigencontactError, match=rf"^{key}\.file must be "):
        ec.make(key, file=str(tmp_path / "data.npz"), **parameters)
