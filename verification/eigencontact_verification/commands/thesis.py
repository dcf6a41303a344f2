"""The thesis, figure by figure: counts and verdicts of `eigencontact study thesis`."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from eigencontact.engines.cluster import Cluster
    from eigencontact_verification.thesis.entries import Entry
    from eigencontact_verification.thesis.judge import JudgedClaim

__all__ = ["report_thesis"]


def report_thesis(
    output: Path,
    *,
    entries: Sequence[Entry],
    coarse: bool,
    errors: bool,
    workers: int,
    cluster: Cluster | None,
    pictures: Path | None,
    as_json: bool,
) -> None:
    """Judge the claims of some figures, print their verdicts, and write them to ``thesis.json``; draw them if asked."""
    from eigencontact_verification.reporting.files import open_folder, write_json
    from eigencontact_verification.thesis.judge import judged_claims

    open_folder(output, ("thesis.json",))

    def tell(name: str) -> None:
        typer.echo(f"study {name}", err=True)

    claims = list(judged_claims(
        entries, output, coarse=coarse, errors=errors, workers=workers, cluster=cluster,
        tell=tell,
    ))  # fmt: skip
    content: dict[str, Any] = {
        "quick": coarse, "counts": _counts(entries, claims), "claims": [claim.to_dict() for claim in claims],
    }  # fmt: skip
    write_json(output / "thesis.json", content)
    if pictures is not None:
        from eigencontact_verification.thesis.pictures import draw_pictures

        draw_pictures(entries, output, pictures, coarse=coarse, workers=workers, cluster=cluster, tell=tell)
    if as_json:
        typer.echo(json.dumps(content, ensure_ascii=False, indent=1))
        return
    _print(entries, claims, content["counts"])
    typer.echo(f"written: {output / 'thesis.json'}")


def _counts(entries: Sequence[Entry], claims: Sequence[JudgedClaim]) -> dict[str, dict[str, int]]:
    from eigencontact_verification.thesis.judge import VERDICTS

    states, verdicts = Counter(item.state for item in entries), Counter(item.verdict for item in claims)
    return {
        "figures and tables": {name: states[name] for name in ("computed", "open", "no result")},
        "claims": {name: verdicts[name] for name in VERDICTS},
    }


def _print(entries: Sequence[Entry], claims: Sequence[JudgedClaim], counts: dict[str, dict[str, int]]) -> None:
    for name, numbers in counts.items():
        counts_in_words = ", ".join(f"{count} {word}" for word, count in numbers.items())
        typer.echo(f"{sum(numbers.values())} {name}: {counts_in_words}")
    for entry in entries:
        by = entry.study or entry.scene or entry.test
        typer.echo(f"\n{entry.name}: {entry.shows} ({entry.kind}, section {entry.place}{', ' + by if by else ''})")
        if entry.lacks:
            typer.echo(f"  not computed, it lacks: {entry.lacks}")
        for claim in (claim for claim in claims if claim.name == entry.name):
            sources = ("here", claim.number), ("text", claim.text)
            values = "; ".join(f"{source} {number}" for source, number in sources if number)
            typer.echo(f"  {claim.verdict}: {claim.says}{f' ({values})' if values else ''}")
            if claim.why:
                typer.echo(f"    {claim.why}")
