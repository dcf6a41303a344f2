"""Judge of a campaign: another semi-analytical model, refined three times so that its own error is known."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.errors import SceneError
from eigencontact_verification.campaign.finding import JudgedPoint, MapFinding
from eigencontact_verification.fem.uncertainty import estimate
from eigencontact_verification.reporting.verdict import largest, verdict_on
from eigencontact_verification.studies.errors import Errors, error_of, errors_at_end
from eigencontact_verification.studies.formula import Context, evaluate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact_verification.campaign.campaign import Campaign, Quantity
    from eigencontact_verification.campaign.runs import Point

__all__ = ["judge_by_scene"]


def judge_by_scene(campaign: Campaign, point: Point, folder: Path, *, ratio: float) -> JudgedPoint:
    """Verdicts of a point from the folder of its runs; `ratio` is that of the refinements of the reference."""
    runs = (point.model, *point.reference)
    missing = "; ".join(f"{run.variant.label}: {run.failed}" for run in runs if run.failed)
    findings = []
    with ExitStack() as opened:
        # each file is opened once: opening takes longer than reading
        contexts = [] if missing else [Context(run.names, opened.enter_context(run.results(folder))) for run in runs]
        dataset = contexts[0].dataset if contexts else None
        bars = errors_at_end(point.model.summary, dataset) if dataset is not None else {}
        names = Context(point.model.names)
        for quantity in campaign.quantities:
            if quantity.condition and not evaluate(quantity.condition, names, f"{quantity.name}: if"):
                continue
            try:
                finding = _failed(quantity, missing) if missing else _finding(quantity, contexts, ratio, bars)
            except SceneError as problem:
                finding = _failed(quantity, str(problem))
            findings.append(replace(finding, claimed=campaign.claimed(names.names, quantity)))
    seconds = [run.seconds for run in point.reference if run.seconds is not None]
    return JudgedPoint(
        point=point, findings=tuple(findings), reference_seconds=point.reference[-1].seconds,
        all_seconds=sum(seconds) if seconds else None, reference_memory=largest(run.memory for run in point.reference),
    )  # fmt: skip


def _failed(quantity: Quantity, reason: str) -> MapFinding:
    return MapFinding(quantity=quantity.name, word="failed", reason=reason, tolerance=quantity.tolerance, claimed=False)


def _values(quantity: Quantity, context: Context) -> NDArray[np.float64]:
    """Values of a quantity of a run, (n, 1)."""
    values = evaluate(quantity.formula, context, f"quantity {quantity.name!r}")
    return np.asarray(values, dtype=float).reshape(-1, 1)


def _finding(quantity: Quantity, contexts: list[Context], ratio: float, bars: Errors) -> MapFinding:
    model, coarse, medium, fine = values = [_values(quantity, context) for context in contexts]
    sizes = [len(value) for value in values]
    if len(set(sizes)) > 1:
        raise SceneError(
            f"quantity {quantity.name!r} must have equally many values in all models (got {sizes}); use interp at "
            "fixed positions"
        )
    if not all(np.all(np.isfinite(value)) for value in values):
        return _failed(quantity, "a value is not finite")
    estimated = estimate(coarse, medium, fine, ratio=ratio, formal_order=quantity.order)
    scale = _scale(quantity, estimated.value, contexts[-1])
    error = float(np.abs(model - estimated.value).max()) / scale
    uncertainty = float(estimated.uncertainty.max()) / scale
    bar = error_of(quantity.formula, contexts[0], bars)
    run_error = None if bar is None else float(bar.max()) / scale
    word, reason = verdict_on(error, uncertainty, quantity.tolerance, run_error)
    single = len(model) == 1
    return MapFinding(
        quantity=quantity.name, word=word, reason=reason, tolerance=quantity.tolerance, claimed=False, error=error,
        uncertainty=uncertainty, value=float(model[0, 0]) if single else None,
        reference=float(estimated.value[0, 0]) if single else None, scale=scale,
        run_error=run_error,
    )  # fmt: skip


def _scale(quantity: Quantity, value: NDArray[np.float64], context: Context) -> float:
    """Scale of errors: that of the formula, on the finest reference, or the largest value there."""
    if not quantity.scale:
        scale = float(np.abs(value).max())
    else:
        values_of_scale = evaluate(quantity.scale, context, f"quantity {quantity.name!r}: scale")
        scale = float(np.max(np.abs(np.asarray(values_of_scale))))
    if not scale > 0.0:
        raise SceneError(f"quantity {quantity.name!r}: scale must be positive (got {scale:g}); give a formula for it")
    return scale
