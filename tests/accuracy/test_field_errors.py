"""Errors of fields: against closed forms, a finer run and planted faults; in results, pictures and files."""

from math import pi

import numpy as np
import pytest
import xarray as xr

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.accuracy import bars, differences, fields
from eigencontact.accuracy.fields import FieldErrors
from eigencontact.accuracy.sources import SOURCES
from eigencontact.viz.figures import draw_all
from eigencontact.viz.surface import pressure_map, pressure_profiles
from eigencontact.viz.sweep import draw_sweep

MODULUS = STEEL["young-modulus"] / (1 - STEEL["poisson-ratio"] ** 2)
RADIUS = (3 * 0.65 * 105e-6 / (4 * MODULUS)) ** (1 / 3)
LARGEST = 1.5 * 0.65 / (pi * RADIUS**2)
#: Points of a line do not follow the cells, so that runs have them at the same places.
LINE = {"name": "below", "shape": "line", "start": [-6e-6, 0, 2e-6], "end": [6e-6, 0, 2e-6], "count": 49}
AXIS = {"name": "axis", "shape": "line", "start": [0, 0, 1e-6], "end": [0, 0, 1e-5], "count": 19, "fields": ["stress"]}
HERTZ = {
    "body1": STEEL,
    "geometry": {"type": "sphere", "radius": 105e-6},
    "steps": {"normal-load": 0.65},
    "grid": {"cells-per-contact-radius": 20},
    "stress": [LINE, AXIS],
    "output": {"pictures": False},
}
COARSE = HERTZ | {"grid": {"cells-per-contact-radius": 6}, "stress": LINE}
CELLS, STEPS, AT_INCLUSIONS = (
    next(source for source in SOURCES if source.name == name) for name in ("cells", "load steps", "cells at inclusions")
)


@pytest.fixture(scope="module")
def hertz():
    return ec.run(HERTZ, errors=True)


def held(errors, true):
    """Part of the points whose error holds the true one, and the median of their ratio."""
    return np.mean(errors >= true), np.median(errors / true)


def test_the_errors_of_the_pressure_hold_the_closed_form(hertz):
    data = hertz.dataset
    distance = np.hypot(*np.meshgrid(data["x"].values, data["y"].values))
    inside = distance < RADIUS
    exact = LARGEST * np.sqrt(1 - (distance[inside] / RADIUS) ** 2)
    errors = data["pressure_error"].values[0][inside]
    share, ratio = held(errors, np.abs(data["pressure"].values[0][inside] - exact))
    assert share >= 0.95
    assert ratio <= 10
    assert data["pressure_error"].values[0][distance > 1.6 * RADIUS].max() < 1e-12 * LARGEST  # round-off


def test_the_errors_of_the_stress_on_the_axis_hold_the_closed_form(hertz):
    depth = hertz.dataset["axis_z"].values
    exact = -LARGEST / (1 + (depth / RADIUS) ** 2)
    errors, stress = (
        hertz.dataset[name].sel(component="zz").values[0] for name in ("axis_stress_error", "axis_stress")
    )
    share, ratio = held(errors, np.abs(stress - exact))
    assert share >= 0.95
    assert ratio <= 20


def test_the_errors_of_the_stress_along_a_line_hold_a_run_with_twice_the_cells(hertz):
    finer = ec.run(HERTZ | {"grid": {"cells-per-contact-radius": 40}}).dataset["below_stress"].values[0]
    stress, errors = (hertz.dataset[name].values[0] for name in ("below_stress", "below_stress_error"))
    matters = np.abs(stress) > 0.1 * np.abs(stress).max()
    share, ratio = held(errors[matters], np.abs(stress - finer)[matters])
    assert share >= 0.95
    assert ratio <= 20


def test_each_field_has_one_number(hertz):
    found = hertz.summary["field_errors"]
    assert set(found) == {"pressure", "gap", "displacement_z", "below_stress", "below_von_mises", "axis_stress"} | {
        name for name in found if name.startswith("axis_")
    }
    pressure = found["pressure"]
    assert pressure["source"] == "cells"
    assert pressure["largest"] == close(hertz.summary["max_pressure"])
    assert pressure["relative"] == close(pressure["error"] / pressure["largest"])
    assert 0 < pressure["relative"] < 0.05 < pressure["worst"] / pressure["largest"]


class Field:
    """Variable of a run that is not solved."""

    def __init__(self, dims, values, **attrs):
        self.dims, self.values, self.attrs = dims, np.asarray(values), attrs
        self.shape = self.values.shape

    def __getitem__(self, at):
        return Field(self.dims[1:], self.values[at])


class Run:
    """Field with errors of second order in the cells and of first order in the increments."""

    def __init__(self, size, count):
        x = np.arange(0.5 * size, 40, size)
        times = np.linspace(0.0, 1.0, count + 1)[1:]
        exact = 5 + np.sin(0.1 * x)
        field = [time * (exact + self.true(x, size, 0)) + 0.02 / count * time for time in times]
        attrs = {"role": "field", "units": "Pa", "long_name": "test"}
        self.variables = {
            "x": Field(("x",), x), "time": Field(("step",), times), "test": Field(("step", "x"), field, **attrs)
        }  # fmt: skip
        self.summary = {"numbers": {}, "history": []}

    @staticmethod
    def true(x, size, count):
        return 1e-3 * size**2 * (1.5 + np.cos(0.1 * x)) + (0.02 / count if count else 0.0)


def of(run):
    return bars.Run(None, run.summary, run)


def collected():
    """Field errors of a run with 8 increments: cells 2 and 3 times larger, then half the increments on these."""
    fine, coarse = Run(1.0, 8), [(2.0, Run(2.0, 8)), (3.0, Run(3.0, 8))]
    base, half = coarse[-1][1], Run(3.0, 4)
    found = FieldErrors(fine, fine.summary)
    found.vary(CELLS, of(fine)._replace(results=None), [(ratio, of(run)) for ratio, run in coarse])
    found.vary(STEPS, of(base), [(2.0, of(half))])
    return fine, found


def test_the_sources_of_a_field_are_estimated_alone_and_added():
    fine, found = collected()
    (variable,) = found.variables({})
    true = Run.true(fine.variables["x"].values, 1.0, 8)
    inner = slice(3, -3)  # no coarser cells have their middles beyond
    ratio = (variable.values[-1] / true)[inner]
    assert ratio.min() >= 0.99
    largest = int(fine.variables["test"].values[-1][inner].argmax())  # there it has the error of this number
    assert np.delete(ratio, slice(largest - 1, largest + 2)).max() <= 1.2
    assert ratio.max() <= 1.5
    assert found.fields["test"].source == "cells"
    assert found.fields["test"].order == close(2.0, 0.02)
    # the third increment is no end of one of half as many: the larger share of its neighbours counts
    share = (variable.values[2] - 0.75 * variable.values[3])[inner]
    assert share == close(0.25 * 0.5 * 0.02 / 8, 1e-3)


class Divided(Run):
    """Field with errors of first order in the edges of cells, elsewhere and where cells are divided."""

    def __init__(self, size, ratio=1):
        self.ratio = ratio
        super().__init__(size, 8)

    def true(self, _, size, __):
        return 1e-3 * size + 3e-3 * size / self.ratio


def test_an_error_that_two_sources_have_counts_once_in_a_field():
    fine, coarsest = Divided(1.0), Divided(3.0)
    found = FieldErrors(fine, fine.summary)
    found.vary(CELLS, of(fine), [(2.0, of(Divided(2.0))), (3.0, of(coarsest))])
    found.vary(AT_INCLUSIONS, of(coarsest), [(0.5, of(Divided(3.0, 2)))], 3.0)
    (variable,) = found.variables({})
    inner = variable.values[-1][3:-3]
    assert inner.min() >= 1.2 * 4e-3
    assert inner.max() <= 1.3 * 4e-3
    parts = found.fields["test"].parts
    assert parts[AT_INCLUSIONS.name] / sum(parts.values()) == close(3.0 / 5.0, 0.02)


@pytest.mark.parametrize("fault", ["counted twice", "of coarse cells"])
def test_an_error_that_counts_twice_or_is_of_coarse_cells_is_seen(monkeypatch, fault):
    if fault == "counted twice":
        monkeypatch.setattr(fields, "without_overlap", dict)
    else:
        honest = FieldErrors.vary
        monkeypatch.setattr(FieldErrors, "vary", lambda own, *given: honest(own, *given[:3]))
    with pytest.raises(AssertionError):
        test_an_error_that_two_sources_have_counts_once_in_a_field()


class Cusp(Run):
    """Means over cells of a field with a sharp peak at 20, between cells of all sizes."""

    def __init__(self, size, count):
        super().__init__(size, count)
        edges = np.arange(0.0, 40.0 + 0.5 * size, size)
        field = np.diff(np.sign(edges - 20.0) * (1.0 - np.exp(-0.5 * np.abs(edges - 20.0)))) / size
        self.variables["test"] = Field(("step", "x"), [field] * count, role="field", units="Pa", long_name="test")


def peak_held():
    """Whether the error at the peak holds the rise by finer cells."""
    fine, coarse = Cusp(1.0, 1), [(2.0, Cusp(2.0, 1)), (2.5, Cusp(2.5, 1))]
    found = FieldErrors(fine, fine.summary)
    found.vary(CELLS, of(fine), [(ratio, of(run)) for ratio, run in coarse])
    (variable,) = found.variables({})
    rise = Cusp(0.5, 1).variables["test"].values[0].max() - fine.variables["test"].values[0].max()
    return bool(variable.values[0][19:21].min() >= rise)


def test_the_error_at_a_sharp_peak_holds_finer_cells(monkeypatch):
    """By the steps to the neighbours: the coarser runs do not see how sharp the peak is."""
    assert peak_held()
    monkeypatch.setattr(fields, "_bounded", lambda _, errors, *__: errors)
    assert not peak_held()


def tangent(cells):
    """A stiff sphere of half a contact radius that touches the surface; cells per contact radius."""
    edge = RADIUS / cells
    ball = {"type": "sphere", "center": [0, 0, 0.5 * RADIUS], "radius": 0.5 * RADIUS}
    return HERTZ | {
        "stress": [],
        "grid": {"cells": 2 * round(1.35 * cells), "spacing": [edge, edge]},
        "inclusions": [ball | {"material": {"young-modulus": 2 * STEEL["young-modulus"], "poisson-ratio": 0.3}}],
        "numerics": {"tolerance": 1e-4, "inclusion-pitch": edge, "allow-coarse": True},
    }


@pytest.mark.slow
def test_the_error_at_the_largest_value_is_that_of_this_number(monkeypatch):
    """At a peak that is smooth on these cells, and rises with finer ones."""
    rise = ec.run(tangent(20)).summary["max_pressure"]

    def missed():
        run = ec.run(tangent(10), errors=True)
        pressure, error = (run.dataset[name].values[-1] for name in ("pressure", "pressure_error"))
        peak = pressure > (1.0 - 1e-6) * pressure.max()
        assert peak.sum() == 4
        return rise - pressure.max() > error[peak].min()

    assert not missed()
    bounded = fields._bounded
    monkeypatch.setattr(fields, "_bounded", lambda at, errors, ends, *rest: bounded(at, errors, 0.0 * ends, *rest))
    assert missed()


def test_half_an_error_is_seen(monkeypatch):
    original = differences.shares_of

    def fault(*given):
        factors, order = original(*given)
        return [0.5 * factor for factor in factors], order

    monkeypatch.setattr(differences, "shares_of", fault)
    with pytest.raises(AssertionError):
        test_the_sources_of_a_field_are_estimated_alone_and_added()


def test_without_the_difference_to_neighbours_the_edge_is_not_held(monkeypatch, hertz):
    """The bound at edges is what holds the pressure there, not the differences to coarser runs."""
    monkeypatch.setattr(fields, "_OF_NEIGHBOUR", 0.0)
    without = ec.run(HERTZ, errors=True).dataset["pressure_error"]
    assert float(without.max()) < 0.3 * float(hertz.dataset["pressure_error"].max())


def test_results_hold_the_errors_with_units(tmp_path):
    result = ec.run(COARSE | {"output": {"pictures": False, "vtk": True}}, tmp_path / "run", errors=True)
    with xr.open_dataset(tmp_path / "run/results.nc", engine="h5netcdf") as data:
        for name, dims in (("pressure", ("step", "y", "x")), ("below_stress", ("step", "component", "below_point"))):
            errors = data[f"{name}_error"]
            assert errors.dims == data[name].dims == dims
            assert errors.attrs["units"] == "Pa"
            assert errors.attrs["estimates"] == name
            assert errors.dtype == np.float32
        assert float(data["max_pressure_error"][-1]) == close(result.summary["errors"]["max_pressure"]["error"])
        assert not any(name.startswith("reference") and name.endswith("_error") for name in data)
    assert b"pressure_error" in (tmp_path / "run/surface_0001.vti").read_bytes()
    assert b"stress_error" in (tmp_path / "run/below_0001.vtp").read_bytes()
    again = ec.run(COARSE | {"output": {"pictures": False, "vtk": True}}, tmp_path / "run", errors=True, resume=True)
    assert again.summary["field_errors"] == result.summary["field_errors"]


def test_without_the_option_nothing_is_stored():
    result = ec.run(COARSE)
    assert not any(str(name).endswith("_error") for name in result.dataset)
    assert "field_errors" not in result.summary


def test_numbers_have_errors_in_every_step():
    pressed = ec.run(COARSE | {"steps": {"normal-load": 0.65, "increments": 3}}, errors=True)
    errors = pressed.dataset["approach_error"]
    assert errors.dims == ("step",)
    assert errors.attrs["estimates"] == "approach"
    assert (errors > 0).all()
    assert float(errors[-1]) == close(pressed.summary["errors"]["approach"]["error"])


def test_a_number_that_does_not_converge_has_no_errors_in_the_steps():
    fine, coarse = Run(1.0, 2), Run(2.0, 2)
    for run, value in ((fine, 1.0), (coarse, 2.0)):
        depth = {"name": "depth", "unit": "m", "meaning": "depth", "role": "result"}
        run.summary |= {"numbers": {"depth": depth}, "history": [{"time": 0.5, "depth": value}, {"time": 1.0}]}
        run.summary["warnings"] = [{"number": "depth", "order": 0.0}]
    found = FieldErrors(fine, fine.summary)
    found.vary(CELLS, of(fine), [(2.0, of(coarse))])
    assert [variable.name for variable in found.variables({})] == ["test_error"]


def test_cells_that_cannot_be_coarser_leave_no_errors():
    found = FieldErrors(Run(3.0, 8), {})
    assert list(found.variables({})) == []


@pytest.mark.slow
def test_pictures_show_errors_and_are_the_same_without_them(tmp_path):
    data = ec.run(COARSE, errors=True).dataset
    plain = data.drop_vars([name for name in data if str(name).endswith("_error")])
    folders = [tmp_path / name for name in ("stripped", "never", "with")]
    for folder, dataset in zip(folders, (plain, ec.run(COARSE).dataset, data), strict=True):
        folder.mkdir()
        draw_all(dataset, folder)
    for picture in folders[0].iterdir():
        assert picture.read_bytes() == (folders[1] / picture.name).read_bytes()
        assert picture.read_bytes() != (folders[2] / picture.name).read_bytes()
    assert "estimated error ± " in pressure_map(data).axes[0].get_title().replace("\n", " ")
    assert "estimated error" in pressure_profiles(data).axes[0].get_legend_handles_labels()[1]


@pytest.mark.slow
def test_the_curves_of_a_sweep_have_error_bars(tmp_path):
    asked = COARSE | {"output": {"errors": True, "pictures": False}}
    swept = ec.sweep(asked, {"steps.normal-load": [0.3, 0.6]}, tmp_path / "sweep").dataset
    (bars,) = draw_sweep(swept, "max_pressure").axes[0].containers
    assert bars.has_yerr
    assert draw_sweep(swept.drop_vars("max_pressure_error"), "max_pressure").axes[0].containers == []


@pytest.mark.slow
def test_the_report_lists_the_errors_of_fields(tmp_path):
    ec.run(COARSE | {"steps": {"normal-load": 0.65, "increments": 3}}, tmp_path / "run", errors=True)
    page = ec.report(tmp_path / "run").read_text(encoding="utf-8")
    assert 'id="field-errors"' in page
    assert 'class="band"' in page
