"""Runs of one scene on several discretisations: each is solved once, and serves as a coarser run of finer ones."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from operator import itemgetter
from time import perf_counter
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.bars import Accuracy, CoarserRuns, Run, SourceRuns, error_bars
from eigencontact.accuracy.changes import changed, refined_window
from eigencontact.accuracy.fields import FieldErrors
from eigencontact.accuracy.sources import EDGES, SOURCES, ErrorSource, Variation, error_sources
from eigencontact.errors import EigencontactError
from eigencontact.planning.memory import results_bytes

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["Runs", "edge_of", "memory_of"]

#: Bounds of the ratios of edges within which solved grids replace the grids of the source "cells". Larger ratios make
#: the bars of numbers that scatter 2 to 9 times as wide, which costs more than a coarser run.
_NEAR, _FAR, _APART = (1.4, 2.6), 5.0, 1.25
#: Relative time below which cells are varied with the other settings of the first rung in place of those of the run.
_CHEAPER = 0.5
_CELLS = next(source for source in SOURCES if source.name == "cells")
#: Sources whose error is a part of that of all cells.
_OF_CELLS = {source.name for source in SOURCES if source.of_cells}


def edge_of(plan: Plan) -> float:
    """Edge of the cells, both directions alike [m]."""
    return plan.grid.mean_edge


def memory_of(plan: Plan) -> float:
    """Memory of the arrays of a run and of the results of all its load steps [bytes]."""
    return plan.cost.peak + results_bytes(plan)


@dataclass
class Runs:
    """Solves discretisations of a scene, each once.

    Attributes
    ----------
    make : callable
        Returns the plan of tables of a scene.
    solve : callable
        Takes a plan and its difference in words; returns its run or raises `EigencontactError`.
    solved, reused : int
        Number of runs, and of those that were needed again.
    """

    make: Callable[[Mapping[str, Any]], Plan]
    solve: Callable[[Plan, str], Run]
    solved: int = 0
    reused: int = 0
    _run_by_key: dict[str, Run] = field(default_factory=dict)
    _grids: list[tuple[float, Mapping[str, Any]]] = field(default_factory=list)
    _first: Plan | None = None
    _last: tuple[Run, Mapping[str, SourceRuns]] | None = None

    @property
    def memory_of_results(self) -> float:
        """Memory of the results of all runs [bytes], which stay for the errors of fields."""
        return sum(results_bytes(run.plan) for run in self._run_by_key.values())

    def rung(
        self, plan: Plan, words: str, *, refined: Collection[str] = (), small: Collection[str] = ()
    ) -> tuple[Run, float, Accuracy, FieldErrors | None]:
        """Run of a plan, its time without the bars [s], its error bars, and the errors of its fields if it has any.

        Parameters
        ----------
        plan : Plan
        words : str
            Difference from the run of the last rung.
        refined : collection of str
            Sources of error that are finer than in that run.
        small : collection of str
            Sources whose errors are negligible: their errors on the last rung stand.
        """
        began = perf_counter()
        run = self._solve(plan, words)
        seconds = perf_counter() - began
        return (run, seconds, *self._with_bars(run, self._reusable_runs(run, refined, small)))

    def _with_bars(self, run: Run, reusable_runs: Mapping[str, SourceRuns]) -> tuple[Accuracy, FieldErrors | None]:
        sources = [
            self._with_solved_grids(source) if source is _CELLS else source for source in error_sources(run.plan)
        ]
        fields = None if run.results is None else FieldErrors(run.results, run.summary)
        coarse = None if self._first is None else max(self._grids, key=itemgetter(0))[1]
        accuracy = error_bars(
            run.plan,
            run.summary,
            self._coarser_run,
            fields,
            sources=sources,
            reusable_runs=reusable_runs,
            coarse=coarse,
        )
        self._first, self._last = self._first or run.plan, (run, accuracy.runs_by_source)
        return accuracy, fields

    def _reusable_runs(self, run: Run, refined: Collection[str], small: Collection[str]) -> dict[str, SourceRuns]:
        """Runs of sources that stand for those of a run: of sources that did not become finer, and of the cells.

        Where the cells at inclusions became finer, all cells are varied again: their error contains that of the cells
        at inclusions.
        """
        if self._last is None:
            return {}
        _, runs_by_source = self._last
        outdated = {*refined, *(EDGES if _OF_CELLS & set(refined) else ())}
        reused = {name: runs for name, runs in runs_by_source.items() if name not in outdated}
        if "cells" in refined:
            reused = {name: runs for name, runs in reused.items() if name in small}
            if (base := self._with_cells_of(run.plan)) is not None:
                cells, _ = CoarserRuns(base, self._coarser_run).vary(self._with_solved_grids(_CELLS), {})
                reused |= {"cells": cells} if cells.coarser_runs else {}
        return reused

    def _with_cells_of(self, plan: Plan) -> Run | None:
        """Run with the cells of a plan and all other settings of the first rung; None where that saves too little.

        Cells at inclusions are those of the plan, too.
        """
        assert self._first is not None
        divided = {"inclusion-refinement": plan.numerics.refinement}
        cells = {"grid": plan.scene.resolved()["grid"], "numerics": divided}
        try:
            tables = changed(self._first.scene.resolved(), cells)
            if self.make(tables).seconds > _CHEAPER * plan.seconds:
                return None
            return self._coarser_run(tables, "cells alone finer")
        except EigencontactError:
            return None

    def _coarser_run(self, tables: Mapping[str, Any], words: str) -> Run:
        """Run for a comparison, solved now or reused."""
        plan = self.make(tables)
        run = self._run_by_key.get(_key(plan))
        if run is None:
            run = self._solve(plan, f"error bars: {words}")
        else:
            self.reused += 1
        return run

    def _solve(self, plan: Plan, words: str) -> Run:
        run = self.solve(plan, words)
        self.solved += 1
        self._run_by_key[_key(plan)] = run._replace(storage=None)
        grid = plan.scene.resolved()["grid"]
        if grid not in [table for _, table in self._grids]:
            self._grids.append((edge_of(plan), grid))
        return run

    def _with_solved_grids(self, source: ErrorSource) -> ErrorSource:
        """Source whose variations use grids solved before, if their ratios fit; else the default variations."""
        default_variations = source.variations

        def variations(plan: Plan) -> list[Variation]:
            edge = edge_of(plan)
            solved_grids = sorted(((size / edge, grid) for size, grid in self._grids), key=lambda pair: pair[0])
            near, far = default_variations(plan)
            candidates = [pair for pair in solved_grids if _NEAR[0] <= pair[0] <= _NEAR[1]]
            if not candidates:
                return [near, far]
            ratio, grid = candidates[0]
            near = replace(near, changes={**near.changes, "grid": grid}, ratio=ratio)
            candidates = [pair for pair in solved_grids if _APART * ratio <= pair[0] <= _FAR]
            ratio, grid = (
                candidates[0]
                if candidates
                else (1.5 * ratio, refined_window(plan, 1.0 / (1.5 * ratio), keep_parity=True)[0])
            )
            return [near, replace(far, changes={**far.changes, "grid": grid}, ratio=ratio)]

        return replace(source, variations=variations)


def _key(plan: Plan) -> str:
    """Everything that decides the numbers of a run."""
    return json.dumps(changed(plan.scene.resolved(), {}), sort_keys=True)
