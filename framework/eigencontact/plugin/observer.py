"""The kind *observer*: computes numbers from every accepted step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from eigencontact.core.arrays import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.plugin.component import Component

__all__ = ["Observer", "RegionView", "RememberedView", "StepView"]


@dataclass(frozen=True, kw_only=True, slots=True)
class RegionView:
    """Fields at the points of a region below the surface. Arrays are read-only.

    Attributes
    ----------
    dims : tuple of str
        Dimensions of the points: ``("point",)`` of lines and lists, ``("z", "x")`` of a plane normal to y.
    coords : mapping of str to array or float
        x, y, z [m] along the dimension of their name, or along ``point``; a single number if it is equal at all points.
    fields : mapping of str to array
        Fields as in the results: ``stress (6, ...)`` [Pa] and ``strain (6, ...)`` in plain components xx, yy, zz, yz,
        xz, xy; ``displacement (3, ...)`` [m]; ``von_mises (...)`` and other scalars of the stress [Pa].

    Examples
    --------
    >>> import numpy as np
    >>> line = RegionView(dims=("point",), coords={"z": np.zeros(2)}, fields={"von_mises": np.array([1.0, 3.0])})
    >>> float(line.fields["von_mises"].max())
    3.0
    """

    dims: tuple[str, ...]
    coords: Mapping[str, FloatArray | float]
    fields: Mapping[str, FloatArray]


@dataclass(frozen=True, kw_only=True, slots=True)
class RememberedView:
    """Variable of the history of a body. Arrays are read-only.

    Attributes
    ----------
    values : (components, nz, ny, nx) or (components, n) array
        Values in cells, or of whole inclusions; six components are a Mandel vector.
    coords : mapping of str to array
        Centres of the cells along z, y, x [m]; empty for whole inclusions.
    unit : str
        SI unit.

    Examples
    --------
    >>> import numpy as np
    >>> strain = RememberedView(values=np.zeros((1, 2, 1, 1)), coords={"z": np.array([0.5, 1.5])}, unit="1")
    >>> strain.values.shape
    (1, 2, 1, 1)
    """

    values: FloatArray
    coords: Mapping[str, FloatArray]
    unit: str


@dataclass(frozen=True, kw_only=True, slots=True)
class StepView:
    """Results of an accepted load step for an observer. Arrays are read-only.

    Attributes
    ----------
    index : int
        Number of the step, from 1.
    grid : Grid
        Grid of the surface fields.
    fields : mapping of str to (ny, nx) array
        ``pressure`` [Pa], ``gap`` [m], ``displacement_z`` [m] and other fields of the plan.
    scalars : mapping of str to float
        ``normal_load`` [N], ``approach`` [m], ``tilt_x``, ``tilt_y`` [rad], ``contact_area`` [m^2] and others.
    regions : mapping of str to RegionView
        Regions of the scene and of the observer, by name.
    history : mapping of str to RememberedView
        History fields of the bodies: ``equivalent_eigenstrain_1`` of the inhomogeneities of body 1, ``<variable>_1`` of
        its constitutive laws.

    Examples
    --------
    >>> import numpy as np
    >>> grid = Grid(nx=2, ny=1, dx=1.0, dy=1.0)
    >>> step = StepView(index=1, grid=grid, fields={"pressure": np.ones((1, 2))}, scalars={"normal_load": 2.0})
    >>> float(step.fields["pressure"].sum() * step.grid.cell_area)
    2.0
    """

    index: int
    grid: Grid
    fields: Mapping[str, FloatArray]
    scalars: Mapping[str, float]
    regions: Mapping[str, RegionView] = field(default_factory=dict)
    history: Mapping[str, RememberedView] = field(default_factory=dict)


class Observer(Component, ABC):
    """Computes numbers from every accepted step, which are stored with it.

    Attributes
    ----------
    remembered : sequence of str
        Class attribute: names of `StepView.history` that the observer needs. The program refuses a scene whose bodies
        do not have them.
    counted : sequence of str
        Class attribute: names of numbers that count cells or are positions of cells, and therefore jump with the cells.
        Their errors are not extrapolated.
    widths : sequence of str
        Class attribute: those of `counted` that are lengths between the outermost cells of a zone. Their errors are at
        least half a cell.
    summed : sequence of str
        Class attribute: names of numbers that are sums over the load steps so far. Where wear skips cycles they have
        the solved ones alone, and no error.

    Examples
    --------
    >>> import numpy as np
    >>> class Middle(Observer):
    ...     key, units = "middle", {"pressure": "Pa"}
    ...     def observe(self, step):
    ...         ny, nx = step.grid.shape
    ...         return {"pressure": float(step.fields["pressure"][ny // 2, nx // 2])}
    >>> grid = Grid(nx=3, ny=3, dx=1.0, dy=1.0)
    >>> seen = StepView(index=1, grid=grid, fields={"pressure": np.eye(3)}, scalars={})
    >>> Middle().observe(seen)
    {'pressure': 1.0}
    """

    kind: ClassVar[str] = "observer"
    remembered: ClassVar[Sequence[str]] = ()
    counted: ClassVar[Sequence[str]] = ()
    widths: ClassVar[Sequence[str]] = ()
    summed: ClassVar[Sequence[str]] = ()

    @abstractmethod
    def observe(self, step: StepView) -> Mapping[str, float]:
        """Return named numbers (SI units) of this step; the names must not change from step to step."""

    @property
    def units(self) -> Mapping[str, str]:
        """SI unit of each number, by name; ``"1"`` of a ratio or a count. Others are stored as of unknown unit."""
        return {}

    @property
    def regions(self) -> Mapping[str, Mapping[str, Any]]:
        """Regions below the surface in each step, by name, as tables like ``[[stress]]``; they are not stored."""
        return {}
