"""Limits of the sizes in a scene by the memory of this machine, before any array is made.

The plan's price is exact enough but found late: it walks over axes, depths and cells. Here a number of things is
compared with what the memory holds of them at `BYTES_OF_ONE` each, less than any way to compute them takes.
"""

from __future__ import annotations

from math import floor, log10

from eigencontact.core.memory import machine_bytes
from eigencontact.errors import SceneError

__all__ = ["BYTES_OF_LAW_CELL", "BYTES_OF_ONE", "MEMORY_SHARE", "comfortable", "cut_down", "most", "refuse_more"]

#: The largest plan that is accepted, as a share of the machine's memory.
MEMORY_SHARE = 0.9
#: Of a cell of a window, a point of a region or a cell inside a body: a dozen numbers of 64 bits [bytes]. A contact
#: takes 116 for a cell of its window (README), six components of stress and what is read off them 104 for a point.
BYTES_OF_ONE = 96.0
#: Of a cell with a law of its own: the spectra that give the stress of every cell by the strain of every other. Plans
#: take 3400 (one contact, single precision) to 7200 (many regions, double) [bytes].
BYTES_OF_LAW_CELL = 3000.0


def most(item_bytes: float = BYTES_OF_ONE) -> int:
    """Number of cells or points, of `item_bytes`, that this machine's memory can hold."""
    return int(MEMORY_SHARE * machine_bytes() / item_bytes)


def comfortable(item_bytes: float = BYTES_OF_ONE) -> int:
    """Half of `most`, which leaves memory for other arrays; messages propose it."""
    return most(item_bytes) // 2


def cut_down(value: float, count: float, power: int = 1, item_bytes: float = BYTES_OF_ONE) -> float:
    """Value, rounded down to two digits, at which a count that grows with its `power` is `comfortable`.

    Examples
    --------
    >>> cut_down(1e9, 4.0 * comfortable(), power=2)
    500000000.0
    """
    fitting = value * (comfortable(item_bytes) / count) ** (1.0 / power) * (1.0 + 1e-12)
    unit = 10.0 ** (floor(log10(fitting)) - 1)
    return float(f"{floor(fitting / unit) * unit:.2g}")


def refuse_more(count: float, where: str, items: str, size: str, advice: str, item_bytes: float = BYTES_OF_ONE) -> None:
    """Refuse a size that cannot fit.

    Parameters
    ----------
    count : float
        Cells or points.
    where, items : str
        The field of the scene, and what it is a size of.
    size, advice : str
        Its value, and the nearest one that would do.
    item_bytes : float
        Least memory that one of them takes [bytes].

    Raises
    ------
    SceneError
        ``<where> must make at most <most> <what> ... (got <got>); <advice>``.
    """
    if count > most(item_bytes):
        raise SceneError(
            f"{where} must make at most {most(item_bytes):.2g} {items}, which fill the "
            f"{machine_bytes() / 1e9:.3g} GB of memory here (got {size}); {advice}"
        )
