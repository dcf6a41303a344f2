"""Keys of the file of a study, and the refusal of all others."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from eigencontact.errors import SceneError, nearest, shown

__all__ = ["FORM", "as_tables", "checked", "one_of"]

#: Keys of each table, and what they mean; `eigencontact study --form` prints them.
FORM: dict[str, dict[str, str]] = {
    "study": {
        "title": "one line: what is varied and what is looked at",
        "trend": "what is known of the trend, and of its limits",
        "source": "where the trend was published: tables [[source]], or one",
        "scene": 'a bundled scene, a file beside the study, or the tables of a scene; a text that begins with "=" is a '
        "formula of constants and parameters",
        "constants": "numbers by name, or formulas of those before them",
        "vary": "values by parameter; tables [[vary]] are one product after the other",
        "set": "keys of the scene, dotted, and what is put there: formulas too",
        "when": "changes of the scene for some variants: tables [[when]]",
        "label": 'text of a variant with its parameters in braces: "μ = {friction:g}"',
        "read": "numbers read off each variant: a formula by name, or a table",
        "coarse": "what differs in a first look",
        "figure": "size and legend of the figure",
        "panel": "panels of the figure: tables [[panel]]",
        "check": "what the trend must show: tables [[check]]",
    },
    "source": {
        "authors": "who wrote it",
        "year": "when",
        "title": "of the work",
        "journal": "journal or publisher, volume and pages",
        "figure": "figures or tables that are computed anew",
        "doi": "digital object identifier",
        "case": "number in a catalogue of cases",
        "form": "a closed form, in words, where nothing was published",
    },
    "vary": {
        "values": "array of values",
        "from": "first value, with `to` and `count`",
        "to": "last value",
        "count": "number of values",
        "log": "whether the values are spaced by one ratio",
        "key": "dotted key of the scene that takes the values; a name with a dot is a key itself",
        "label": "name of the parameter in tables",
    },
    "when": {
        "if": "formula of the parameters",
        "set": "keys of the scene, dotted, and what is put there",
        "without": "keys of the scene that are left out",
    },
    "read": {
        "is": "formula",
        "as": "name of the number in other formulas",
        "if": "formula of the parameters: which variants have it",
    },
    "coarse": {
        "constants": "constants with other values",
        "vary": "parameters with fewer values",
        "set": "keys of the scene, dotted, and what is put there",
    },
    "figure": {
        "size": "width and height [inch]",
        "columns": "panels side by side, or a parameter: one for each of its values",
        "legend": "right, above or none",
    },
    "panel": {
        "title": "above the panel; parameters in braces where `each` is given",
        "each": 'a parameter: one panel for each of its values; "variant": one for each variant',
        "only": "formula: which variants are drawn",
        "curve": "curves: tables [[panel.curve]]",
        "map": "a field drawn in colours instead of curves",
        "x-label": "of the axis",
        "y-label": "of the axis",
        "x-limits": "from, to",
        "y-limits": "from, to; the larger first turns the axis over",
        "x-scale": "linear or log",
        "levels": "heights of horizontal lines",
    },
    "curve": {
        "x": "formula or parameter",
        "y": "formula: one number, and a curve is drawn through the variants, or several, and each variant has a curve",
        "by": "parameter: a colour, and of single numbers a curve, for each of its values",
        "dash-by": "parameter: a style for each of its values",
        "style": 'line and marks, as "o-", or several in turn',
        "colour": "number of the colour, or black, grey",
        "label": "text of the legend with parameters in braces",
        "only": "formula: which variants are drawn",
        "once": "true: drawn once, from formulas without results, as a closed form is",
    },
    "map": {
        "x": "formula of the places across",
        "y": "formula of the places down",
        "z": "formula of the field",
        "label": "of the colours",
        "signed": "true: colours on both sides of zero",
        "line": "height of a line, as of an interface",
        "only": "formula: where the field exists",
    },
    "check": {
        "number": "a number that is read, or a formula of such and of parameters",
        "is": "rising, falling, or the two bounds that it stays within",
        "along": "parameter along which it rises or falls",
        "only": "formula: which variants",
    },
}


def checked(
    table: Any, kind: str, place: str, *, needs: Sequence[str] = (), form: Mapping[str, Mapping[str, str]] = FORM
) -> Mapping[str, Any]:
    """Return a table of a kind; `form` has the kinds and their keys.

    Raises
    ------
    SceneError
        No table, a key that is unknown, or one that is missing.
    """
    keys = form[kind]
    if not isinstance(table, Mapping):
        raise SceneError(f"{place} must be a table of {', '.join(keys)} (got {shown(table)})")
    for key in table:
        if key not in keys:
            raise SceneError(f"unknown key {key!r} in {place}; known: {', '.join(keys)}{nearest(str(key), keys)}")
    missing = [key for key in needs if key not in table]
    if missing:
        raise SceneError(f"{place} must have {missing[0]}: {keys[missing[0]]}")
    return table


def as_tables(content: Any) -> list[Any]:
    """Tables of an array, or the one table."""
    return list(content) if isinstance(content, list) else [content]


def one_of(value: Any, choices: Collection[str], place: str, *, rule: str = "") -> str:
    """Return a value that is one of several.

    Raises
    ------
    SceneError
        Another value, with the nearest choice.
    """
    if value not in choices:
        rule = rule or f"one of {', '.join(choices)}"
        raise SceneError(f"{place} must be {rule} (got {shown(value)}){nearest(str(value), choices)}")
    return str(value)
