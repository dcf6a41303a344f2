"""A rigid sphere pressed into a half-space that yields and taken away again: scenes, and what is read of their runs.

Nothing of the finite elements is used here. Cells lie so that a column of them is on the axis, and stress is read in
their middles: plastic strain is uniform in a cell, and its stress is rough elsewhere.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PchipInterpolator

from eigencontact_verification.crosscheck.case import Fields, Profile

__all__ = ["VARIABLES", "Problem", "by_cells"]

FloatArray = NDArray[np.float64]

#: Variables of laws whose names in profiles are shorter.
VARIABLES = {"e_p": "equivalent_plastic_strain"}
#: Half width of the window, and depth to which stress is read, in contact radii.
_WINDOW, _DEEPEST = 1.5, 2.6
#: Room around the zone that elastic stress says; a box that proves too small grows.
_ROOM = 0.05
#: Half width of a layer, which here ends somewhere.
_WIDE = 3.0


@dataclass(frozen=True, kw_only=True)
class Problem:
    """Sphere, body and load path, in SI units; lengths of regions in contact radii of the elastic body.

    Parameters
    ----------
    young_modulus, poisson_ratio : float
        Of the body.
    radius, load : float
        Of the sphere, and its largest force.
    path : tuple of float
        Load at the end of each increment, in largest loads; the last one is zero. The first may be zero as well: only
        eigenstrain acts then.
    law : dict or None
        Fields of the body's law as a scene writes them, ``type`` "j2" by default; None: elastic.
    regions : tuple of dict
        By ``kind``: ``"layer"`` (top, bottom), ``"disc"`` (these and radius), ``"ball"`` (depth, radius). Each may have
        ``young_modulus`` in that of the body, ``poisson_ratio``, ``law``, and ``eigenstrain`` along the surface.
    """

    young_modulus: float
    poisson_ratio: float
    radius: float
    load: float
    path: tuple[float, ...]
    law: dict[str, Any] | None
    regions: tuple[dict[str, Any], ...]

    @property
    def contact_modulus(self) -> float:
        """E / (1 - nu²)."""
        return self.young_modulus / (1.0 - self.poisson_ratio**2)

    @property
    def contact_radius(self) -> float:
        """Hertz's a: the unit of length."""
        return float((0.75 * self.load * self.radius / self.contact_modulus) ** (1 / 3))

    @property
    def depth(self) -> float:
        """Hertz's a² / R: the unit of displacement."""
        return self.contact_radius**2 / self.radius

    @property
    def pressure(self) -> float:
        """Hertz's p0: the unit of stress."""
        return float(1.5 * self.load / (np.pi * self.contact_radius**2))

    @property
    def peak(self) -> int:
        """Last increment that ends with the largest load."""
        return int(np.flatnonzero(np.asarray(self.path) == max(self.path))[-1])

    def from_touch(self, depths: FloatArray) -> FloatArray:
        """Depths (n, 1) counted from the first touch, where the first increment is one of no load."""
        return depths - depths[0] if self.path[0] == 0 else depths

    def scene(self, cells: int) -> Any:
        """Scene with so many cells to a contact radius."""
        import eigencontact as ec

        a = self.contact_radius
        pitch, count = a / cells, 2 * round(_WINDOW * cells) + 1
        body = {"young_modulus": self.young_modulus, "poisson_ratio": self.poisson_ratio}
        deepest = round(_DEEPEST * cells)
        return ec.Scene(
            body1=body if self.law is None else {**body, "law": {"type": "j2", **self.law}},
            geometry={"type": "sphere", "radius": self.radius},
            inclusions=[self._inclusion(region) for region in self.regions],
            grid={"cells": [count, count], "size": [count * pitch, count * pitch]},
            steps=[{"normal_load": share * self.load} for share in self.path],
            stress={
                "name": "axis", "shape": "line", "start": [0.0, 0.0, 0.5 * pitch],
                "end": [0.0, 0.0, (deepest - 0.5) * pitch], "count": deepest,
            },
            numerics={"inclusion_pitch": pitch, "law_room": _ROOM},
            output={"pictures": False},
        )  # fmt: skip

    def _inclusion(self, region: dict[str, Any]) -> dict[str, Any]:
        a = self.contact_radius
        shape: dict[str, Any]
        if region["kind"] == "layer":
            thickness = (region["bottom"] - region["top"]) * a
            shape = {"type": "layer", "size": [2 * _WIDE * a] * 2, "top": region["top"] * a, "thickness": thickness}
        elif region["kind"] == "disc":
            length, middle = (region["bottom"] - region["top"]) * a, 0.5 * (region["top"] + region["bottom"]) * a
            radius = region["radius"] * a
            shape = {"type": "cylinder", "center": [0.0, 0.0, middle], "radius": radius, "length": length}
        else:
            shape = {"type": "sphere", "center": [0.0, 0.0, region["depth"] * a], "radius": region["radius"] * a}
        if region.get("eigenstrain"):
            shape["eigenstrain"] = [region["eigenstrain"], region["eigenstrain"], 0.0]
        constants = {
            "young_modulus": region.get("young_modulus", 1.0) * self.young_modulus,
            "poisson_ratio": region.get("poisson_ratio", self.poisson_ratio),
        }
        if region.get("law") is not None:
            shape["material"] = {"type": "j2", **constants, **region["law"]}
        elif "young_modulus" in region or "poisson_ratio" in region:
            shape["material"] = constants
        return shape


class _Interruption:
    """Watcher that ends a run after so many steps, as a keyboard does."""

    def __init__(self, stop: int) -> None:
        self._stop = stop

    def step_started(self, point: Any, _total: int) -> None:
        """End the run."""
        if point.index > self._stop:
            raise KeyboardInterrupt

    def iterated(self, *_: Any) -> None:
        """Nothing."""

    def step_finished(self, *_: Any) -> None:
        """Nothing."""


def _run(scene: Any, stop: int) -> Any:
    """Results of a scene; where `stop` is given, of a run that was interrupted after so many steps and resumed."""
    import eigencontact as ec

    if not stop:
        return ec.run(scene).dataset
    with TemporaryDirectory() as folder:
        with suppress(KeyboardInterrupt):
            ec.run(scene, folder, watcher=_Interruption(stop))
        with ec.run(scene, folder, resume=True).dataset as data:
            return data.load()


def by_cells(problem: Problem, profiles: tuple[Profile, ...], cells: int, *, stop: int = 0) -> Fields:
    """Values of the profiles in Hertz's units, by so many cells to a contact radius.

    Parameters
    ----------
    problem, profiles : Problem, tuple of Profile
        What is pressed, and what is read.
    cells : int
        Cells to a contact radius.
    stop : int
        Steps after which the run is interrupted, and resumed; 0: it is not.
    """
    data = _run(problem.scene(cells), stop)
    a, middle = problem.contact_radius, len(data["y"]) // 2
    x, depths = np.asarray(data["x"]) / a, np.asarray(data["axis_z"]) / a
    out: Fields = {}
    for profile in profiles:
        values: FloatArray
        if profile.name == "depth":
            values = problem.from_touch(np.asarray(data["approach"])[:, None]) / problem.depth
        elif profile.name == "pressure":
            row = np.asarray(data["pressure"])[problem.peak, middle] / problem.pressure
            values = -np.sqrt(PchipInterpolator(x, row**2)(profile.along))[:, None]  # p² ends with a slope
        elif profile.name == "print":
            row = np.asarray(data["residual_displacement_z"])[-1, middle] / problem.depth
            values = CubicSpline(x, row)(profile.along)[:, None]
        elif profile.name == "axis-stress":
            names = [str(name) for name in data["component"].values]
            rows = [names.index(component.rpartition("_")[2]) for component in profile.components]
            column = np.asarray(data["axis_stress"])[-1, rows] / problem.pressure
            values = CubicSpline(depths, column, axis=1)(profile.along).T
        else:
            (component,) = profile.components
            values = _remembered(data, depths, VARIABLES.get(component, component))(profile.along)[:, None]
        out[profile.name] = values
    return out


def _remembered(data: Any, depths: FloatArray, variable: str) -> CubicSpline:
    """Scalar history variable of the material along the axis; zero where there are no cells."""
    line, name = np.zeros_like(depths), f"{variable}_1"
    if name in data:
        z, y, x = (np.asarray(data[f"cells_1_{axis}"]) for axis in "zyx")
        column = np.asarray(data[name])[-1, :, np.abs(y).argmin(), np.abs(x).argmin()]
        scale = float(depths[0] / np.asarray(data["axis_z"])[0])
        rows = np.rint((z * scale - depths[0]) / (depths[1] - depths[0])).astype(int)
        stored = rows < len(depths)
        line[rows[stored]] = column[stored]
    return CubicSpline(depths, line)
