"""The bundled index of the thesis, read and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar

from eigencontact.errors import SceneError, nearest
from eigencontact_verification.reporting.bundled import read_toml
from eigencontact_verification.thesis.entries import Claim, Entry, Erratum, Index, Rule

__all__ = ["index_of", "thesis_index"]

T = TypeVar("T")


@cache
def thesis_index() -> Index:
    """Index of the thesis."""
    text = (files("eigencontact_verification") / "thesis" / "index.toml").read_text(encoding="utf-8")
    return index_of(read_toml(Path("index.toml"), text, "index of the thesis"))


def index_of(tables: Mapping[str, Any]) -> Index:
    """Index of the tables of its file.

    Raises
    ------
    SceneError
        A faulty key, with its rule.
    """
    entries = {kind: [_entry(entry) for entry in tables.get(kind, [])] for kind in ("figure", "table")}
    return Index(**entries, erratum=[_record(Erratum, entry, "erratum") for entry in tables.get("erratum", [])])


def _entry(table: Mapping[str, Any]) -> Entry:
    claims = []
    for claim in table.get("claim", []):
        rule = claim.get("rule")
        if rule is not None and "formula" not in rule:
            rule = {"study": table.get("study", ""), **rule}
        rule_record = None if rule is None else _record(Rule, rule, f"{table.get('number')} rule")
        claims.append(_record(Claim, {**claim, "rule": rule_record}, f"{table.get('number')} claim"))
    return _record(Entry, {**table, "claim": claims}, str(table.get("number")))


def _record(kind: type[T], table: Mapping[str, Any], where: str) -> T:
    names = [item.name for item in fields(kind)]  # type: ignore[arg-type]
    strange = next((key for key in table if key not in names), None)
    if strange is not None:
        keys = ", ".join(names)
        raise SceneError(f"thesis: {where} must have the keys {keys} (got {strange!r}){nearest(strange, names)}")
    try:
        return kind(**table)
    except TypeError as problem:
        raise SceneError(f"thesis: {where} must be complete (got {table!r}): {problem}") from None
