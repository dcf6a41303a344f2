"""Verdicts of a campaign as tables for other programs: CSV with all numbers, LaTeX to print."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from eigencontact_verification.campaign.figure import label_in, quantities_of
from eigencontact_verification.reporting.typeset import subscripts
from eigencontact_verification.studies.study import plain

if TYPE_CHECKING:
    from eigencontact_verification.campaign.campaign import Campaign
    from eigencontact_verification.campaign.finding import JudgedPoint

__all__ = ["csv_table", "latex_table"]

#: Columns after the parameters; errors, uncertainties and tolerances are fractions, times seconds; the own error is
#: that of the model by its error bars.
_COLUMNS = (
    "quantity", "claimed", "verdict", "error", "uncertainty", "own_error", "tolerance", "value", "reference", "scale",
    "model_seconds", "reference_seconds", "reason",
)  # fmt: skip
_ESCAPED = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "±": r"$\pm$", "–": "--", "ν": r"$\nu$", "µ": r"$\mu$",
}  # fmt: skip
_SIGNS = {"agrees": "", "inconclusive": "?", "disagrees": r"$^\ast$", "failed": "failed"}


def csv_table(points: Sequence[JudgedPoint]) -> str:
    """One row for each point and quantity: parameters, verdict and numbers in SI units."""
    parameters = _parameters(points)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["point", *parameters, *_COLUMNS])
    for point in points:
        values = [point.point.values.get(name) for name in parameters]
        times = [point.point.model.seconds, point.reference_seconds]
        for finding in point.findings:
            numbers = [finding.error, finding.uncertainty, finding.run_error, finding.tolerance]
            numbers += [finding.value, finding.reference, finding.scale]
            head = [point.point.label, *values, finding.quantity, "yes" if finding.claimed else "no", finding.word]
            writer.writerow([*head, *numbers, *times, finding.reason])
    return text.getvalue()


def latex_table(campaign: Campaign, points: Sequence[JudgedPoint]) -> str:
    """Table of the package booktabs: a row for each point, a column for each parameter and each quantity."""
    parameters, quantities = _parameters(points), quantities_of(campaign, points)
    head = [_latex(label_in(campaign, name)) for name in parameters] + [_latex(name) for name in quantities]
    rows = []
    for point in points:
        cells = {finding.quantity: finding.numbers for finding in point.findings}
        signs = {finding.quantity: _SIGNS[finding.word] for finding in point.findings}
        values = [_latex(plain(point.point.values.get(name, "–"))) for name in parameters]
        rows.append([*values, *(_latex(cells.get(name, "–")) + signs.get(name, "") for name in quantities)])
    note = "error and uncertainty of the reference; ? inconclusive, * disagrees"
    return "\n".join(
        [
            f"% eigencontact campaign, {' '.join(campaign.title.split())}: {note}",
            rf"\begin{{tabular}}{{{'r' * len(parameters)}{'l' * len(quantities)}}}",
            r"\toprule",
            " & ".join(head) + r" \\",
            r"\midrule",
            *(" & ".join(row) + r" \\" for row in rows),
            r"\bottomrule",
            r"\end{tabular}",
            "",
        ]
    )


def _parameters(points: Sequence[JudgedPoint]) -> list[str]:
    return list(dict.fromkeys(name for point in points for name in point.point.values))


def _latex(text: str) -> str:
    """Text with LaTeX's special characters escaped; formulas stay formulas."""
    pieces = re.split(r"(\$[^$]*\$)", subscripts(text))
    return "".join(
        piece if piece.startswith("$") and len(piece) > 1 else "".join(_ESCAPED.get(sign, sign) for sign in piece)
        for piece in pieces
    )
