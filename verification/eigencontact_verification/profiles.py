"""Surface displaced by a buried cube: every component of its eigenstrain, and the sphere of equal volume beside it.

``python -m eigencontact_verification.profiles -o DIR`` writes three pictures:

``surface-profiles-trace-free.png``
    The five trace-free strains that a plastic cube is made of (11-22, 11-33, 12, 13, 23).
``surface-profiles-components.png``
    The six single components, trace and all, with the sphere of the same volume.
``cube-against-sphere.png``
    How soon the two cannot be told apart: their largest difference along the profiles, against depth.

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
from eigencontact_verification.oracles import cuboid_quadrature, mindlin

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["COMPONENTS", "TRACE_FREE", "Case", "Profiles", "main", "profiles", "write_pictures"]

FloatArray = NDArray[np.float64]

POISSON_RATIO = 0.3
DEPTH = 5.0
REACH = 15.0
RADIUS = (3 / (4 * np.pi)) ** (1 / 3)
PATHS: dict[str, tuple[float, float]] = {"along x": (1.0, 0.0), "along y": (0.0, 1.0), "x = y": (0.5**0.5, 0.5**0.5)}
#: Rows of the figures: label and the index of the displacement.
ROWS = (("$u_z$", 2), ("$u_x$", 0), ("$u_y$", 1))
_PER_MILLE = 1e3


@dataclass(frozen=True)
class Case:
    """One eigenstrain of unit size."""

    label: str
    eigenstrain: FloatArray


def _case(label: str, *entries: tuple[int, int, float]) -> Case:
    e = np.zeros((3, 3))
    for i, j, value in entries:
        e[i, j] = e[j, i] = value
    return Case(label, e)


TRACE_FREE = (
    _case(r"$\epsilon_{xx} = -\epsilon_{yy}$", (0, 0, 1), (1, 1, -1)),
    _case(r"$\epsilon_{xx} = -\epsilon_{zz}$", (0, 0, 1), (2, 2, -1)),
    _case(r"$\epsilon_{xy}$", (0, 1, 1)),
    _case(r"$\epsilon_{xz}$", (0, 2, 1)),
    _case(r"$\epsilon_{yz}$", (1, 2, 1)),
)
COMPONENTS = (
    _case(r"$\epsilon_{xx}$", (0, 0, 1)),
    _case(r"$\epsilon_{yy}$", (1, 1, 1)),
    _case(r"$\epsilon_{zz}$", (2, 2, 1)),
    _case(r"$\epsilon_{xy}$", (0, 1, 1)),
    _case(r"$\epsilon_{xz}$", (0, 2, 1)),
    _case(r"$\epsilon_{yz}$", (1, 2, 1)),
)


@dataclass(frozen=True)
class Profiles:
    """Displacements over L times eigenstrain along the three paths.

    Attributes
    ----------
    distance, sampled : (n,), (m,)
        Distance from the point above the centre, over L; `sampled` for the quadrature.
    cube, sphere : (cases, 3 paths, n, 3)
        Closed forms.
    quadrature : (cases, 3 paths, m, 3)
        Mindlin's point force over the faces of the cube.
    deviation : float
        Largest difference of cube and quadrature over the largest displacement of the same case.
    """

    distance: FloatArray
    sampled: FloatArray
    cube: FloatArray
    sphere: FloatArray
    quadrature: FloatArray
    deviation: float


def _points(distance: FloatArray) -> FloatArray:
    return np.concatenate([np.outer(distance, (*direction, 0.0)) for direction in PATHS.values()])


def _displacements(shape: Any, cases: Sequence[Case], distance: FloatArray) -> FloatArray:
    found = [
        eigencontact.inclusion_field(
            shape, case.eigenstrain, _points(distance), young_modulus=1.0, poisson_ratio=POISSON_RATIO
        )
        for case in cases
    ]
    return np.array(found).reshape(len(cases), len(PATHS), distance.size, 3)


def _bodies(depth: float) -> tuple[Any, Any]:
    center = (0.0, 0.0, depth)
    cube = eigencontact.make("cuboid", center=center, edges=(1.0, 1.0, 1.0))
    return cube, eigencontact.make("sphere", kind="inclusion-shape", center=center, radius=RADIUS)


def profiles(cases: Sequence[Case], *, lines: int = 151, marks: int = 11) -> Profiles:
    """Displacement of the surface for each case, by closed form and by quadrature.

    Parameters
    ----------
    cases : sequence of Case
        Eigenstrains.
    lines, marks : int
        Points on each path of the closed form and of the quadrature.
    """
    distance, sampled = np.linspace(0.0, REACH, lines), np.linspace(0.0, REACH, marks)
    cube, sphere = _bodies(DEPTH)
    moments = cuboid_quadrature.moments(_points(sampled), (0.0, 0.0, DEPTH), (1.0, 1.0, 1.0))
    expected = np.array([mindlin.displacement(moments, case.eigenstrain, POISSON_RATIO) for case in cases])
    quadrature = expected.reshape(len(cases), len(PATHS), marks, 3)
    found = _displacements(cube, cases, sampled)
    difference = np.abs(found - quadrature).max(axis=(1, 2, 3)) / np.abs(quadrature).max(axis=(1, 2, 3))
    return Profiles(
        distance=distance,
        sampled=sampled,
        cube=_displacements(cube, cases, distance),
        sphere=_displacements(sphere, cases, distance),
        quadrature=quadrature,
        deviation=float(difference.max()),
    )


def _panel(axes: Axes, data: Profiles, case: int, component: int, *, sphere: bool) -> None:
    axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0)
    for path, colour in enumerate(COLOURS[: len(PATHS)]):
        at = (case, path, slice(None), component)
        axes.plot(data.distance, _PER_MILLE * data.cube[at], color=colour, zorder=2)
        # marks of the three paths are shifted against each other, so that equal curves still show all of them
        shown = slice(path % 3, None, 3) if data.sampled.size > 6 else slice(None)
        axes.plot(
            data.sampled[shown], _PER_MILLE * data.quadrature[at][shown], "o", color=colour, markerfacecolor="white",
            markersize=4.0, markeredgewidth=0.9, zorder=3,
        )  # fmt: skip
        if sphere:
            axes.plot(
                data.distance, _PER_MILLE * data.sphere[at], color="black", linewidth=0.8, ls=(0, (1, 2)), zorder=4
            )
    axes.set_xlim(0.0, REACH)
    axes.set_xticks(np.arange(0.0, REACH, 5.0))


def _legend(figure: Figure, *, sphere: bool) -> None:
    from matplotlib.lines import Line2D

    entries = [Line2D([], [], color=colour, label=name) for name, colour in zip(PATHS, COLOURS, strict=False)]
    mark: dict[str, Any] = {
        "marker": "o",
        "markerfacecolor": "white",
        "markersize": 4.0,
        "linestyle": "none",
        "color": "0.3",
    }
    entries.append(Line2D([], [], label="Mindlin quadrature", **mark))
    if sphere:
        entries.append(Line2D([], [], color="black", linewidth=0.8, ls=(0, (1, 2)), label="sphere of equal volume"))
    figure.legend(handles=entries, loc="outside upper center", ncols=len(entries))


def _profile_figure(cases: Sequence[Case], data: Profiles, *, sphere: bool) -> Figure:
    count = len(cases)
    rows = len(ROWS) + sphere
    figure = new_figure(1.55 * count + 0.9, 1.5 * rows + 0.8)
    panels = figure.subplots(rows, count, sharex=True, sharey="row", squeeze=False)
    for column, case in enumerate(cases):
        panels[0, column].set_title(case.label)
        for row, (label, component) in enumerate(ROWS):
            _panel(panels[row, column], data, column, component, sphere=sphere)
            if column == 0:
                panels[row, 0].set_ylabel(f"{label}/(Lε)  [$10^{{-3}}$]")
        if sphere:
            _difference(panels[-1, column], data, column)
    if sphere:
        panels[-1, 0].set_ylabel("|sphere \N{MINUS SIGN} cube|\n/ max |cube|  [%]")
    figure.supxlabel(
        "distance from the point above the centre / L"
        f"    (edge L, centre at depth {DEPTH:g} L, ν = {POISSON_RATIO:g}; $u_z$ > 0 into the body)",
        fontsize="medium",
    )
    figure.align_ylabels()
    _legend(figure, sphere=sphere)
    return figure


def _difference(axes: Axes, data: Profiles, case: int) -> None:
    """Length of sphere minus cube over the largest displacement of the case."""
    size = np.linalg.norm(data.cube[case], axis=-1).max()
    for path, colour in enumerate(COLOURS[: len(PATHS)]):
        gap = np.linalg.norm(data.sphere[case, path] - data.cube[case, path], axis=-1)
        axes.plot(data.distance, 100 * gap / size, color=colour)
    axes.set_ylim(bottom=0.0)


def differences(cases: Sequence[Case], depths: FloatArray, *, lines: int = 61) -> FloatArray:
    """Largest length of sphere minus cube over the largest displacement, ``(cases, depths)``; profiles of 3 depths."""
    out = np.empty((len(cases), depths.size))
    for column, depth in enumerate(depths):
        distance = np.linspace(0.0, 3 * depth, lines)
        cube, sphere = (_displacements(body, cases, distance) for body in _bodies(float(depth)))
        gap = np.linalg.norm(sphere - cube, axis=-1).max(axis=(1, 2))
        out[:, column] = gap / np.linalg.norm(cube, axis=-1).max(axis=(1, 2))
    return out


def _depth_figure(count: int) -> Figure:
    from matplotlib.ticker import FixedLocator, NullLocator

    depths = np.geomspace(1.001 * RADIUS, 40.0, count)
    found = 100 * differences(COMPONENTS, depths)
    figure = new_figure(4.6, 3.4)
    axes = figure.subplots()
    dashes: Any = (0, (4, 2))
    for case, values, colour, style in zip(
        COMPONENTS, found, COLOURS, ("-", dashes, "-", "-", "-", dashes), strict=True
    ):
        axes.loglog(depths, values, color=colour, ls=style, label=case.label)
    guide = np.array([8.0, 40.0])
    level = 2.0 * found[:, -1].max() * (depths[-1] / guide) ** 2
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
        for name, cases, sphere in (
            ("surface-profiles-trace-free", TRACE_FREE, False),
            ("surface-profiles-components", COMPONENTS, True),
        ):
            data = profiles(cases, lines=lines, marks=marks)
            out[name] = data.deviation
            save(_profile_figure(cases, data, sphere=sphere), folder / f"{name}.png")
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
