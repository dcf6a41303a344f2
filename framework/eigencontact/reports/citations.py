"""Sources to cite: their DOIs as links, and entries of BibTeX."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["Citation", "as_bibtex", "citations"]

_DOI = re.compile(r"doi:\s*(10\.\d{4,9}/\S+)", re.IGNORECASE)
_YEARS = (re.compile(r"\((1[6-9]\d\d|20\d\d)\)"), re.compile(r"\b(1[6-9]\d\d|20\d\d)\b"))
_NAME = re.compile(r"\b(?![a-z])[^\W\d_]{3,}")
_TEX = {"&": r"\&", "%": r"\%", "#": r"\#", "_": r"\_", "$": r"\$", "{": r"\{", "}": r"\}", "~": r"\~{}", "^": r"\^{}"}


@dataclass(frozen=True)
class Citation:
    """Source: its text, and the text in three parts; `doi` is empty for a source without a DOI."""

    text: str
    before: str
    doi: str
    after: str


def citations(references: Sequence[str]) -> list[Citation]:
    """Sources with their DOIs.

    Examples
    --------
    >>> citations(["H. Hertz 1882, doi:10.1515/crll.1882.92.156."])[0].doi
    '10.1515/crll.1882.92.156'
    """
    sources = []
    for text in references:
        match = _DOI.search(text)
        doi = "" if match is None else _closed(match[1])
        start, end = (len(text), len(text)) if match is None else (match.start(), match.start(1) + len(doi))
        sources.append(Citation(text, text[:start], doi, text[end:]))
    return sources


def _closed(doi: str) -> str:
    """DOI without a trailing point, comma or unmatched bracket."""
    while doi and (doi[-1] in ".,;:" or (doi[-1] == ")" and doi.count(")") > doi.count("("))):
        doi = doi[:-1]
    return doi


def as_bibtex(sources: Sequence[Citation]) -> str:
    """BibTeX entries of kind ``misc``: text, year and DOI of the source.

    What has neither year nor DOI is no publication and has no entry.

    Examples
    --------
    >>> print(as_bibtex(citations(["A. E. H. Love 1929, Phil. Trans. R. Soc. A 228, doi:10.1098/rsta.1929.0009"])))
    @misc{love1929,
      note = {A. E. H. Love 1929, Phil. Trans. R. Soc. A 228},
      year = {1929},
      doi = {10.1098/rsta.1929.0009},
    }
    """
    entries, uses = [], dict[str, int]()
    for source in sources:
        plain = source.before + source.after
        year = next((match for pattern in _YEARS if (match := pattern.search(plain))), None)
        if year is None and not source.doi:
            continue
        name = _NAME.search(source.text)
        key = f"{name[0].lower() if name else 'source'}{year[1] if year else ''}"
        uses[key] = uses.get(key, 0) + 1
        if uses[key] > 1:
            key += chr(ord("a") + uses[key] - 1)
        words = f"{source.before.rstrip(' ,;(')}{source.after}".strip()
        tex = "".join(_TEX.get(character, character) for character in words)
        lines = [f"@misc{{{key},", f"  note = {{{tex}}},"]
        lines += [f"  year = {{{year[1]}}},"] if year else []
        lines += [f"  doi = {{{source.doi}}},"] if source.doi else []
        entries.append("\n".join([*lines, "}"]))
    return "\n\n".join(entries)
