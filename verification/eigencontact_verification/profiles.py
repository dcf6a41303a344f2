"""Surface displacement above a buried cube for every component of its eigenstrain, and for a sphere of equal volume.

``python -m eigencontact_verification.profiles -o DIR`` writes three pictures:

``surface-profiles-trace-free.png``
    The five trace-free strains of a plastic cube (11-22, 11-33, 12, 13, 23).
``surface-profiles-components.png``
    The six single components, trace and all, with the sphere of the same volume.
``cube-against-sphere.png``
    Largest difference of cube and sphere along the profiles, against depth.

A cube of edge L has its centre at depth 5 L in a half-space of nu = 0.3. Profiles run from the point above it along x,
along y and along the diagonal x = y. Lines are `eigencontact.inclusion_field`, marks a quadrature of Mindlin's point
force over the faces of the cube that shares no code with it. The sphere has the radius (3/(4 pi))^(1/3) L = 0.620 L,
0.124 of that depth. Displacements are divided by L times the eigenstrain, so that no unit is left; u_z is positive into
the body.

The configurations are those of the figures with which D. Nelias's group compared such closed forms with finite elements
(C. Jacq et al. 2002, doi:10.1115/1.1467920; B. Fulleringer and D. Nelias 2010, doi:10.1115/1.3197178).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import eigencontact
from eigencontact.viz.style import COLOURS, new_figure, paper_style, save
from eigencontact_verification.crosscheck.inclusions import EIGENSTRAINS, tensor_of
from eigencontact_verification.oracles import cuboid_quadrature, mindlin

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["COMPONENTS", "TRACE_FREE", "Profiles", "differences", "main", "profiles", "write_pictures"]

FloatArray = NDArray[np.float64]

POISSON_RATIO = 0.3
DEPTH = 5.0
REACH = 15.0
RADIUS = (3 / (4 * np.pi)) ** (1 / 3)
PATHS: dict[str, tuple[float, float]] = {"along x": (1.0, 0.0), "along y": (0.0, 1.0), "x = y": (0.5**0.5, 0.5**0.5)}
#: Names of eigenstrains in `EIGENSTRAINS`.
TRACE_FREE = ("xx-yy", "xx-zz", "xy", "xz", "yz")
COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
#: Rows of the figures: label and the index of the displacement.
ROWS = (("$u_z$", 2), ("$u_x$", 0), ("$u_y$", 1))
_PER_MILLE = 1e3
_MARK: dict[str, Any] = {"marker": "o", "markerfacecolor": "white", "markersize": 4.0, "linestyle": "none"}
_SPHERE: dict[str, Any] = {"color": "black", "linewidth": 0.8, "linestyle": (0, (1, 2))}


@dataclass(frozen=True)
class Profiles:
    """Displacements over L times eigenstrain along the three paths.

    Attributes
    ----------
    distance, sampled : (n,), (m,)
        Distance from the point above the centre, over L; `sampled` for the quadrature.
    cube, sphere : (names, 3 paths, n, 3)
        Closed forms.
    quadrature : (names, 3 paths, m, 3)
        Mindlin's point force over the faces of the cube.
    deviation : float
        Largest difference of cube and quadrature over the largest displacement of the same eigenstrain.
    """

    distance: FloatArray
    sampled: FloatArray
    cube: FloatArray
    sphere: FloatArray
    quadrature: FloatArray
    deviation: float


def _points(distance: FloatArray) -> FloatArray:
    return np.concatenate([np.outer(distance, (*direction, 0.0)) for direction in PATHS.values()])


def _displacements(shape: Any, names: Sequence[str], distance: FloatArray) -> FloatArray:
    points = _points(distance)
    fields = [
        eigencontact.inclusion_field(shape, tensor_of(name), points, young_modulus=1.0, poisson_ratio=POISSON_RATIO)
        for name in names
    ]
    return np.array(fields).reshape(len(names), len(PATHS), distance.size, 3)


def _bodies(depth: float) -> tuple[Any, Any]:
    center = (0.0, 0.0, depth)
    cube = eigencontact.make("cuboid", center=center, edges=(1.0, 1.0, 1.0))
    return cube, eigencontact.make("sphere", kind="inclusion-shape", center=center, radius=RADIUS)


def profiles(names: Sequence[str], *, lines: int = 151, marks: int = 11) -> Profiles:
    """Displacement of the surface for each eigenstrain, by closed form and by quadrature.

    Parameters
    ----------
    names : sequence of str
        Eigenstrains of `EIGENSTRAINS`.
    lines, marks : int
        Points on each path of the closed form and of the quadrature.
    """
    distance, sampled = np.linspace(0.0, REACH, lines), np.linspace(0.0, REACH, marks)
    cube, sphere = _bodies(DEPTH)
    moments = cuboid_quadrature.moments(_points(sampled), (0.0, 0.0, DEPTH), (1.0, 1.0, 1.0))
    expected = np.array([mindlin.displacement(moments, tensor_of(name), POISSON_RATIO) for name in names])
    quadrature = expected.reshape(len(names), len(PATHS), marks, 3)
    difference = np.abs(_displacements(cube, names, sampled) - quadrature).max(axis=(1, 2, 3))
    return Profiles(
        distance=distance,
        sampled=sampled,
        cube=_displacements(cube, names, distance),
        sphere=_displacements(sphere, names, distance),
        quadrature=quadrature,
        deviation=float((difference / np.abs(quadrature).max(axis=(1, 2, 3))).max()),
    )


def differences(names: Sequence[str], depths: FloatArray, *, lines: int = 61) -> FloatArray:
    """Largest length of sphere minus cube over the largest displacement, ``(names, depths)``; profiles of 3 depths."""
    out = np.empty((len(names), depths.size))
    for column, depth in enumerate(depths):
        distance = np.linspace(0.0, 3 * depth, lines)
        cube, sphere = (_displacements(body, names, distance) for body in _bodies(float(depth)))
        difference = np.linalg.norm(sphere - cube, axis=-1).max(axis=(1, 2))
        out[:, column] = difference / np.linalg.norm(cube, axis=-1).max(axis=(1, 2))
    return out


def _label(name: str) -> str:
    """Eigenstrain as a formula: the first component of two, which have opposite signs."""
    return " = -".join(rf"\epsilon_{{{component}}}" for component in EIGENSTRAINS[name]).join("$$")


def _panel(axes: Axes, data: Profiles, row: int, component: int, *, sphere: bool) -> None:
    axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0)
    for path, colour in enumerate(COLOURS[: len(PATHS)]):
        at = (row, path, slice(None), component)
        axes.plot(data.distance, _PER_MILLE * data.cube[at], color=colour, zorder=2)
        # marks of the three paths are shifted against each other, so that equal curves still show all of them
        shown = slice(path % 3, None, 3) if data.sampled.size > 6 else slice(None)
        marks = _PER_MILLE * data.quadrature[at][shown]
        axes.plot(data.sampled[shown], marks, color=colour, markeredgewidth=0.9, zorder=3, **_MARK)
        if sphere:
            axes.plot(data.distance, _PER_MILLE * data.sphere[at], zorder=4, **_SPHERE)
    axes.set_xlim(0.0, REACH)
    axes.set_xticks(np.arange(0.0, REACH, 5.0))


def _difference(axes: Axes, data: Profiles, row: int) -> None:
    """Length of sphere minus cube over the largest displacement of the eigenstrain."""
    size = np.linalg.norm(data.cube[row], axis=-1).max()
    for path, colour in enumerate(COLOURS[: len(PATHS)]):
        length = np.linalg.norm(data.sphere[row, path] - data.cube[row, path], axis=-1)
        axes.plot(data.distance, 100 * length / size, color=colour)
    axes.set_ylim(bottom=0.0)


def _profile_figure(names: Sequence[str], data: Profiles, *, sphere: bool) -> Figure:
    from matplotlib.lines import Line2D

    rows = len(ROWS) + sphere
    figure = new_figure(1.55 * len(names) + 0.9, 1.5 * rows + 0.8)
    panels = figure.subplots(rows, len(names), sharex=True, sharey="row", squeeze=False)
    for column, name in enumerate(names):
        panels[0, column].set_title(_label(name))
        for row, (_, component) in enumerate(ROWS):
            _panel(panels[row, column], data, column, component, sphere=sphere)
        if sphere:
            _difference(panels[-1, column], data, column)
    for row, (label, _) in enumerate(ROWS):
        panels[row, 0].set_ylabel(f"{label}/(Lε)  [$10^{{-3}}$]")
    if sphere:
        panels[-1, 0].set_ylabel("|sphere \N{MINUS SIGN} cube|\n/ max |cube|  [%]")
    figure.supxlabel(
        "distance from the point above the centre / L"
        f"    (edge L, centre at depth {DEPTH:g} L, ν = {POISSON_RATIO:g}; $u_z$ > 0 into the body)",
        fontsize="medium",
    )
    figure.align_ylabels()
    entries = [Line2D([], [], color=colour, label=path) for path, colour in zip(PATHS, COLOURS, strict=False)]
    entries.append(Line2D([], [], label="Mindlin quadrature", color="0.3", **_MARK))
    if sphere:
        entries.append(Line2D([], [], label="sphere of equal volume", **_SPHERE))
    figure.legend(handles=entries, loc="outside upper center", ncols=len(entries))
    return figure


def _depth_figure(count: int) -> Figure:
    from matplotlib.ticker import FixedLocator, NullLocator

    depths = np.geomspace(1.001 * RADIUS, 40.0, count)
    curves = 100 * differences(COMPONENTS, depths)
    figure = new_figure(4.6, 3.4)
    axes = figure.subplots()
    dashes: Any = (0, (4, 2))
    styles = ("-", dashes, "-", "-", "-", dashes)
    for name, values, colour, style in zip(COMPONENTS, curves, COLOURS, styles, strict=True):
        axes.loglog(depths, values, color=colour, ls=style, label=_label(name))
    guide = np.array([8.0, 40.0])
    level = 2.0 * curves[:, -1].max() * (depths[-1] / guide) ** 2
    axes.loglog(guide, level, color="0.5", linewidth=0.8, ls=":")
    axes.annotate(
        "slope \N{MINUS SIGN}2", (18.0, np.sqrt(level.prod())), textcoords="offset points", xytext=(8, 0), color="0.4"
    )
    axes.axvline(RADIUS, color="0.8", linewidth=0.6, zorder=0)
    axes.annotate(
        "sphere touches the surface", (RADIUS, 1e-3), rotation=90, textcoords="offset points", xytext=(4, 0),
        color="0.4", fontsize=7.5, va="bottom",
    )  # fmt: skip
    axes.xaxis.set_major_locator(FixedLocator([0.5, 1, 2, 5, 10, 20, 40]))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xlim(0.5, 45.0)
    axes.set_xlabel("depth of the centre / L")
    axes.set_ylabel("largest |sphere \N{MINUS SIGN} cube| / largest |cube|  [%]")
    axes.legend(title="eigenstrain", ncols=2)
    return figure


def write_pictures(folder: Path, *, lines: int = 151, marks: int = 13, depths: int = 60) -> dict[str, float]:
    """Write the pictures into `folder`; returns the deviation of closed form and quadrature in each set of profiles."""
    folder.mkdir(parents=True, exist_ok=True)
    out = {}
    with paper_style():
        for name, eigenstrains, sphere in (
            ("surface-profiles-trace-free", TRACE_FREE, False),
            ("surface-profiles-components", COMPONENTS, True),
        ):
            data = profiles(eigenstrains, lines=lines, marks=marks)
            out[name] = data.deviation
            save(_profile_figure(eigenstrains, data, sphere=sphere), folder / f"{name}.png")
        save(_depth_figure(depths), folder / "cube-against-sphere.png")
    return out


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m eigencontact_verification.profiles", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path(), help="folder for the pictures")
    folder = parser.parse_args(arguments).output
    for name, deviation in write_pictures(folder).items():
        print(f"{folder / name}.png: closed form and quadrature differ by {deviation:.1e}")
    print(folder / "cube-against-sphere.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
