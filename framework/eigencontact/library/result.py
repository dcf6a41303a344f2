"""Result of a solved contact."""

from __future__ import annotations

import tomllib
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.arrays import is_whole
from eigencontact.core.html_table import html_table
from eigencontact.core.numbers import Number, headline_numbers
from eigencontact.errors import SceneError, require
from eigencontact.library.arguments import length
from eigencontact.library.components import field_points
from eigencontact.scene.installed import installed_plugins

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

    from eigencontact.app import RunResult
    from eigencontact.core.held_arrays import HeldArrays
    from eigencontact.library.bodies import Body
    from eigencontact.results.records import StepRecord

__all__ = ["ContactResult"]

FloatArray = NDArray[np.float64]

_SUBJECT = "ContactResult"


class ContactResult:
    """A contact that was solved, after its last step or another one.

    `solve_contact` makes it. Arrays on the surface are of shape (ny, nx), rows along y, and (1, nx) of a line contact;
    everything is in SI units.

    Attributes
    ----------
    summary : dict
        Numbers of the run, its certificates, times, versions and sources to cite.

    Examples
    --------
    >>> import eigencontact as ec
    >>> ball = ec.make("sphere", radius="105 um")
    >>> contact = ec.solve_contact(ball, ec.HalfSpace("210 GPa", 0.3), load=["0.3 N", "0.65 N"])
    >>> contact  # doctest: +NORMALIZE_WHITESPACE
    ContactResult(normal load 650 mN, approach 348.97 nm, contact radius 6.0393 um, largest pressure 8.468 GPa,
                  step 2 of 2)
    >>> round(contact.at(1).load, 6)
    0.3
    """

    def __init__(
        self,
        run: RunResult,
        bodies: tuple[Body | None, Body | None],
        held_arrays: tuple[HeldArrays, ...] = (),
        step: int | None = None,
    ) -> None:
        self._run, self._bodies, self._held_arrays, self._step = run, bodies, held_arrays, step
        self.summary: dict[str, Any] = run.summary

    # ------------------------------------------------------------ numbers of the surface

    @property
    def dataset(self) -> xarray.Dataset:
        """Dataset of all steps, with coordinates, units and provenance."""
        return self._run.dataset

    @property
    def steps(self) -> int:
        """Number of solved steps, including increments."""
        return int(self.dataset.sizes["step"])

    def at(self, step: int) -> ContactResult:
        """Return the same contact after another step, counted from 1.

        Raises
        ------
        SceneError
            An unsolved step.

        Examples
        --------
        >>> import eigencontact as ec
        >>> ball, steel = ec.make("sphere", radius="105 um"), ec.HalfSpace("210 GPa", 0.3)
        >>> pressed = ec.solve_contact(ball, steel, load=[0.1, 0.2])
        >>> pressed.at(1).radius < pressed.radius
        True
        """
        require(is_whole(step) and 1 <= step <= self.steps, _SUBJECT, "step", step, f"1 to {self.steps}")
        return ContactResult(self._run, self._bodies, self._held_arrays, int(step))

    @property
    def x(self) -> FloatArray:
        """Centres of the cells along x, (nx,) [m]."""
        return np.asarray(self.dataset["x"].values)

    @property
    def y(self) -> FloatArray:
        """Centres of the cells along y, (ny,) [m]."""
        return np.asarray(self.dataset["y"].values)

    @property
    def pressure(self) -> FloatArray:
        """Contact pressure, (ny, nx) [Pa]; positive in compression."""
        return self._field("pressure")

    @property
    def shear(self) -> FloatArray:
        """Shear traction on the lower body along x and y, (2, ny, nx) [Pa]; zero without friction."""
        fields = [self._field(name) if name in self.dataset else 0 * self.pressure for name in ("shear_x", "shear_y")]
        return np.array(fields)

    @property
    def gap(self) -> FloatArray:
        """Gap between the deformed surfaces, (ny, nx) [m]; zero in contact."""
        return self._field("gap")

    @property
    def load(self) -> float:
        """Normal load [N], per length of a line contact [N/m]."""
        return self._number("normal_load")

    @property
    def approach(self) -> float:
        """Approach of distant points of the bodies [m]."""
        return self._number("approach")

    @property
    def contact_area(self) -> float:
        """Contact area, corrected for cells that its edge cuts [m²]."""
        return self._number("contact_area")

    @property
    def radius(self) -> float:
        """Radius of the circle of equal contact area [m]; half width of a line contact."""
        return self._number("contact_radius")

    @property
    def max_pressure(self) -> float:
        """Largest contact pressure [Pa]."""
        return self._number("max_pressure")

    def to_xarray(self) -> xarray.Dataset:
        """Surface fields after this step, over y and x; `dataset` has all steps and numbers.

        Examples
        --------
        >>> import eigencontact as ec
        >>> ball, steel = ec.make("sphere", radius="105 um"), ec.HalfSpace("210 GPa", 0.3)
        >>> fields = ec.solve_contact(ball, steel, load="0.65 N", cells=64, size="16 um").to_xarray()
        >>> list(fields)
        ['displacement_z', 'gap', 'pressure', 'reference_pressure']
        """
        names = [name for name, field in self.dataset.data_vars.items() if field.dims == ("step", "y", "x")]
        return self.dataset[names].isel(step=self._place)

    def profile(self, axis: str = "x", at: float | str = 0.0) -> xarray.Dataset:
        """Fields on the surface along a row of cells; of the cells whose centres are nearest to the line.

        Parameters
        ----------
        axis : {"x", "y"}
            Along which axis.
        at : float or str
            Coordinate of the line on the other axis [m]; the dataset has the coordinate of the selected cells.

        Raises
        ------
        SceneError
            A line outside the window.

        Examples
        --------
        >>> import eigencontact as ec
        >>> ball, steel = ec.make("sphere", radius="105 um"), ec.HalfSpace("210 GPa", 0.3)
        >>> contact = ec.solve_contact(ball, steel, load="0.65 N", cells=63, size="16 um")
        >>> line = contact.profile("x")
        >>> error = abs(line.pressure - line.reference_pressure).max() / contact.max_pressure
        >>> line.pressure.dims, f"{float(error):.2f} of the largest pressure from Hertz"
        (('x',), '0.01 of the largest pressure from Hertz')
        """
        where, across = f"{_SUBJECT}.profile", {"x": "y", "y": "x"}
        require(isinstance(axis, str) and axis in across, where, "axis", axis, "'x' or 'y'")
        place, fields = length(at, where, "at", positive=False), self.to_xarray()
        centres = fields[across[axis]].values
        reach = 0.5 * float(centres[1] - centres[0]) if centres.size > 1 else np.inf
        low, high = float(centres[0]) - reach, float(centres[-1]) + reach
        require(low <= place <= high, where, "at", at, f"within the window, {low:g} to {high:g} [m]")
        return fields.sel({across[axis]: place}, method="nearest")

    # ------------------------------------------------------------ fields below the surface

    def stress(self, points: ArrayLike, body: int = 1) -> FloatArray:
        """Stress at points of a body, by the contact and by everything in the body.

        Parameters
        ----------
        points : (n, 3) [m]
            x, y and depth z into that body, 0 or more.
        body : {1, 2}
            Lower or upper body, which must be elastic.

        Returns
        -------
        (n, 3, 3) [Pa]
            Symmetric tensors, tension positive. At depths of less than a quarter of a cell the stress by tractions is
            a mean over cells. The method sums over all cells: for planes and volumes `region` is faster.

        Raises
        ------
        SceneError
            Points above the surface, a rigid body.

        Examples
        --------
        >>> import eigencontact as ec
        >>> ball, steel = ec.make("sphere", radius="105 um"), ec.HalfSpace("210 GPa", 0.3)
        >>> stress = ec.solve_contact(ball, steel, load="0.65 N").stress([[0, 0, 2.9e-6]])
        >>> f"{(stress[0, 0, 0] - stress[0, 2, 2]) / 8.47e9:.3f} of the largest pressure"
        '0.620 of the largest pressure'
        """
        xx, yy, zz, yz, xz, xy = self._at_points(points, body, "stress")
        return np.ascontiguousarray(np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), -1, 0))

    def displacement(self, points: ArrayLike, body: int = 1) -> FloatArray:
        """Displacement of points of a body, including its surface, relative to distant points; see `stress`.

        Returns
        -------
        (n, 3) [m]
            z points into the body; in a periodic window, relative to the mean of the surface.

        Examples
        --------
        >>> import eigencontact as ec
        >>> ball, steel = ec.make("sphere", radius="105 um"), ec.HalfSpace("210 GPa", 0.3)
        >>> contact = ec.solve_contact(ball, steel, load="0.65 N", cells=63, size="16 um")
        >>> u = contact.displacement([[0, 0, 0]])
        >>> f"{u[0, 2] / contact.approach:.4f}"  # the ball pushes the middle of the surface down by the approach
        '1.0000'
        """
        return np.ascontiguousarray(self._at_points(points, body, "displacement").T)

    def region(self, **table: Any) -> xarray.Dataset:
        """Fields on a plane, a line, in a volume or at points, with the keys of a table ``[[stress]]``.

        Parameters
        ----------
        **table
            ``shape="plane", normal="y", depth_max="10 um"``; ``fields=["stress", "displacement"]``.

        Examples
        --------
        >>> import eigencontact as ec
        >>> ball, steel = ec.make("sphere", radius="105 um"), ec.HalfSpace("210 GPa", 0.3)
        >>> contact = ec.solve_contact(ball, steel, load="0.65 N")
        >>> section = contact.region(name="section", shape="plane", normal="y", depth_max="10 um", depth_cells=40)
        >>> f"{float(section.section_von_mises.max()) / 1e9:.2f} GPa"
        '5.25 GPa'
        """
        from eigencontact.results.join import dataset_of
        from eigencontact.results.stepfile import step_part

        info, record = self._look(table)
        return dataset_of([step_part(info, record, copied=False)])

    def _at_points(self, points: ArrayLike, body: int, quantity: str) -> FloatArray:
        where = f"{_SUBJECT}.{quantity}"
        require(is_whole(body) and body in (1, 2), where, "body", body, "1 or 2")
        require(self._bodies[body - 1] is not None, where, "body", body, "one that is elastic")
        at = field_points(points, where, half_space=True)
        require(len(at) > 0, where, "points", at.shape, "one point or more")
        table = {"name": "asked", "shape": "points", "points": at.tolist(), "body": body, "fields": [quantity]}
        _, record = self._look(table | {"quantities": []})
        return record.regions["asked"].fields[quantity]

    def _look(self, table: dict[str, Any]) -> tuple[Any, StepRecord]:
        from eigencontact.planning.provenance import run_info
        from eigencontact.postprocess.revisit import look, plan_of_region
        from eigencontact.results.stepfile import step_of

        if "step" in table:
            raise SceneError(f"{_SUBJECT}.region must be asked without a step (got {table['step']!r}): use at(step)")
        record, remembered = step_of(self.dataset, self._step)
        tables = tomllib.loads(str(self.dataset.attrs["scene"]))
        plan = plan_of_region(tables, table, installed_plugins())
        return run_info(plan), look(plan, record, "the contact", remembered)

    # ------------------------------------------------------------ looks

    def plot(self, field: str | None = None, **options: Any) -> Axes:
        """Draw a field on the surface; `eigencontact.plot` of `dataset` after this step.

        Parameters
        ----------
        field : str, optional
            ``"pressure"`` by default, ``"gap"``, ``"shear"``; the message about an unknown name lists all names.
        **options
            ``component``, ``zoom``, ``cmap`` and ``style`` of `eigencontact.plot`.

        Returns
        -------
        matplotlib.axes.Axes
            ``axes.figure.savefig("pressure.png")`` stores the figure.

        Raises
        ------
        SceneError
            An unknown field.

        Examples
        --------
        >>> import eigencontact as ec
        >>> ball, steel = ec.make("sphere", radius="105 um"), ec.HalfSpace("210 GPa", 0.3)
        >>> ec.solve_contact(ball, steel, load="0.65 N").plot("gap").get_xlabel()
        'x [µm]'
        """
        from eigencontact.postprocess.plot import plot

        return plot(self.dataset, field, step=self._place + 1, **options)

    def _field(self, name: str) -> FloatArray:
        return np.asarray(self.dataset[name].values[self._place])

    def _number(self, name: str) -> float:
        return float(self.dataset[name].values[self._place])

    @property
    def _place(self) -> int:
        """Position of the step along ``step``."""
        return (self.steps if self._step is None else self._step) - 1

    def _rows(self) -> list[tuple[str, str]]:
        declared = [Number(**table) for name, table in self.summary["numbers"].items() if name in self.dataset]
        values = {number.name: self._number(number.name) for number in declared}
        numbers = headline_numbers(declared, {name: value for name, value in values.items() if np.isfinite(value)})
        return [(number.words, number.text(values[number.name])) for number in numbers]

    def __repr__(self) -> str:
        rows = [f"{label} {value}" for label, value in self._rows() if label != "contact area"]
        step = [f"step {self._place + 1} of {self.steps}"] if self.steps > 1 else []
        return f"{_SUBJECT}({', '.join([*rows, *step])})"

    def _repr_html_(self) -> str:
        lower, upper = ("a rigid body" if body is None else repr(body) for body in self._bodies)
        ny, nx = self.dataset.sizes["y"], self.dataset.sizes["x"]
        rows = [("bodies", f"{lower} under {upper}"), *self._rows(), ("cells", f"{nx} x {ny}")]
        rows += [("fields", ", ".join(map(str, self.to_xarray())))]
        rows += [("step", f"{self._place + 1} of {self.steps}")] if self.steps > 1 else []
        notes = "; ".join(str(caution.get("words", caution)) for caution in self.summary["warnings"])
        return html_table("Contact", rows, notes)
