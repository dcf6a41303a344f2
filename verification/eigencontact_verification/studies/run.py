"""Runs of a study by the machinery of sweeps: finished variants are kept, a failure stops no other variant."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from eigencontact.engines.cluster import Cluster
from eigencontact.errors import EigencontactError, SceneError
from eigencontact.sweeps.variants import Variant
from eigencontact_verification.reporting.files import write_json
from eigencontact_verification.studies.checks import verdicts
from eigencontact_verification.studies.errors import errors_at_end
from eigencontact_verification.studies.study import Finished, Study

__all__ = ["Failed", "folder_name", "in_si", "run_study", "source_in_words", "variants_of_study", "write_study"]


@dataclass(frozen=True)
class Failed:
    """A variant that has no results, and why."""

    label: str
    values: Mapping[str, Any]
    reason: str
    place: int = 0


def variants_of_study(study: Study, *, coarse: bool) -> list[Variant]:
    """Variants, labelled as in the figure; refused ones say why.

    Raises
    ------
    SceneError
        Two variants of one label, or every variant refused.
    """
    variants = list[Variant]()
    for n, values in enumerate(study.coarse_rows if coarse else study.rows):
        label = study.text(values)
        try:
            variants.append(Variant(label, (n,), dict(values), study.scene(values, coarse=coarse)))
        except EigencontactError as problem:
            variants.append(Variant(label, (n,), dict(values), None, str(problem)))
    labels = [variant.label for variant in variants]
    twice = next((label for label in labels if labels.count(label) > 1), None)
    if twice is not None:
        raise SceneError(f"{study.name}: label must be different for each variant (got {twice!r} twice)")
    if all(variant.refused for variant in variants):
        raise SceneError(f"{study.name}: no variant is valid; the first error: {variants[0].refused}")
    return variants


def run_study(
    study: Study, folder: Path, *, coarse: bool = False, workers: int = 1, cluster: Cluster | None = None
) -> Iterator[Finished | Failed]:
    """Run the variants, each into a folder of its own, as they finish; finished ones are read again, not run again.

    Parameters
    ----------
    folder : Path
        Has a folder of each study, with a folder of each variant.
    coarse : bool
        Fewer variants and cells, for a first look.
    workers, cluster : int, Cluster
        Number of processes at a time, or the cluster that runs the variants instead.
    """
    from dataclasses import replace

    from eigencontact.postprocess.stored_run import open_results
    from eigencontact.sweeps.runner import outcomes

    variants = variants_of_study(study, coarse=coarse)
    place = folder / study.name
    place.mkdir(parents=True, exist_ok=True)
    plain = [replace(planned, label=folder_name(planned.label)) for planned in variants]
    for outcome in outcomes(plain, place, workers=workers, engine=cluster):
        variant = variants[outcome.place[0]]
        if outcome.failed:
            yield Failed(variant.label, variant.values, outcome.failed, outcome.place[0])
            continue
        dataset = open_results(place / folder_name(variant.label))
        numbers = in_si(study, variant)
        row = study.read(numbers, dataset, coarse=coarse)
        symbols = {symbol: row[name] for name, (symbol, *_) in study.readings.items() if name in row}
        names = {**study.names(numbers, coarse=coarse), **symbols}
        warnings, bars = outcome.summary.get("warnings", ()), errors_at_end(outcome.summary, dataset)
        errors = study.errors_of(numbers, dataset, row, bars, coarse=coarse)
        yield Finished(variant.label, numbers, dataset, row, names, outcome.place[0], warnings, errors)


def in_si(study: Study, variant: Variant) -> dict[str, Any]:
    """Values of parameters; texts with units, which stand at keys of the scene, as numbers."""
    from eigencontact.core.units import parse_quantity
    from eigencontact.reference.places import key_at
    from eigencontact.scene.installed import installed_plugins

    assert variant.scene is not None
    numbers = dict(variant.values)
    for parameter in study.parameters:
        value = numbers.get(parameter.name)
        if parameter.key and isinstance(value, str):
            key = key_at(installed_plugins(), variant.scene.resolved(), parameter.key)
            if key is not None and key.unit:
                numbers[parameter.name] = parse_quantity(value, key.unit, parameter.key)
    return numbers


def write_study(study: Study, outcomes: Sequence[Finished | Failed], folder: Path) -> list[Path]:
    """Write figure (PNG) and numbers (JSON) of a study; return the files."""
    from eigencontact.viz.style import paper_style, save
    from eigencontact_verification.studies.figure import draw_study

    folder.mkdir(parents=True, exist_ok=True)
    finished = sorted(
        (outcome for outcome in outcomes if isinstance(outcome, Finished)), key=lambda outcome: outcome.place
    )
    files = [folder / f"{study.name}.json"]
    if finished and study.figure["panel"]:
        with paper_style():
            figure = draw_study(study, finished)
        save(figure, folder / f"{study.name}.png")
        files.insert(0, folder / f"{study.name}.png")
    labels = {outcome.name: outcome.label for outcome in study.parameters}
    rows: list[dict[str, Any]] = [
        {"variant": item.label, **{labels[k]: v for k, v in item.values.items()},
         **{name: value if math.isfinite(value) else None for name, value in item.row.items()},
         **{f"{name} error": error for name, error in study.row_errors(item).items()}}
        for item in finished
    ]  # fmt: skip
    content = {
        "study": study.name, "title": study.title, "source": [dict(outcome) for outcome in study.sources],
        "trend": study.trend, "variants": rows, "checks": [verdict.to_dict() for verdict in verdicts(study, finished)],
        "failed": {outcome.label: outcome.reason for outcome in outcomes if isinstance(outcome, Failed)},
        "warnings": {outcome.label: list(outcome.warnings) for outcome in finished if outcome.warnings},
    }  # fmt: skip
    write_json(files[-1], content, default=str)
    return files


def source_in_words(source: Mapping[str, Any]) -> str:
    """Source as a caption names it.

    Examples
    --------
    >>> source_in_words({"authors": "A. Author", "year": 1975, "title": "On contact", "figure": "figure 2"})
    'A. Author 1975, On contact, figure 2'
    """
    who = " ".join(str(source[key]) for key in ("authors", "year") if key in source)
    doi = f"doi:{source['doi']}" if "doi" in source else ""
    case = f"case {source['case']}" if "case" in source else ""
    pieces = [who, *(str(source.get(key, "")) for key in ("title", "journal", "figure", "form")), doi, case]
    return ", ".join(piece for piece in pieces if piece)


def folder_name(label: str) -> str:
    """Label as the name of a folder."""
    plain = "".join(letter if letter.isalnum() or letter in ".-" else "_" for letter in label)
    short = re.sub("_+", "_", plain).strip("_")
    return short if len(short) <= 100 else f"{short[:90]}-{sha256(label.encode()).hexdigest()[:8]}"
