"""Cases of wear: a sphere that slides or frets on a half-space, by rings of uniform pressure and by a scene.

The rings of `oracles.wear_rings` stand where other cases have finite elements: three divisions, each with half the
width of ring and half the step of the one before, say how far they are from the limit. They end in no outer face, so
both conditions there are one. Lengths along the surface are in contact radii a of the body as new, depths in a²/R,
pressures in its largest pressure p0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator, RectBivariateSpline

from eigencontact_verification.crosscheck.case import Case, Fields, Level, Outer, Profile, error_key
from eigencontact_verification.crosscheck.cell_errors import from_coarser
from eigencontact_verification.oracles.wear_rings import Contact, Rings, fret, slide

__all__ = ["KEY", "WearCase", "wear_case"]

FloatArray = NDArray[np.float64]

#: Name under which wear is verified; it is no plugin's key.
KEY = "wear"
_CODE = (__name__, *(f"eigencontact_verification.oracles.{name}" for name in ("wear_rings", "coated_contact")))
#: Steel under the rigid sphere of case HZ-2: the contact radius of the uncoated body, and the sphere's.
_YOUNG, _RADIUS, _SPHERE = 210e9, 20e-6, 200e-6
#: Rings to a contact radius, and steps to a decade of sliding or for all cycles, of the coarsest level.
_RINGS, _STEPS = 40, 20
#: Cells to a contact radius of what is judged, and of the coarser runs that give its error, which falls at order 1.
_CELLS, _COARSER = 32, (16, 19)
#: Part of π a⁴/(4R) that the first step of sliding rings wears.
_FIRST_VOLUME = 1e-3
#: Distance from an edge of the contact at which values are compared [a].
_MARGIN = 0.1
#: Directions of half a turn that the values of cells are the mean of.
_DIRECTIONS = 8


@dataclass(frozen=True, kw_only=True, eq=False)
class WearCase(Case):
    """A rigid sphere under a load that slides all over the contact, or frets.

    Parameters
    ----------
    cells, coarser : int, tuple of int
        Cells to a contact radius of what is judged, and of the runs that give its error.
    title : str
        What wears, in words.
    """

    cells: int = _CELLS
    coarser: tuple[int, ...] = _COARSER
    title: str = ""

    code: ClassVar[tuple[str, ...]] = _CODE
    method: ClassVar[str] = "rings"

    @property
    def modulus(self) -> float:
        """E* of the body without its layer [Pa]."""
        return float(_YOUNG / (1.0 - self.parameters["poisson_ratio"] ** 2))

    @property
    def load(self) -> float:
        """Load that gives the contact radius a on the body without its layer [N]."""
        return 4.0 / 3.0 * self.modulus * _RADIUS**3 / _SPHERE

    @property
    def pressure(self) -> float:
        """Hertz's p0 [Pa]: the unit."""
        return 1.5 * self.load / (np.pi * _RADIUS**2)

    @property
    def coefficient(self) -> float:
        """Worn volume by work of friction [m³/J] of fretting; given times p0."""
        return float(self.parameters["wear"] / self.pressure)

    @property
    def volume(self) -> float:
        """Worn volume of sliding [m³]; given in π a⁴/(4R)."""
        return float(self.parameters["volume"] * np.pi * _RADIUS**4 / (4.0 * _SPHERE))

    def reference(self, level: Level, outer: Outer) -> Fields:  # noqa: ARG002 - rings have no outer faces
        """Values by rings."""
        parameters, fine = self.parameters, 2**level
        number = _RINGS * fine
        edges = _RADIUS / number * np.arange(round(0.5 * parameters["reach"] * number) + 1)
        rings = self._rings(edges)
        gap = rings.middles**2 / (2.0 * _SPHERE)
        if "volume" in parameters:
            first = _FIRST_VOLUME * np.pi * _RADIUS**4 / (4.0 * _SPHERE)
            count = round(_STEPS * fine * np.log10(self.volume / first)) + 1
            *_, slid = slide(rings, gap, self.load, list(np.geomspace(first, self.volume, count)))
            return self._read(rings.middles, slid.contact, slid.depth)
        count = _STEPS * fine
        load = self.load if parameters["kept"] == "load" else None
        approach = _RADIUS**2 / _SPHERE if parameters["kept"] == "approach" else None
        updates = [0.25, *[parameters["cycles"] / count] * count]  # the first quarter goes out from the middle
        *_, fretted = fret(
            rings, gap, updates, amplitude=parameters["amplitude"] * _RADIUS, friction=parameters["friction"],
            coefficient=self.coefficient, modulus_ratio=1.0, load=load, approach=approach,
        )  # fmt: skip
        return self._read(rings.middles, fretted.contact, fretted.depth)

    def _rings(self, edges: FloatArray) -> Rings:
        if "layer" not in self.parameters:
            return Rings(edges=edges, contact_modulus=self.modulus)
        thickness, ratio = self.parameters["layer"]
        nu = self.parameters["poisson_ratio"]
        return Rings(
            edges=edges, contact_modulus=ratio * self.modulus,
            layers=((thickness * _RADIUS, ratio * _YOUNG, nu),), substrate=(_YOUNG, nu),
        )  # fmt: skip

    def _read(self, r: FloatArray, contact: Contact, depth: FloatArray) -> Fields:
        """Values of the profiles from those in the middles of rings, mirrored at the axis."""
        values = {"pressure": contact.pressure, "worn_depth": depth}
        fields: Fields = {}
        for profile in self.profiles:
            name, unit = self._units[profile.name]
            scaled = values[name] / unit
            line = PchipInterpolator(np.concatenate([-r[2::-1], r]), np.concatenate([scaled[2::-1], scaled]))
            fields[profile.name] = line(_RADIUS * profile.along)[:, None]
        return fields

    @property
    def _units(self) -> dict[str, tuple[str, float]]:
        """Name in results and unit of a profile; stress is negative in compression."""
        return {"pressure": ("pressure", -self.pressure), "depth": ("worn_depth", _RADIUS**2 / _SPHERE)}

    def scene(self, cells: int) -> Any:
        """Scene with so many cells to a contact radius; a row of them lies on the axis."""
        import eigencontact as ec

        parameters, pitch = self.parameters, _RADIUS / cells
        count = 2 * round(0.5 * parameters["reach"] * cells) + 1
        constants = {"young_modulus": _YOUNG, "poisson_ratio": parameters["poisson_ratio"]}
        body: dict[str, Any] = constants
        if "layer" in parameters:
            thickness, ratio = parameters["layer"]
            layer = {"thickness": thickness * _RADIUS, **constants, "young_modulus": ratio * _YOUNG}
            body = {"medium": {"type": "bonded-layers", "layers": [layer], "substrate": constants}}
        tables = self._sliding() if "volume" in parameters else self._fretting()
        return ec.Scene(
            body1=body,
            body2={"rigid": True},
            geometry={"type": "sphere", "radius": _SPHERE},
            grid={"cells": [count, count], "size": [count * pitch, count * pitch]},
            output={"pictures": False},
            **tables,
        )

    def _sliding(self) -> dict[str, Any]:
        """A scene slides 1 m: the law has the coefficient that wears the volume."""
        by_load = self.volume / self.load
        return {
            "wear": {"type": "archard", "coefficient": by_load, "hardness": 1.0, "body": 2},
            "steps": [
                {"normal_load": self.load},
                {"normal_load": self.load, "sliding_distance": 1.0},
            ],
        }

    def _fretting(self) -> dict[str, Any]:
        """To and fro from a middle position, the pressure not coupled to the shear."""
        parameters = self.parameters
        amplitude = parameters["amplitude"] * _RADIUS
        pressed = {"normal_load": self.load} if parameters["kept"] == "load" else {"approach": _RADIUS**2 / _SPHERE}
        return {
            "friction": {"type": "coulomb", "coefficient": parameters["friction"]},
            "wear": {"type": "dissipated-energy", "coefficient": self.coefficient, "jump_error": 1e-3},
            "numerics": {"coupling": "none"},
            "steps": [
                pressed,
                {"shift_x": amplitude},
                {"cycle": [{"shift_x": -amplitude}, {"shift_x": amplitude}], "repeat": parameters["cycles"]},
                pressed,  # the pressure of the surface as the last cycle leaves it
            ],
        }

    def by_cells(self, cells: int) -> Fields:
        """Values by so many cells to a contact radius: means over directions, which cut the cells differently."""
        import eigencontact as ec

        data = ec.run(self.scene(cells)).dataset
        x, y = (np.asarray(data[name]) / _RADIUS for name in ("x", "y"))
        angles = np.pi * (np.arange(_DIRECTIONS) + 0.5) / _DIRECTIONS
        fields: Fields = {}
        for profile in self.profiles:
            name, unit = self._units[profile.name]
            spline = RectBivariateSpline(y, x, np.asarray(data[name])[-1] / unit)
            r = np.multiply.outer(profile.along, np.ones_like(angles))
            fields[profile.name] = spline(r * np.sin(angles), r * np.cos(angles), grid=False).mean(axis=1)[:, None]
        return fields

    def judged(self) -> Fields:
        """Values by the finest cells, with what the coarser ones say of their error."""
        fine, *coarser = (self.by_cells(cells) for cells in (self.cells, *self.coarser))
        ratios = [self.cells / cells for cells in self.coarser]
        fields: Fields = dict(fine)
        for profile in self.profiles:
            values = [run[profile.name] for run in coarser]
            fields[error_key(profile.name)] = from_coarser(fine[profile.name], values, ratios)
        return fields

    @property
    def words(self) -> str:
        """Title of the figures: the problem in words."""
        nu = f"ν = {self.parameters['poisson_ratio']:g}"
        return f"{self.subject}: {self.title}, {nu}; {self.cells} cells to a contact radius"


def wear_case(
    name: str, title: str, pressed: Mapping[str, Any], worn: Mapping[str, Any], *, quick: bool = False,
    **parameters: Any,
) -> WearCase:  # fmt: skip
    """Case of one sphere.

    Parameters
    ----------
    name, title : str
        Of the case; description of the wear, for the figures.
    pressed, worn : mapping
        Arguments of `_radii`: radii at which the pressure and the worn depth are compared [a].
    quick : bool
        Whether the case belongs to the quick cross-check.
    parameters
        ``reach`` of the window, ``poisson_ratio`` (default 0.3), and either the worn ``volume`` of sliding, with
        ``layer`` (thickness, ratio of moduli); or ``friction``, ``amplitude``, ``cycles``, ``wear`` and ``kept``
        (``"load"`` or ``"approach"``) of fretting.
    """

    def line(name: str, quantity: Any, r: FloatArray, component: str, unit: str) -> Profile:
        points = np.stack([r, 0.0 * r, 0.0 * r], axis=1)
        return Profile(
            name=name, quantity=quantity, points=points, along=r, label="distance from the axis [a]",
            components=(component,), unit=unit,
        )  # fmt: skip

    profiles = (
        line("pressure", "stress", _radii(**pressed), "s_zz", "p0"),
        line("depth", "displacement", _radii(**worn), "worn_depth", "a²/R"),
    )
    return WearCase(
        subject=KEY, name=name, title=title, quick=quick, profiles=profiles,
        parameters={"poisson_ratio": 0.3, **parameters},
    )  # fmt: skip


def _radii(
    last: float, *, edges: Sequence[float] = (), span: tuple[float, float, int] = (0.0, 0.0, 0),
    more: Sequence[float] = (),
) -> FloatArray:  # fmt: skip
    """Radii to `last`, those of a second span, and single ones [a].

    Those to `last` keep off the edges, where the pressure of rings and of cells is rough.
    """
    r = np.linspace(0.0, last, round(last / 0.05) + 1)
    clear = np.all(np.abs(r[:, None] - np.asarray(edges)) > _MARGIN, axis=1)
    return np.concatenate([r[clear], np.linspace(*span), more])
