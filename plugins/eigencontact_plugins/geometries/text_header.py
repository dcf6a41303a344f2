"""Units and distances of a measured surface from the header of a text file.

The reader accepts lines like ``Width: 64.0 µm``, ``# dx = 0.5 um``, ``Value units: nm``, ``"XY calibration",0.69,"um"``
or ``x [um], y [um], z [nm]``, with any comment sign before them, and ignores other lines.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from eigencontact.plugin import SceneError

__all__ = ["REMARK", "Header", "read_header"]

#: Function from the violated rule and the reason to the error.
Refusal = Callable[[str, str], SceneError]

#: Characters at the start of a comment line.
REMARK = re.compile(r"^\s*(?:[#%!]+|//)\s*")
#: Metres in units of length, in lower case.
_UNITS = {
    "m": 1.0, "meter": 1.0, "metre": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micron": 1e-6,
    "microns": 1e-6, "micrometer": 1e-6, "micrometre": 1e-6, "nm": 1e-9, "nanometer": 1e-9, "nanometre": 1e-9,
    "pm": 1e-12, "å": 1e-10, "angstrom": 1e-10, "in": 0.0254, "inch": 0.0254, "mil": 2.54e-5,
}  # fmt: skip
#: Keys in lower case, with blanks for other separators: those of Gwyddion, Nova, Keyence, and general ones.
_UNIT_KEYS = {
    "both": ("unit", "units"),
    "height": ("height", "height unit", "height units", "value unit", "value units", "z unit", "unit z", "unit data"),
    "lateral": ("lateral unit", "lateral units", "xy unit", "xy units", "x unit", "unit x", "y unit", "unit y"),
}
_LENGTH_KEYS = {
    "spacing": ("spacing", "pixel size", "pixel spacing", "step", "pitch", "xy calibration"),
    "dx": ("dx", "spacing x", "x spacing", "step x", "x step", "scale x", "x scale", "pixel size x", "x pixel size"),
    "dy": ("dy", "spacing y", "y spacing", "step y", "y step", "scale y", "y scale", "pixel size y", "y pixel size"),
    "size": ("size", "scan size"),
    "width": ("width", "x length", "length x", "x size", "size x"),
    "height": ("height", "y length", "length y", "y size", "size y"),
}
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_COLUMN = re.compile(r"\b([xyz])\s*[\[(/]\s*([^\])\s,;]+)")


@dataclass(frozen=True, kw_only=True, slots=True)
class Header:
    """Entries of a header; None for missing ones.

    Attributes
    ----------
    height_unit, lateral_unit : float or None
        Metres per unit of the heights; metres per unit of the lengths below and of coordinates.
    spacing, size : (float or None, float or None)
        Distance of points, and extent of the window, along x and y.
    """

    height_unit: float | None = None
    lateral_unit: float | None = None
    spacing: tuple[float | None, float | None] = (None, None)
    size: tuple[float | None, float | None] = (None, None)


def read_header(lines: Iterable[str], refusal: Refusal) -> Header:
    """Read the lines of a header.

    Raises
    ------
    SceneError
        A unit is not a unit of length.
    """
    lines = list(lines)
    entries = list(_entries(lines))
    duplicates = [key for key in _LENGTH_KEYS["width"] if sum(key == name for name, _ in entries) > 1]
    if duplicates:
        raise refusal("a text file with one matrix", f"its headers give {duplicates[0]!r} twice; keep one channel")
    columns = {name: unit for line in lines for name, unit in _COLUMN.findall(line.lower())}

    def unit(names: Iterable[str], column: str) -> float | None:
        texts = [text for name in names for key, text in entries if key in _UNIT_KEYS[name] and not _NUMBER.match(text)]
        return _metres(texts[0] if texts else columns.get(column), refusal)

    lengths = {name: values for name, keys in _LENGTH_KEYS.items() for values in _lengths(entries, keys, refusal)}
    # A length without a unit has the unit of the others.
    usual = unit(("lateral", "both"), "x") or next((file_unit for _, file_unit in lengths.values() if file_unit), None)

    def pair(common: str, x: str, y: str) -> tuple[float | None, float | None]:
        first, last = (lengths.get(name, lengths.get(common)) for name in (x, y))
        return (
            None if first is None else first[0][0] * (1.0 if first[1] is None or usual is None else first[1] / usual),
            None if last is None else last[0][-1] * (1.0 if last[1] is None or usual is None else last[1] / usual),
        )

    return Header(
        height_unit=unit(("height", "both"), "z"),
        lateral_unit=usual,
        spacing=pair("spacing", "dx", "dy"),
        size=pair("size", "width", "height"),
    )


def _entries(lines: list[str]) -> Iterator[tuple[str, str]]:
    """Keys with their values as text."""
    for line in lines:
        key, *texts = re.split(r"[:=,;\t]", REMARK.sub("", line).replace('"', ""), maxsplit=1)
        if texts:
            bracket = re.search(r"[\[(]([^\])]+)[\])]", key)
            text = texts[0] if "." in texts[0] else re.sub(r"(\d),(\d)", r"\1.\2", texts[0])
            text = " ".join(re.split(r"[,;\s]+", text.strip("=: \t\r\n")))
            name = " ".join(re.split(r"[\s_-]+", re.sub(r"[\[(].*", "", key).strip().lower()))
            yield name, f"{text} {bracket[1]}" if bracket else text


def _lengths(
    entries: list[tuple[str, str]], keys: tuple[str, ...], refusal: Refusal
) -> Iterator[tuple[list[float], float | None]]:
    """Values of keys, one for both directions or two; and their values in metres, if they have a unit."""
    for key, text in entries:
        numbers = [float(number) for number in _NUMBER.findall(text)]
        if key in keys and numbers:
            units = [word for word in re.findall(r"[^\W\d_]+", _NUMBER.sub(" ", text)) if word not in ("x", "by")]
            yield numbers, _metres(units[0] if units else None, refusal)


def _metres(unit: str | None, refusal: Refusal) -> float | None:
    if unit is None:
        return None
    metres = _UNITS.get(unit.strip("[]() ").lower())
    if metres is None:
        rule = "a text file whose header gives lengths in m, mm, um, nm, pm, angstrom or inch"
        raise refusal(rule, f"it says {unit.strip()!r}")
    return metres
