"""Text with units to SI numbers."""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Any

from eigencontact.errors import nearest

__all__ = [
    "LARGEST", "NUMBER", "SMALLEST", "number_and_unit", "parse_quantity", "per_length", "quantity_text", "readable",
    "time_in_words",
]  # fmt: skip

#: Smallest size in SI units: products of ten sizes, and of their inverses, stay within the range of numbers.
SMALLEST = 1e-30
#: Largest size in SI units, for the same reason.
LARGEST = 1e30
#: A number as text: a point before decimals, no separators, no leading zeros, nothing to compute.
NUMBER = re.compile(r"[+-]?(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_NAME = r"[^\W\d_][^\W\d]*"
_FACTOR = rf"(?:{_NAME}|°)(?:(?:\^|\*\*)[+-]?[1-9]|[²³])?"
_PRODUCT = rf"{_FACTOR}(?:(?:\s*[*·]\s*|\s+){_FACTOR})*"
#: A unit as text: names, each with a power of one digit, multiplied or divided, in the end by a product in brackets;
#: ``/K`` and ``1/K`` alike.
_UNIT = re.compile(rf"(?:1?\s*/\s*)?{_FACTOR}(?:(?:\s*[*/·]\s*|\s+){_FACTOR})*(?:\s*/\s*\({_PRODUCT}\))?")


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(cache_folder=None)


def parse_quantity(value: Any, symbol: str, name: str) -> Any:
    """Return `value` in SI units; plain numbers are in SI.

    Text is a number and a unit, ``"105 um"``, and nothing else: no arithmetic, no decimal commas, no separators
    between digits, no leading zeros, no uncertainties. An angle may be a number alone, in radians.

    Parameters
    ----------
    value : float, str or quantity
        ``1.05e-4`` or ``"105 um"``, or a number with a unit of a library such as pint.
    symbol, name : str
        SI unit and name of the quantity wanted, for the check and the message: ``"m"``, ``"a length"``.

    Raises
    ------
    ValueError
        The rule that the value breaks; the caller adds where it stands.

    Examples
    --------
    >>> parse_quantity("210 GPa", "Pa", "a stress"), parse_quantity("2 N*mm", "N*m", "a moment")
    (210000000000.0, 0.002)
    """
    if not isinstance(value, str):
        if isinstance(value, _Dimensionless) and symbol not in ("1", "rad"):
            raise ValueError(f'{name} [{symbol}]: give a unit, like "{_EXAMPLES.get(symbol, "1 " + symbol)}"')
        carried = number_and_unit(value)
        return value if carried is None else _magnitude(*carried, symbol, name)
    if symbol == "m" and value.strip() == "infinite":
        return math.inf  # for the field to judge
    rule, example = f"{name} [{symbol}]", _EXAMPLES.get(symbol, "1 " + symbol)
    text = value.strip()
    head = NUMBER.match(text)
    unit = "" if head is None else text[head.end() :].strip()
    if head is None or (unit and not _UNIT.fullmatch(unit)):
        raise ValueError(
            f'{rule}, as a number or as text like "{example}" (a point before decimals, nothing between digits, '
            "nothing to compute)"
        )
    if not unit and symbol != "rad":
        raise ValueError(f'{rule}: give a plain number or a unit, like "{example}"')
    number, factor = float(head[0]), _factors(symbol).get(unit)
    converted = number * factor if factor is not None else _converted(number, unit, value, symbol, rule)
    if not math.isfinite(converted) or (converted == 0.0 and re.search("[1-9]", head[0].lower().partition("e")[0])):
        raise ValueError(f"{rule} that a number of 64 bits can hold")
    # Conversion factors carry rounding errors; "105 um" is 1.05e-4 to the last bit. Degrees have no short decimals.
    return converted if symbol == "rad" else float(f"{converted:.15g}")


def number_and_unit(value: Any) -> tuple[Any, str] | None:
    """Number or array, and unit, of an object with a unit; unit None for plain numbers.

    Quantities of pint, astropy and unyt carry a unit, and so does a DataArray with the attribute ``units``. A quantity
    without dimension has the unit ``""``.

    Examples
    --------
    >>> number_and_unit(1.0), number_and_unit(_registry().Quantity(3, "um"))
    (None, (3, 'µm'))
    """
    if isinstance(value, float | int | str | bytes | list | tuple | dict):
        return None
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        if getattr(value, "dimensionless", False):
            return value.to("dimensionless").magnitude, ""
        return value.magnitude, format(value.units, "~C")
    unit = getattr(value, "unit", getattr(value, "units", None))
    if unit is not None and hasattr(value, "value"):
        return value.value, str(unit).replace("dimensionless", "")
    attributes = getattr(value, "attrs", None)
    if isinstance(attributes, dict) and attributes.get("units") and hasattr(value, "values"):
        return value.values, "" if attributes["units"] in ("1", "-") else str(attributes["units"])
    return None


class _Dimensionless(float):
    """Number of a dimensionless quantity: no length, force or stress."""


def quantity_text(number: float, unit: str) -> float | str:
    """Number with its unit as in a scene."""
    return f"{float(number)!r} {unit}" if unit else _Dimensionless(number)


def _magnitude(number: Any, unit: str, symbol: str, name: str) -> Any:
    """Number, or array, in SI units."""
    if not getattr(number, "shape", ()):
        return parse_quantity(quantity_text(number, unit), symbol, name)
    if not unit:
        return number * parse_quantity(_Dimensionless(1.0), symbol, name)
    return number * parse_quantity(f"1 {unit}", symbol, name)


def _converted(number: float, unit: str, text: str, symbol: str, rule: str) -> float:
    """Convert by pint, which receives only the unit; the import of pint takes a third of a second."""
    import pint

    try:
        unit_quantity = _registry().Quantity(1.0, f"1{unit}" if unit.startswith("/") else unit)
    except pint.UndefinedUnitError as problem:
        raise ValueError(f"{rule}; {_unknown_unit(problem, symbol)}") from problem
    except Exception as problem:  # pint raises many kinds for text that is no unit
        raise ValueError(f'{rule}, as a number or as text like "{_EXAMPLES.get(symbol, "1 " + symbol)}"') from problem
    try:
        return float((number * unit_quantity).to(symbol).magnitude)
    except (pint.DimensionalityError, pint.OffsetUnitCalculusError) as problem:
        raise ValueError(f"{rule}; {text!r} has the dimension {unit_quantity.dimensionality}") from problem


#: Powers of ten of the prefixes that are read without pint.
_PREFIXES = {"": 0, "p": -12, "n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "k": 3, "M": 6, "G": 9}


@cache
def _factors(symbol: str) -> dict[str, float]:
    """Factors to SI of the units that need no pint; the products round as pint's do."""
    if symbol == "N*m":
        return {
            f"{force}N{times}{length}m": float(f"1e{_PREFIXES[force]}") * float(f"1e{_PREFIXES[length]}")
            for force in _PREFIXES
            for length in _PREFIXES
            for times in ("*", " ")
        }
    if symbol == "rad":
        return {"": 1.0, "rad": 1.0, "mrad": 1e-3, "urad": 1e-6, "deg": math.pi / 180.0}
    if symbol == "N/m":
        return {
            f"{force}N/{length}m": float(f"1e{_PREFIXES[force] - _PREFIXES[length]}")
            for force in _PREFIXES
            for length in _PREFIXES
        }
    if symbol in ("m", "Pa", "N", "B"):
        return {prefix + symbol: float(f"1e{power}") for prefix, power in _PREFIXES.items()}
    return {}


def _unknown_unit(problem: Any, symbol: str) -> str:
    """Message with the unknown unit and the nearest fitting unit; upper and lower case differ in meaning."""
    names = problem.unit_names
    name = names if isinstance(names, str) else ", ".join(names)
    prefixes = ("", "n", "u", "m", "k", "M", "G")
    spellings = [prefix + unit for unit in _SPELLINGS.get(symbol, (symbol,)) for prefix in prefixes]
    alike = next((unit for unit in spellings if unit.lower() == name.lower()), None)
    hint = f"; did you mean {alike!r}?" if alike else nearest(name, spellings)
    return f"there is no unit {name!r}{hint or f', write it like {_EXAMPLES.get(symbol, symbol)!r}'}"


#: Units that a misspelt one is compared with.
_SPELLINGS = {
    "m": ("m",),
    "Pa": ("Pa",),
    "N": ("N",),
    "rad": ("rad", "deg"),
    "N*m": ("N*m", "N*mm"),
    "N/m": ("N/m", "N/mm"),
    "B": ("B",),
}
_EXAMPLES = {
    "m": "105 um", "Pa": "210 GPa", "N": "0.65 N", "rad": "0.1 deg", "N*m": "2 N*mm", "N/m": "400 N/mm", "B": "2 GB",
    "N*m/m": "2 N*mm/mm",
}  # fmt: skip
#: Units of what a line contact has per metre of its length.
_PER_LENGTH = {
    "N": "N/m", "N*m": "N*m/m", "N m": "N m/m", "J": "J/m", "m2": "m", "m^2": "m", "m3": "m2", "m^3": "m^2",
}  # fmt: skip


def per_length(unit: str, *, line: bool = True) -> str:
    """Unit in a line contact of a quantity with this unit in three dimensions; pressures and lengths do not change.

    Where `line` is false nothing is counted per length, and every unit is kept.

    Examples
    --------
    >>> per_length("N"), per_length("m3"), per_length("Pa")
    ('N/m', 'm2', 'Pa')
    """
    return _PER_LENGTH.get(unit, unit) if line else unit


def readable(value: float, unit: str) -> str:
    """Return a number with an engineering prefix of the first factor of its unit.

    Examples
    --------
    >>> readable(6.05e-6, "m"), readable(8.47e9, "Pa"), readable(1.15e-10, "m^2")
    ('6.05 um', '8.47 GPa', '115 um^2')
    >>> readable(2e6, "J/m^2"), readable(5e-9, "m^3/J"), readable(1e-13, "1/Pa")
    ('2 MJ/m^2', '5 mm^3/J', '1e-13 1/Pa')
    >>> readable(math.inf, "m")
    'infinite'
    """
    if math.isinf(value):
        return "infinite" if value > 0 else "minus infinite"
    first = unit.split("/", maxsplit=1)[0]
    if first == "1":
        return f"{value:.4g} {unit}"
    power = int(first[-1]) if "^" in first else 1
    for exponent, prefix in ((9, "G"), (6, "M"), (3, "k"), (0, ""), (-3, "m"), (-6, "u"), (-9, "n"), (-12, "p")):
        scaled = value / 10.0 ** (exponent * power)
        if abs(scaled) >= 1.0 and not (unit.startswith("m") and exponent > 3):
            return f"{scaled:.5g} {prefix}{unit}"
    return f"{value:.4g} {unit}"


def time_in_words(seconds: float) -> str:
    """Return a duration with two digits or in whole seconds and minutes, never with an exponent.

    Examples
    --------
    >>> [time_in_words(seconds) for seconds in (0.2071, 45.3, 99.7, 200.0, 3600.0, 7500.0)]
    ['0.21 s', '45 s', '100 s', '3 min 20 s', '60 min', '2 h 5 min']
    """
    if seconds < 100.0:
        return f"{float(f'{seconds:.2g}'):g} s"
    minutes = round(seconds / 60)
    if minutes < 10:
        return f"{int(seconds // 60)} min {int(seconds % 60)} s"
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60} min"
