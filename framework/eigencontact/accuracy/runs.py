"""Runs of one scene on several discretisations: each is solved once, and serves as a coarser run of finer ones."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.bars import Accuracy, Run, error_bars
from eigencontact.accuracy.changes import changed, refined_window
from eigencontact.accuracy.fields import FieldErrors
from eigencontact.accuracy.sources import Variation, error_sources

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["Runs", "edge_of"]

#: Grids that were solved before stand for those of the source "cells" within these ratios of their edges.
_NEAR, _FAR, _APART = (1.4, 3.1), 5.0, 1.25


def edge_of(plan: Plan) -> float:
    """Edge of the cells, both directions alike [m]."""
    return plan.grid.mean_edge


@dataclass
class Runs:
    """Solves discretisations of a scene, each once.

    Attributes
    ----------
    make : callable
        Tables to their plan.
    solve : callable
        Plan, and what differs in words, to its run; raises `EigencontactError`.
    solved, reused : int
        Number of runs, and of those that were needed again.
    """

    make: Callable[[Mapping[str, Any]], Plan]
    solve: Callable[[Plan, str], Run]
    solved: int = 0
    reused: int = 0
    _known: dict[str, Run] = field(default_factory=dict)
    _grids: list[tuple[float, Mapping[str, Any]]] = field(default_factory=list)

    def rung(self, plan: Plan, words: str) -> tuple[Run, float, Accuracy, FieldErrors | None]:
        """Run of a plan, its time without the error bars [s], its error bars, and the errors of its fields, if any."""
        began = perf_counter()
        run = self._solve(plan, words)
        seconds = perf_counter() - began
        sources = [
            replace(source, variations=self._cells(source.variations)) if source.name == "cells" else source
            for source in error_sources(run.plan)
        ]
        fields = None if run.results is None else FieldErrors(run.results, run.summary)
        return run, seconds, error_bars(run.plan, run.summary, self._coarse, fields, sources=sources), fields

    def _coarse(self, tables: Mapping[str, Any], words: str) -> Run:
        """Run that a bar compares with, solved now or before."""
        plan = self.make(tables)
        known = self._known.get(_key(plan))
        if known is None:
            known = self._solve(plan, f"error bars: {words}")
        else:
            self.reused += 1
        return known

    def _solve(self, plan: Plan, words: str) -> Run:
        run = self.solve(plan, words)
        self.solved += 1
        self._known[_key(plan)] = run._replace(kept=None)
        grid = plan.scene.resolved()["grid"]
        if grid not in [table for _, table in self._grids]:
            self._grids.append((edge_of(plan), grid))
        return run

    def _cells(self, usual: Callable[[Plan], Sequence[Variation]]) -> Callable[[Plan], list[Variation]]:
        """Variations of the cells on grids solved before, if their ratios fit; else the default variations."""

        def variations(plan: Plan) -> list[Variation]:
            edge = edge_of(plan)
            known = sorted(((size / edge, grid) for size, grid in self._grids), key=lambda pair: pair[0])
            near, far = usual(plan)
            fits = [pair for pair in known if _NEAR[0] <= pair[0] <= _NEAR[1]]
            if not fits:
                return [near, far]
            ratio, grid = fits[0]
            near = replace(near, changes={**near.changes, "grid": grid}, ratio=ratio)
            fits = [pair for pair in known if _APART * ratio <= pair[0] <= _FAR]
            ratio, grid = fits[0] if fits else (1.5 * ratio, refined_window(plan, 1.0 / (1.5 * ratio), alike=True)[0])
            return [near, replace(far, changes={**far.changes, "grid": grid}, ratio=ratio)]

        return variations


def _key(plan: Plan) -> str:
    """Everything that decides the numbers of a run."""
    return json.dumps(changed(plan.scene.resolved(), {}), sort_keys=True)
