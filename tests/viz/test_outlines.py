"""Outlines of inclusions in pictures, the homogeneous body beside a pressure, colours beside values that stand out."""

import json

import numpy as np
import pytest
import xarray as xr

from close import close
from eigencontact.viz.outline import inclusion_segments, paths_of
from eigencontact.viz.section import stress_section
from eigencontact.viz.surface import cause, homogeneous_words, pressure_map, pressure_profiles


def ring(x, y, radius=1.0, count=12):
    angles = np.linspace(0.0, 2 * np.pi, count + 1)
    places = np.stack([x + radius * np.cos(angles), y + radius * np.sin(angles)], axis=1)
    return np.stack([places[:-1], places[1:]], axis=1)


@pytest.mark.parametrize("order", [1, 7])
def test_segments_become_lines_once(order):
    """Two rings, one of them twice (a ball above another), and an open line, in any order."""
    line = np.array([[[5.0, 0.0], [6.0, 0.0]], [[6.0, -0.0], [6.0, 1.0]]])
    segments = np.concatenate([ring(0, 0), ring(3, 0), ring(0, 0)[::-1, ::-1], line])
    mixed = segments[np.random.default_rng(order).permutation(len(segments))]
    paths = sorted(paths_of(mixed), key=len)
    assert [len(path) for path in paths] == [3, 13, 13]
    assert all(np.allclose(path[0], path[-1], rtol=0, atol=1e-12) for path in paths[1:])
    length = sum(np.linalg.norm(np.diff(path, axis=0), axis=1).sum() for path in paths)
    assert length == close(2 + 2 * 12 * 2 * np.sin(np.pi / 12), rel=1e-6)


def test_no_segments():
    assert paths_of(np.empty((0, 2, 2))) == []


def dataset(**more):
    x = (np.arange(9) - 4) * 1e-6
    bump = np.maximum(0.0, 1.0 - (x[:, None] ** 2 + x**2) / 9e-12)[None] * 1e9
    data = xr.Dataset(
        {"pressure": (("step", "y", "x"), bump), **more},
        coords={"x": x, "y": x, "step": [1]},
        attrs={
            "scene": "",
            "cell_size": [1e-6, 1e-6],
            "regions": '{"cut": {"shape": "plane", "body": 1, "dims": ["z", "x"]}}',
        },
    )
    return data, bump


def test_pressure_beside_the_homogeneous_body_and_over_outlines():
    data, bump = dataset()
    outline = (("outline_segment", "outline_end", "outline_axis"), ring(0, 0, 1e-6))
    data = data.assign(
        homogeneous_pressure=(("step", "y", "x"), 0.9 * bump),
        residual_displacement_z=data.pressure * 0,
        outline=outline,
    )
    assert homogeneous_words(data) == "homogeneous body"
    assert homogeneous_words(data.drop_vars("residual_displacement_z")) == "bare substrate"
    assert homogeneous_words(dataset()[0]) == ""
    legend = pressure_profiles(data).legends[0]
    assert [text.get_text() for text in legend.get_texts()] == ["computed cells", "homogeneous body (closed form)"]
    dashed, plain = pressure_map(data).axes[0].collections, pressure_map(dataset()[0]).axes[0].collections
    assert len(dashed) == len(plain) + 2


@pytest.mark.parametrize("line", [0, 1])
def test_borders_of_a_plane_are_those_within_half_a_cell(line):
    """Strips are 1 m long by convention, which is no distance between planes."""
    names = ("section_segment", "section_end", "section_axis")
    data, _ = dataset(
        section_segments=(names, ring(0, 0, 1e-6)),
        section_table=(("section", "section_column"), np.array([[0, 0, 2e-6, 0.0, 0.0, 0, 12]])),
    )
    table = json.dumps([{"body": 1, "bounds": [[0, 0, 0], [0, 0, 1e-6]]}])
    data = data.assign_attrs(line=line, cell_size=[1e-6, 1.0 if line else 1e-6], inclusions=table)
    assert len(inclusion_segments(data, 1, "x", 2.4e-6)) == 12
    assert not len(inclusion_segments(data, 1, "x", 2.6e-6))


def test_what_lifts_the_surface():
    data, _ = dataset()
    assert cause(data) == "eigenstrain"
    assert cause(data.assign(inclusion_residual=("step", [1e-7]))) == "the inclusions"
    assert cause(data.assign(inclusion_residual=("step", [1e-7]), plastic_strain_1=0.0)) == "plastic strain"


@pytest.mark.parametrize("spike", [1.0, 50.0])
def test_a_value_that_stands_out_leaves_the_colours(spike):
    x, z = np.linspace(-1e-6, 1e-6, 41), np.linspace(0, 1e-6, 41)
    field = np.tile(np.linspace(0.0, 1e9, 41), (41, 1))
    field[20, 20] = spike * 1e9
    data = dataset()[0].assign_coords(cut_x=x, cut_z=z, cut_y=0.0)
    data = data.assign(cut_von_mises=(("step", "cut_z", "cut_x"), field[None]))
    filled = stress_section(data, "cut").axes[0].collections[0]
    assert 1.0 <= filled.get_clim()[1] <= 1.5  # GPa
