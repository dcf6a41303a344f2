"""Runs of a campaign: every variant of the model and of the levels of its reference, by the machinery of sweeps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.errors import SceneError
from eigencontact_verification.studies.run import folder_name, in_si, variants_of_study
from eigencontact_verification.studies.study import Study

if TYPE_CHECKING:
    import xarray as xr

    from eigencontact.engines.cluster import Cluster
    from eigencontact.sweeps.variants import Variant
    from eigencontact_verification.campaign.campaign import Campaign

__all__ = ["Point", "Run", "perform_runs", "points_of"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Run:
    """A scene that runs, and its outcome."""

    study: Study  #: study of the variant
    variant: Variant  #: scene, and the name of its folder
    coarse: bool  #: whether it is a first look
    failed: str = ""  #: reason where there are no results
    summary: Mapping[str, Any] | None = None  #: contents of ``summary.json``

    @property
    def names(self) -> dict[str, Any]:
        """Constants and parameters, in SI."""
        values = self.variant.values if self.variant.scene is None else in_si(self.study, self.variant)
        return self.study.names(values, coarse=self.coarse)

    @property
    def seconds(self) -> float | None:
        """Wall time [s] of the run itself, when it was computed."""
        return None if not self.summary else self.summary.get("total_seconds")

    @property
    def memory(self) -> int | None:
        """Peak memory of its process [byte]."""
        return None if not self.summary else self.summary.get("peak_memory_bytes")

    @contextmanager
    def results(self, folder: Path) -> Iterator[xr.Dataset]:
        """Results, from the folder of all runs."""
        from eigencontact.postprocess.stored_run import open_results

        with open_results(folder / self.variant.label) as dataset:
            yield dataset


@dataclass(frozen=True, kw_only=True, eq=False)
class Point:
    """A point of the map: a variant of the model, and the runs of its reference, coarse to fine."""

    label: str  #: label of the variant
    values: Mapping[str, Any]  #: parameters of the variant, as in the file
    model: Run
    reference: tuple[Run, ...] = ()  #: empty where finite elements judge


def points_of(campaign: Campaign, *, coarse: bool = False) -> list[Point]:
    """Points of the map, nothing run yet.

    Raises
    ------
    SceneError
        Two variants of one label; all variants of a scene refused.
    """
    points: list[Point] = []
    for model in campaign.coarse_models if coarse else campaign.models:
        levels = [
            ("model", model.study),
            *((f"reference-{k}", reference_study) for k, reference_study in enumerate(model.reference)),
        ]
        runs = [[Run(study=study, variant=_placed(reference_study, kind), coarse=coarse)
                 for reference_study in variants_of_study(study, coarse=coarse)] for kind, study in levels]  # fmt: skip
        labels = [model.study.text(values) for values in (model.study.coarse_rows if coarse else model.study.rows)]
        for label, judged, *reference in zip(labels, *runs, strict=True):
            points.append(Point(label=label, values=judged.variant.values, model=judged, reference=tuple(reference)))
    places = [run.variant.label for point in points for run in (point.model, *point.reference)]
    twice = next((reference_study for reference_study in places if places.count(reference_study) > 1), None)
    if twice is not None:
        raise SceneError(f"{campaign.name}: label must be different for each variant (got {twice!r} twice)")
    return points


def _labels(point: Point) -> list[str]:
    """Names of the runs of a point for people: the variant, and whether model or reference."""
    count = len(point.reference)
    references = (f"{point.label}: reference, refinement {k} of {count}" for k in range(1, count + 1))
    return [f"{point.label}: model", *references]


def _placed(variant: Variant, kind: str) -> Variant:
    return replace(variant, label=f"{kind}_{folder_name(variant.label)}")


def perform_runs(
    points: Sequence[Point],
    folder: Path,
    *,
    workers: int = 1,
    cluster: Cluster | None = None,
    by_itself: bool = False,
    tell: Callable[[str], None] | None = None,
) -> list[Point]:
    """Points with the outcome of their runs; finished runs are read again, not run again.

    Parameters
    ----------
    folder : Path
        Has a folder of each run.
    workers, cluster : int, Cluster
        Number of processes at a time, or the cluster that performs the runs instead.
    by_itself : bool
        Whether each run has a process of its own, one at a time, so that memory and time are its own.
    tell : callable, optional
        Called for each run as it ends.
    """
    from eigencontact.engines.engine import Processes
    from eigencontact.sweeps.runner import outcomes

    folder.mkdir(parents=True, exist_ok=True)
    runs = [run for point in points for run in (point.model, *point.reference)]
    labels = [label for point in points for label in _labels(point)]
    variants = [replace(run.variant, place=(n,)) for n, run in enumerate(runs)]
    finished = dict[int, Run]()
    if by_itself and cluster is None:
        several = [outcomes([variant], folder, engine=Processes(1)) for variant in variants]
    else:
        several = [outcomes(variants, folder, workers=workers, engine=cluster)]
    for outcome in chain.from_iterable(several):
        n = outcome.place[0]
        finished[n] = replace(runs[n], failed=outcome.failed, summary=outcome.summary)
        if tell is not None:
            tell(labels[n])
    outcomes_in_order = iter(finished[n] for n in range(len(runs)))
    return [
        replace(point, model=next(outcomes_in_order), reference=tuple(next(outcomes_in_order) for _ in point.reference))
        for point in points
    ]
