"""Text with units to SI numbers."""

from __future__ import annotations

from functools import cache
from typing import Any

__all__ = ["parse_quantity"]


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
    except Exception as problem:  # pint raises many kinds for text that is no quantity
        raise ValueError(f'{rule}, as a number or as text like "{_EXAMPLES.get(symbol, "1 " + symbol)}"') from problem
    if quantity.unitless and symbol != "rad":
        raise ValueError(f'{rule}: give a plain number or a unit, like "{_EXAMPLES.get(symbol, "1 " + symbol)}"')
    try:
        return float(quantity.to(symbol).magnitude)
    except (pint.DimensionalityError, pint.OffsetUnitCalculusError) as problem:
        raise ValueError(f"{rule}; {value!r} has the dimension {quantity.dimensionality}") from problem


_EXAMPLES = {"m": "105 um", "Pa": "210 GPa", "N": "0.65 N", "rad": "0.1 deg", "N*m": "2 N*mm"}
