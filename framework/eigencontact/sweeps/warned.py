"""Warnings of the variants of a sweep, each code once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["codes_of", "warnings_in_words"]


def codes_of(summary: Mapping[str, Any]) -> str:
    """Codes of the warnings of a variant as one text, each once; empty without any.

    Examples
    --------
    >>> codes_of({"warnings": [{"code": "slow-place", "words": "a place"}]})
    'slow-place'
    """
    return ", ".join(dict.fromkeys(caution["code"] for caution in summary.get("warnings", ())))


def warnings_in_words(warnings: Mapping[str, Sequence[Mapping[str, Any]]], total: int) -> list[str]:
    """One line for each code: how many variants warn, and the words of the first, which name the number concerned.

    Parameters
    ----------
    warnings : mapping of str to sequence of mapping
        Warnings as in ``summary.json`` (``code``, ``words``, ``error``) by label of the variant.
    total : int
        Number of variants.

    Examples
    --------
    >>> one = {"code": "slow-place", "words": "a place lags", "error": 0.1}
    >>> warnings_in_words({"a": [one], "b": [one]}, 3)
    ['2 of 3 variants warn: slow-place: a place lags']
    """
    by_code: dict[str, list[str]] = {}
    for cautions in warnings.values():
        for code, sentences in {caution["code"]: caution["words"] for caution in reversed(cautions)}.items():
            by_code.setdefault(code, []).append(sentences)
    return [f"{len(sentences)} of {total} variants {'warns' if len(sentences) == 1 else 'warn'}: {code}: {sentences[0]}"
            for code, sentences in by_code.items()]  # fmt: skip
