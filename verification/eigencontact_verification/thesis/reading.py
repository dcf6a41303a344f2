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


def index_of(given: Mapping[str, Any]) -> Index:
    """Index of the tables of its file.

    Raises
    ------
    SceneError
        A faulty key, with its rule.
    """
    entries = {kind: [_entry(one) for one in given.get(kind, [])] for kind in ("figure", "table")}
    return Index(**entries, erratum=[_made(Erratum, one, "erratum") for one in given.get("erratum", [])])


def _entry(given: Mapping[str, Any]) -> Entry:
    claims = []
    for one in given.get("claim", []):
        rule = one.get("rule")
        if rule is not None and "formula" not in rule:
            rule = {"study": given.get("study", ""), **rule}
        made = None if rule is None else _made(Rule, rule, f"{given.get('number')} rule")
        claims.append(_made(Claim, {**one, "rule": made}, f"{given.get('number')} claim"))
    return _made(Entry, {**given, "claim": claims}, str(given.get("number")))


def _made(kind: type[T], given: Mapping[str, Any], where: str) -> T:
    known = [one.name for one in fields(kind)]  # type: ignore[arg-type]
    strange = next((key for key in given if key not in known), None)
    if strange is not None:
        keys = ", ".join(known)
        raise SceneError(f"thesis: {where} must have the keys {keys} (got {strange!r}){nearest(strange, known)}")
    try:
        return kind(**given)
    except TypeError as problem:
        raise SceneError(f"thesis: {where} must be complete (got {given!r}): {problem}") from None
