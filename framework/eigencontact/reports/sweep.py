"""Content of the report of a sweep: varied parameters, results of each variant, figures."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from eigencontact.core.numbers import Number
from eigencontact.errors import ResultsError
from eigencontact.results.atomic import DAMAGE, read_json, reason
from eigencontact.results.ownership import RESULTS, SUMMARY, is_ours

__all__ = ["Sweep", "content_of", "open_sweep"]

#: What a sweep leaves in its folder, and in that of a variant which failed (`eigencontact.sweeps`).
_SWEEP, _FAILED = "sweep.json", "failed.json"
_SECTIONS = {
    "top": "Summary",
    "scene": "Scene",
    "figures": "Figures",
    "numbers": "Numbers",
    "provenance": "Provenance",
    "references": "References",
}


@dataclass(frozen=True)
class Sweep:
    """A stored sweep: its folder, the values by key of the scene, ``folder`` and ``values`` of each variant."""

    folder: Path
    vary: dict[str, list[Any]]
    variants: list[dict[str, Any]]

    @cached_property
    def summaries(self) -> list[dict[str, Any]]:
        """Contents of the ``summary.json`` of every variant; empty for failed variants."""
        return [read_json(self.folder / variant["folder"] / SUMMARY) for variant in self.variants]

    @cached_property
    def failed(self) -> list[str]:
        """Reason of failure of each variant; empty for successful variants."""
        records = [read_json(self.folder / variant["folder"] / _FAILED) for variant in self.variants]
        return [
            "" if summary else str(record.get("failed", "it was not run"))
            for record, summary in zip(records, self.summaries, strict=True)
        ]

    @cached_property
    def first(self) -> dict[str, Any]:
        """Attributes of the results of the first successful variant; empty if all failed."""
        from eigencontact.results.stored import open_stored

        for variant, summary in zip(self.variants, self.summaries, strict=True):
            if summary:
                with open_stored(self.folder / variant["folder"] / RESULTS) as dataset:
                    return dict(dataset.attrs)
        return {}

    @property
    def scene_text(self) -> str:
        """Scene of that variant, as TOML."""
        return str(self.first.get("scene", ""))


def open_sweep(results: str | Path) -> Sweep | None:
    """Sweep in a folder; None for other folders.

    Raises
    ------
    ResultsError
        When the description of the sweep is damaged.
    """
    try:
        folder = Path(results)
        if not (folder / _SWEEP).is_file() or (folder / RESULTS).exists():
            return None
    except (OSError, TypeError, ValueError):  # what it is instead is said where a run is opened
        return None
    try:
        table = json.loads((folder / _SWEEP).read_text(encoding="utf-8"))
        variants = [{"folder": str(item["folder"]), "values": dict(item["values"])} for item in table["variants"]]
        return Sweep(folder, {str(key): list(values) for key, values in table["vary"].items()}, variants)
    except DAMAGE as problem:
        raise ResultsError(
            f"{folder / _SWEEP} must describe a sweep as this version writes it (got {type(problem).__name__}: "
            f"{reason(problem)}); move it away and run the sweep again, which reuses finished variants"
        ) from problem


def content_of(sweep: Sweep) -> dict[str, Any]:
    """Content of the template ``sweep.html``."""
    from eigencontact.reports.citations import as_bibtex, citations
    from eigencontact.reports.columns import Column, telling
    from eigencontact.reports.pictures import read_pictures

    declared = {name: table for summary in sweep.summaries for name, table in summary.get("numbers", {}).items()}
    columns = [
        Column(Number(**table), [_number(summary, name) for summary in sweep.summaries])
        for name, table in declared.items()
    ]
    columns = [column for column in columns if column.largest is not None]
    numbers = telling(columns)
    meanings = {column.name: column.meaning for column in columns if (sweep.folder / f"{column.name}.png").is_file()}
    against = ", ".join(sweep.vary)
    captions = {f"{name}.png": f"{words[:1].upper()}{words[1:]} against {against}." for name, words in meanings.items()}
    for path in filter(is_ours, sorted(sweep.folder.glob("*-profiles.png"))):
        subject = path.stem.removesuffix("-profiles").replace("_", " ")
        captions[path.name] = f"{subject[:1].upper()}{subject[1:]} along x, for {against}."
    references = dict.fromkeys(text for summary in sweep.summaries for text in summary.get("references", []))
    cited = citations(list(references))
    return {
        "title": str(sweep.first.get("title") or sweep.first.get("name") or sweep.folder.name),
        "sections": _SECTIONS,
        "made_by": sweep.first.get("eigencontact_version", ""),
        "sweep": sweep,
        "varying": [column for column in numbers if column.varies],
        "constant": [column for column in numbers if not column.varies],
        "pictures": read_pictures(sweep.folder, captions),
        "warnings": _warnings(sweep),
        "versions": json.loads(sweep.first.get("versions", "{}")),
        "citations": cited,
        "bibtex": as_bibtex(cited),
    }


def _number(summary: dict[str, Any], name: str) -> float | None:
    value = summary.get(name, summary.get("observed", {}).get(name))
    return None if value is None else float(value)


def _warnings(sweep: Sweep) -> list[tuple[str, list[str]]]:
    """Each warning, with the variants that have it."""
    folders: dict[str, list[str]] = {}
    for variant, summary in zip(sweep.variants, sweep.summaries, strict=True):
        for caution in summary.get("warnings", []):
            folders.setdefault(f"{caution['words']} ({caution['code']})", []).append(variant["folder"])
    return list(folders.items())
