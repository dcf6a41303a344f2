"""Bodies of one material, with regions, or of layers; their fields under prescribed tractions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.core.tensors import to_matrix
from eigencontact.core.tractions import TRACTIONS
from eigencontact.core.units import parse_quantity, readable
from eigencontact.errors import SceneError, require
from eigencontact.library.arguments import lengths, plane
from eigencontact.library.components import field_points
from eigencontact.library.voxels import Voxels
from eigencontact.scene.installed import installed_plugins
from eigencontact.scene.plain import plain

if TYPE_CHECKING:
    from eigencontact.plugin import LayeredMedium

__all__ = ["Body", "HalfSpace", "Layered", "field_under"]

FloatArray = NDArray[np.float64]

#: Keys of the table of a body of elastic constants alone.
_ELASTIC = {"young-modulus", "poisson-ratio"}


class Body(ABC):
    """Base of half-spaces: fields under prescribed tractions."""

    def stress(
        self,
        points: ArrayLike,
        *,
        pressure: ArrayLike | None = None,
        shear: ArrayLike | None = None,
        spacing: float | str | Sequence[float | str],
        center: tuple[float, float] = (0.0, 0.0),
    ) -> FloatArray:
        """Stress at points of the body under tractions on its surface, uniform on each cell of a window.

        Parameters
        ----------
        points : (n, 3) [m]
            x, y and depth z, 0 or more.
        pressure : (ny, nx) [Pa], optional
            Pressure into the body; rows along y.
        shear : (2, ny, nx) [Pa], optional
            Tractions on the body along x and along y.
        spacing : float or (float, float)
            Edges of a cell along x and y [m]; text with a unit is accepted.
        center : (float, float)
            Centre of the window (x, y) [m].

        Returns
        -------
        (n, 3, 3) [Pa]
            Symmetric tensors, tension positive. At depths of less than a quarter of a cell they are means over
            cells, interpolated linearly between the centres, because the stress at cell edges is infinite.

        Raises
        ------
        SceneError
            Arrays of different shapes, tractions that are missing or not finite, points above the surface, or a body
            with inclusions, which need a contact solution.

        Examples
        --------
        >>> import numpy as np, eigencontact as ec
        >>> disc = np.where(np.hypot(*np.mgrid[-2:2:64j, -2:2:64j]) < 1, 1e9, 0)
        >>> stress = ec.HalfSpace("210 GPa", 0.3).stress([[0, 0, 1e-6]], pressure=disc, spacing="62.5 nm")
        >>> stress.shape, bool(-0.65e9 < stress[0, 2, 2] < -0.64e9)  # 1 - z³/(a² + z²)^1.5 = 0.646 of the pressure
        ((1, 3, 3), True)
        """
        return field_under(self, "stress", points, pressure, shear, spacing, center)

    def displacement(
        self,
        points: ArrayLike,
        *,
        pressure: ArrayLike | None = None,
        shear: ArrayLike | None = None,
        spacing: float | str | Sequence[float | str],
        center: tuple[float, float] = (0.0, 0.0),
    ) -> FloatArray:
        """Displacement of points of the body, including its surface, under tractions; see `stress`.

        Returns
        -------
        (n, 3) [m]
            Displacement relative to distant points of the body; z points into the body.

        Examples
        --------
        >>> import numpy as np, eigencontact as ec
        >>> steel = ec.HalfSpace("210 GPa", 0.3)
        >>> u = steel.displacement([[0, 0, 0]], pressure=np.full((32, 32), 1e9), spacing="1 um")
        >>> f"{u[0, 2]:.4g} m"  # 1.1222 p (1 - ν²) / E times the edge of the square, Love 1929
        '1.556e-07 m'
        """
        return field_under(self, "displacement", points, pressure, shear, spacing, center)

    @abstractmethod
    def scene_table(self) -> dict[str, Any]:
        """Table ``[body1]`` of a scene."""

    def scene_inclusions(self, number: int) -> list[dict[str, Any]]:  # noqa: ARG002 - of this body as body `number`
        """Tables ``[[inclusions]]``."""
        return []

    @property
    @abstractmethod
    def solid(self) -> Material | LayeredMedium:
        """Elastic constants, uniform or by depth, for the kernels."""

    @abstractmethod
    def __repr__(self) -> str: ...


class HalfSpace(Body):
    """An elastic half-space, optionally with a constitutive law, inclusions and voxels.

    Parameters
    ----------
    young_modulus : float or str
        E [Pa]; text with a unit is accepted.
    poisson_ratio : float
        ν [-] in (-1, 0.5]; 0.5 is incompressible.
    law : mapping or component, optional
        Constitutive law of the whole body: of `make`, or as the table of a scene,
        ``{"type": "j2", "hardening": {"type": "perfect", "yield_stress": "1 GPa"}}``. Its elastic constants are those
        of the body.
    voxels : Voxels, optional
        Regions given by an array of whole numbers, with a material or an eigenstrain for each.
    inclusions : sequence of mappings, optional
        Regions of a shape, as the tables ``[[inclusions]]`` of a scene.
    bulk_stress : mapping, optional
        Stress by a distant load, before the first step, as the table of a scene: ``{"xx": "200 MPa"}``. Steps ramp it
        by their keys ``bulk-stress-xx``, ``bulk-stress-yy`` and ``bulk-stress-xy``.

    Raises
    ------
    SceneError
        Constants out of their range. The law and the regions are checked when the body is used.

    Examples
    --------
    >>> import eigencontact as ec
    >>> ec.HalfSpace("210 GPa", 0.3)
    HalfSpace('210 GPa', 0.3)
    >>> soft = {"type": "sphere", "center": (0, 0, 5e-6), "radius": 2e-6, "material": {"void": True}}
    >>> ec.HalfSpace(210e9, 0.3, inclusions=[soft])
    HalfSpace('210 GPa', 0.3, 1 inclusion)
    """

    def __init__(
        self,
        young_modulus: float | str,
        poisson_ratio: float,
        *,
        law: Any = None,
        voxels: Voxels | None = None,
        inclusions: Iterable[Mapping[str, Any]] = (),
        bulk_stress: Mapping[str, Any] | None = None,
    ) -> None:
        rule = "a table of xx, yy and xy, or None"
        require(bulk_stress is None or isinstance(bulk_stress, Mapping), "HalfSpace", "bulk_stress", bulk_stress, rule)
        self._bulk_stress = None if bulk_stress is None else dict(bulk_stress)
        self._material = material_of(young_modulus, poisson_ratio, "HalfSpace")
        require(voxels is None or isinstance(voxels, Voxels), "HalfSpace", "voxels", voxels, "Voxels, or None")
        self._law, self._voxels = law, voxels
        tables = [inclusions] if isinstance(inclusions, Mapping) else inclusions
        rule = "a sequence of tables, as [[inclusions]] of a scene"
        require(isinstance(tables, Iterable) and not isinstance(tables, str), "HalfSpace", "inclusions", tables, rule)
        self._given = list(tables)
        for number, table in enumerate(self._given):
            require(isinstance(table, Mapping), "HalfSpace", f"inclusions[{number}]", table, "a table")

    @property
    def young_modulus(self) -> float:
        """E [Pa]."""
        return self._material.young_modulus

    @property
    def poisson_ratio(self) -> float:
        """ν [-]."""
        return self._material.poisson_ratio

    @property
    def voxels(self) -> Voxels | None:
        """Regions from an array."""
        return self._voxels

    @property
    def solid(self) -> Material:
        """See `Body`."""
        return self._material

    def scene_table(self) -> dict[str, Any]:
        """See `Body`."""
        table: dict[str, Any] = {"young-modulus": self.young_modulus, "poisson-ratio": self.poisson_ratio}
        parts = {"law": self._law, "bulk-stress": self._bulk_stress}
        return table | {name: setting for name, setting in parts.items() if setting is not None}

    def scene_inclusions(self, number: int) -> list[dict[str, Any]]:
        """See `Body`."""
        tables = [{**table, "body": number} for table in self._given]
        return tables + ([] if self._voxels is None else self._voxels.tables(number))

    def __repr__(self) -> str:
        entries = [repr(readable(self.young_modulus, "Pa")), f"{self.poisson_ratio:g}"]
        if self._law is not None:
            entries.append(f"law {_type_of(self._law)!r}")
        if self._bulk_stress is not None:
            entries.append(f"bulk stress {self._bulk_stress!r}")
        if self._given:
            entries.append(f"{len(self._given)} inclusion{'s' if len(self._given) > 1 else ''}")
        if self._voxels is not None:
            entries.append(repr(self._voxels))
        return f"HalfSpace({', '.join(entries)})"


class Layered(Body):
    """A half-space of bonded elastic layers on a substrate; exact, whatever their thickness.

    Parameters
    ----------
    layers : sequence of (thickness, young_modulus, poisson_ratio)
        From the surface down; thickness [m], E [Pa], ν [-]. Text with units is accepted.
    substrate : HalfSpace or (young_modulus, poisson_ratio)
        Half-space below the layers, of one material, without a law or regions.

    Raises
    ------
    SceneError
        Invalid layers or constants.

    Examples
    --------
    >>> import eigencontact as ec
    >>> ec.Layered([("2 um", "420 GPa", 0.25)], substrate=("210 GPa", 0.3))
    Layered([('2 um', '420 GPa', 0.25)], substrate=('210 GPa', 0.3))
    """

    def __init__(
        self,
        layers: Sequence[tuple[float | str, float | str, float]],
        substrate: HalfSpace | tuple[float | str, float],
    ) -> None:
        from eigencontact.library.components import make

        rule = "(thickness, young_modulus, poisson_ratio) each, from the surface down"
        good = isinstance(layers, list | tuple) and len(layers) > 0
        require(good, "Layered", "layers", layers, f"one layer or more, {rule}")
        tables = []
        for number, layer in enumerate(layers):
            good = isinstance(layer, list | tuple) and len(layer) == 3
            require(good, "Layered", f"layers.{number}", layer, rule)
            tables.append(dict(zip(("thickness", "young_modulus", "poisson_ratio"), layer, strict=True)))
        if isinstance(substrate, HalfSpace):
            plain = substrate.scene_table().keys() == _ELASTIC and not substrate.scene_inclusions(1)
            rule = "of one elastic material, without a law, regions or bulk stress"
            require(plain, "Layered", "substrate", substrate, rule)
            base = substrate.solid
        else:
            good = isinstance(substrate, list | tuple) and len(substrate) == 2
            require(good, "Layered", "substrate", substrate, "a HalfSpace, or (young_modulus, poisson_ratio)")
            base = material_of(*substrate, "Layered.substrate")
        constants = {"young_modulus": base.young_modulus, "poisson_ratio": base.poisson_ratio}
        try:
            self._medium: LayeredMedium = make("bonded-layers", layers=tables, substrate=constants)
        except SceneError as problem:
            raise SceneError(str(problem).replace("bonded-layers.", "Layered.", 1)) from None

    @property
    def solid(self) -> LayeredMedium:
        """See `Body`."""
        return self._medium

    def scene_table(self) -> dict[str, Any]:
        """See `Body`."""
        return {"medium": self._medium}

    def __repr__(self) -> str:
        tops = (0.0, *self._medium.interfaces)
        layers = [
            (readable(bottom - top, "m"), *_constants(self._medium.material_at(top))) for top, bottom in pairwise(tops)
        ]
        return f"Layered({layers!r}, substrate={_constants(self._medium.deep_material)!r})"


def material_of(young_modulus: float | str, poisson_ratio: float, where: str) -> Material:
    """Elastic constants; errors name the function or class that receives them."""
    modulus = plain(young_modulus, f"{where}.young_modulus")
    try:
        E = parse_quantity(modulus, "Pa", "a stress")
    except ValueError as problem:
        raise SceneError(f"{where}.young_modulus must be {problem} (got {modulus!r})") from None
    try:
        return Material(young_modulus=E, poisson_ratio=plain(poisson_ratio, f"{where}.poisson_ratio"))
    except SceneError as problem:
        raise SceneError(str(problem).replace("material.", f"{where}.", 1)) from None


def _constants(material: Material) -> tuple[str, float]:
    return readable(material.young_modulus, "Pa"), material.poisson_ratio


def _type_of(law: Any) -> str:
    return str(law.get("type", "?") if isinstance(law, Mapping) else getattr(law, "key", "?"))


def field_under(
    body: Body,
    quantity: str,
    points: ArrayLike,
    pressure: ArrayLike | None,
    shear: ArrayLike | None,
    spacing: float | str | Sequence[float | str],
    center: Sequence[float],
) -> FloatArray:
    """Stress ``(n, 3, 3)`` [Pa] or displacement ``(n, 3)`` [m]; see `eigencontact.library.bodies.Body`."""
    from eigencontact.model.bodies import influence_for
    from eigencontact.model.kernels import StressCoefficients
    from eigencontact.solvers.subsurface import stress_at_points
    from eigencontact.solvers.surface_means import depth_of_means, means_at_points

    where = f"{type(body).__name__}.{quantity}"
    table = body.scene_table()
    if not table.keys() <= _ELASTIC | {"medium"} or body.scene_inclusions(1):
        raise SceneError(
            f"{where} must be of a body of elastic constants and layers alone (got {body!r}); regions, laws and bulk "
            "stress answer to a contact: solve_contact(...)"
        )
    loads = _loads(pressure, shear, where)
    shape = next(iter(loads.values())).shape
    dx, dy = lengths(spacing, 2, where, "spacing")
    middle = lengths(center, 2, where, "center", positive=False)
    grid = Grid(nx=shape[1], ny=shape[0], dx=dx, dy=dy, center=(middle[0], middle[1]))
    at = field_points(points, where, half_space=True) + 0.0  # a depth of -0.0 would be the other side of the surface
    registry, solid = installed_plugins(), body.solid
    kernels = [
        StressCoefficients(influence_for(registry, name, (solid, None)), solid, quantity)
        for name in TRACTIONS
        if name in loads
    ]
    tractions = [loads[name] for name in TRACTIONS if name in loads]
    near = at[:, 2] < depth_of_means(grid) if quantity == "stress" else np.zeros(len(at), dtype=bool)
    values = np.zeros((len(kernels[0].components), len(at)))
    evaluations: list[tuple[NDArray[np.bool_], Any]] = [(near, means_at_points), (~near, stress_at_points)]
    for selected, evaluate in evaluations:
        if selected.any():
            values[:, selected] = evaluate(grid, kernels, tractions, at[selected])
    return to_matrix(values) if quantity == "stress" else np.ascontiguousarray(values.T)


def _loads(pressure: ArrayLike | None, shear: ArrayLike | None, where: str) -> dict[str, FloatArray]:
    """Tractions by name, of one shape."""
    if pressure is None and shear is None:
        raise SceneError(f"{where} must be given a pressure (ny, nx), a shear (2, ny, nx), or both (got neither)")
    loads = {}
    if pressure is not None:
        loads["p"] = plane(pressure, where, "pressure", "Pa")
    if shear is not None:
        tractions = plane(shear, where, "shear", "Pa", leading=(2,))
        loads |= {"q_x": tractions[0], "q_y": tractions[1]}
        if "p" in loads:
            rule = f"of the shape {(2, *loads['p'].shape)} of the pressure"
            require(tractions.shape[1:] == loads["p"].shape, where, "shear", tractions.shape, rule)
    return loads
