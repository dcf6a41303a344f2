"""What results say of themselves to tools that know the conventions CF, and names that xarray keeps for itself."""

import pytest
import xarray as xr

import eigencontact as ec
from eigencontact.core.quantities import QUANTITIES
from eigencontact.reference.numbers import known_numbers

SCENE = {
    "name": "pulled",
    "body1": {"young-modulus": 210e9, "poisson-ratio": 0.3},
    "geometry": {"type": "sphere", "radius": 1e-3},
    "friction": {"type": "coulomb", "coefficient": 0.3},
    "grid": {"cells": 12, "size": 80e-6},
    "steps": [{"normal-load": 1.0}, {"shift-x": 1e-8}],
    "stress": [
        {"name": "deep", "shape": "plane", "depths": [0.0, 1e-5]},
        {"name": "spots", "shape": "points", "points": [[0.0, 0.0, 1e-5]]},
    ],
    "output": {"pictures": False},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    target = tmp_path_factory.mktemp("pulled")
    ec.run(SCENE, target).dataset.close()
    return target


def test_no_variable_is_hidden_by_a_method_of_xarray():
    assert [name for name in (*known_numbers(), *QUANTITIES) if hasattr(xr.Dataset, name)] == []


def test_axes_by_the_conventions(folder):
    with xr.open_dataset(folder / "results.nc", engine="h5netcdf") as data:  # as a stranger opens it
        assert data.attrs["Conventions"].startswith("CF-1.")
        found = {name: dict(data[name].attrs) for name in ("x", "y", "deep_x", "deep_z", "spots_y", "spots_z")}
        assert float(data.shift_magnitude[-1]) == float(data.shift_x[-1])
        assert "deep_y" in data.deep_stress.coords
        units = {str(one.attrs["units"]) for one in data.variables.values()}
    assert {name: attrs["axis"] for name, attrs in found.items()} == {
        "x": "X", "y": "Y", "deep_x": "X", "deep_z": "Z", "spots_y": "Y", "spots_z": "Z",
    }  # fmt: skip
    assert all(attrs["units"] == "m" and attrs["long_name"] for attrs in found.values())
    down = {name for name, attrs in found.items() if attrs.get("positive") == "down"}
    assert down == {"deep_z", "spots_z"}
    assert found["deep_z"]["standard_name"] == "depth"
    assert "unknown" not in units
