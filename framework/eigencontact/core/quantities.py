"""Units of the fields of a component or scene, and the vocabulary of quantities that blocks require and provide."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from math import inf
from typing import Annotated, Any

from eigencontact.core.units import LARGEST, parse_quantity, per_length

__all__ = [
    "QUANTITIES",
    "AlikeMark",
    "Angle",
    "DataFile",
    "Direction",
    "DirectionMark",
    "FileMark",
    "Force",
    "Length",
    "Lengths",
    "Moment",
    "Place",
    "PlaceMark",
    "Quantity",
    "Stress",
    "Unit",
    "loads_per_length",
    "unit_as_read",
    "unit_of",
]

#: Whether forces and moments are read per length, as a line contact has them.
_line: ContextVar[bool] = ContextVar("line", default=False)


@dataclass(frozen=True, slots=True)
class Unit:
    """SI unit of an annotated field; scene files may then write ``"105 um"`` and are checked for dimension.

    Examples
    --------
    >>> PerEnergy = Annotated[float, Unit("m^3/J", "a worn volume by work of friction")]
    >>> Length == Annotated[float, Unit("m", "a length")]
    True
    """

    symbol: str
    name: str

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Pydantic schema that converts text with units before it checks the number."""
        from pydantic_core import core_schema

        read = core_schema.no_info_before_validator_function(self._read, handler(source))
        return core_schema.no_info_after_validator_function(self._within_reach, read)

    def _read(self, value: Any) -> Any:
        """Value in SI units; of a force or a moment per length in a line contact."""
        if self.symbol not in ("N", "N*m"):
            return parse_quantity(value, self.symbol, self.name)
        units = {False: (self.symbol, self.name), True: (per_length(self.symbol), f"{self.name} per length")}
        line = _line.get()
        try:
            return parse_quantity(value, *units[line])
        except ValueError as problem:
            try:
                parse_quantity(value, *units[not line])
            except ValueError:
                raise problem from None
            hint = (
                f"a line contact (grid.length = 'infinite') is loaded by {units[True][1]} [{units[True][0]}]"
                if line
                else "only a line contact is loaded per length: set grid.length = 'infinite' for one"
            )
            raise ValueError(f"{units[line][1]} [{units[line][0]}]; {hint}") from None

    def _within_reach(self, value: Any) -> Any:
        """Refuse finite numbers whose products would leave the range of numbers; infinity is for the field to judge."""
        if isinstance(value, float) and LARGEST < abs(value) < inf:
            raise ValueError(f"of a size up to {LARGEST:g} [{unit_as_read(self.symbol)}]")
        return value


@contextmanager
def loads_per_length(*, line: bool) -> Iterator[None]:
    """Read forces and moments per length within, if `line`."""
    token = _line.set(line)
    try:
        yield
    finally:
        _line.reset(token)


def unit_as_read(unit: str) -> str:
    """Unit in which a quantity is read here: per length within `loads_per_length` of a line contact.

    Examples
    --------
    >>> with loads_per_length(line=True):
    ...     unit_as_read("N")
    'N/m'
    """
    return per_length(unit, line=_line.get())


#: Annotations for the fields of plugins: ``radius: Length``.
Length = Annotated[float, Unit("m", "a length")]
Stress = Annotated[float, Unit("Pa", "a stress")]
Force = Annotated[float, Unit("N", "a force")]
Moment = Annotated[float, Unit("N*m", "a moment")]
Angle = Annotated[float, Unit("rad", "an angle")]


class AlikeMark:
    """Mark of an annotated pair along x and y: a scene may have one value for both."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Pydantic schema that doubles a single value."""
        from pydantic_core import core_schema

        return core_schema.no_info_before_validator_function(self._pair, handler(source))

    @staticmethod
    def _pair(value: Any) -> Any:
        return [value, value] if isinstance(value, int | float | str) and not isinstance(value, bool) else value


#: Lengths along x and y [m]; ``spacing = "0.5 um"`` in a scene stands for two that are alike.
Lengths = Annotated[tuple[Length, Length], AlikeMark()]


class PlaceMark:
    """Mark of the field with the position of a component."""


#: Point (x, y, z) [m]. The one field with this annotation says where a thing is: another value moves the thing, and
#: changes nothing else about it.
Place = Annotated[tuple[Length, Length, Length], PlaceMark()]


@dataclass(frozen=True, slots=True)
class DirectionMark:
    """Mark of an annotated field with a direction in scene axes."""


#: Direction (x, y, z) in scene axes, of any length. A thing whose directions are all turned is the same thing, turned.
Direction = Annotated[tuple[float, float, float], DirectionMark()]


@dataclass(frozen=True, slots=True)
class FileMark:
    """Mark of an annotated field with the path of a data file."""


#: Annotation for the path of a data file, ``map: DataFile``, by any name, also ``DataFile | None``, in a tuple, or in a
#: dataclass that is the table of a field. A relative path counts from the folder of the scene; results of a file that
#: has changed are not continued. A name that begins with ``gallery:`` means a file beside the bundled scenes.
DataFile = Annotated[str, FileMark()]


@dataclass(frozen=True, slots=True)
class Quantity:
    """Named result with its unit and meaning; blocks require and provide quantities by name."""

    unit: str
    long_name: str
    converges: bool = (
        True  #: with the discretisation: neither a closed form, nor a number of a kind, nor of one increment
    )


#: Displacements in the gap of the contact; see `eigencontact.solvers.mean_surface`.
_AS_MEANS = "; by inhomogeneities the mean over each cell, along the tractions of a contact"

QUANTITIES: dict[str, Quantity] = {
    "separation": Quantity("m", "initial separation of the surfaces"),
    "pressure": Quantity("Pa", "contact pressure, positive in compression"),
    "reference_pressure": Quantity("Pa", "contact pressure in closed form", converges=False),
    "homogeneous_pressure": Quantity(
        "Pa",
        "contact pressure in closed form of homogeneous bodies of the deep material, under the same load",
        converges=False,
    ),
    "gap": Quantity("m", "gap between the deformed surfaces"),
    "displacement_z": Quantity("m", "normal surface displacement, both bodies summed"),
    "displacement_x": Quantity("m", "surface displacement of body 1 minus that of body 2 along x"),
    "displacement_y": Quantity("m", "surface displacement of body 1 minus that of body 2 along y"),
    "shear_x": Quantity("Pa", "shear traction on body 1 along x"),
    "shear_y": Quantity("Pa", "shear traction on body 1 along y"),
    "shear_bound": Quantity("Pa", "largest shear traction that the friction law allows"),
    "reference_shear_x": Quantity("Pa", "shear traction on body 1 along x in closed form", converges=False),
    "reference_shear_y": Quantity("Pa", "shear traction on body 1 along y in closed form", converges=False),
    "slip_x": Quantity("m", "slip of body 1 on body 2 in this step along x", converges=False),
    "slip_y": Quantity("m", "slip of body 1 on body 2 in this step along y", converges=False),
    "slip_distance": Quantity("m", "slip distance in contact so far"),
    "dissipated_energy_density": Quantity("J/m2", "work of friction per area so far"),
    "worn_depth": Quantity("m", "worn depth of both bodies together"),
    "worn_depth_1": Quantity("m", "worn depth of body 1"),
    "worn_depth_2": Quantity("m", "worn depth of body 2"),
    "exposed_material": Quantity(
        "1", "number of the exposed material in the step, 0 is the substrate", converges=False
    ),
    "contact_zone": Quantity("1", "0 out of contact, 1 slipping in this step, 2 sticking", converges=False),
    "residual_displacement_z": Quantity(
        "m", f"surface displacement by eigenstrain into the bodies, both summed{_AS_MEANS}"
    ),
    "residual_displacement_x": Quantity(
        "m", f"surface displacement by eigenstrain along x, body 1 minus body 2{_AS_MEANS}"
    ),
    "residual_displacement_y": Quantity(
        "m", f"surface displacement by eigenstrain along y, body 1 minus body 2{_AS_MEANS}"
    ),
    "displacement": Quantity("m", "displacement relative to distant points of the body"),
    "strain": Quantity("1", "total strain, expansion positive"),
    "stress": Quantity("Pa", "sub-surface stress, positive in tension"),
    "von_mises": Quantity("Pa", "von Mises stress"),
    "tresca": Quantity("Pa", "Tresca equivalent stress (largest difference of principal stresses)"),
    "hydrostatic": Quantity("Pa", "mean normal stress"),
    "principal": Quantity("Pa", "principal stresses, largest first"),
}


def unit_of(quantity: str) -> str:
    """SI unit of a result; ``"unknown"`` for a name outside the vocabulary.

    Examples
    --------
    >>> unit_of("pressure"), unit_of("weather")
    ('Pa', 'unknown')
    """
    return QUANTITIES[quantity].unit if quantity in QUANTITIES else "unknown"
