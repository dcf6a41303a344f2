"""Text with units to SI numbers."""

from __future__ import annotations

from functools import cache
from typing import Any

from eigencontact.errors import nearest

__all__ = ["parse_quantity", "readable"]


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(cache_folder=None)


def parse_quantity(value: Any, symbol: str, name: str) -> Any:
    """Return `value` in SI units; numbers are taken to be SI already.

    Parameters
    ----------
    value : float or str
        ``1.05e-4`` or ``"105 um"``.
    symbol, name : str
        SI unit and name of the quantity wanted, for the check and the message: ``"m"``, ``"a length"``.

    Raises
    ------
    ValueError
        The rule that the value breaks; the caller adds where it stands.

    Examples
    --------
    >>> parse_quantity("210 GPa", "Pa", "a stress")
    210000000000.0
    """
    if not isinstance(value, str):
        return value
    import pint

    rule = f"{name} [{symbol}]"
    try:
        quantity = _registry().Quantity(value)
    except pint.UndefinedUnitError as problem:
        raise ValueError(f"{rule}; {_unknown_unit(problem, symbol)}") from problem
    except Exception as problem:  # pint raises many kinds for text that is no quantity
        raise ValueError(f'{rule}, as a number or as text like "{_EXAMPLES.get(symbol, "1 " + symbol)}"') from problem
    if quantity.unitless and symbol != "rad":
        raise ValueError(f'{rule}: give a plain number or a unit, like "{_EXAMPLES.get(symbol, "1 " + symbol)}"')
    try:
        number = float(quantity.to(symbol).magnitude)
    except (pint.DimensionalityError, pint.OffsetUnitCalculusError) as problem:
        raise ValueError(f"{rule}; {value!r} has the dimension {quantity.dimensionality}") from problem
    # Conversion factors carry rounding errors; "105 um" is 1.05e-4 to the last bit. Degrees have no short decimals.
    return number if symbol == "rad" else float(f"{number:.15g}")


def _unknown_unit(problem: Any, symbol: str) -> str:
    """Name the unit that is not known and the nearest that would fit; upper and lower case differ in meaning."""
    names = problem.unit_names
    name = names if isinstance(names, str) else ", ".join(names)
    prefixes = ("", "n", "u", "m", "k", "M", "G")
    known = [prefix + unit for unit in _SPELLINGS.get(symbol, (symbol,)) for prefix in prefixes]
    alike = next((unit for unit in known if unit.lower() == name.lower()), None)
    hint = f"; did you mean {alike!r}?" if alike else nearest(name, known)
    return f"there is no unit {name!r}{hint or f', write it like {_EXAMPLES.get(symbol, symbol)!r}'}"


#: Units that a misspelt one is compared with.
_SPELLINGS = {"m": ("m",), "Pa": ("Pa",), "N": ("N",), "rad": ("rad", "deg"), "N*m": ("N*m", "N*mm")}
_EXAMPLES = {"m": "105 um", "Pa": "210 GPa", "N": "0.65 N", "rad": "0.1 deg", "N*m": "2 N*mm"}


def readable(value: float, unit: str) -> str:
    """Return a number with an engineering prefix.

    Examples
    --------
    >>> readable(6.05e-6, "m"), readable(8.47e9, "Pa"), readable(1.15e-10, "m^2")
    ('6.05 um', '8.47 GPa', '115 um^2')
    """
    power = 2 if unit.endswith("^2") else 1
    for exponent, prefix in ((9, "G"), (6, "M"), (3, "k"), (0, ""), (-3, "m"), (-6, "u"), (-9, "n"), (-12, "p")):
        scaled = value / 10.0 ** (exponent * power)
        if abs(scaled) >= 1.0 and not (unit.startswith("m") and exponent > 3):
            return f"{scaled:.5g} {prefix}{unit}"
    return f"{value:.4g} {unit}"
