"""From a campaign to its report: all runs, then whoever judges them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from eigencontact_verification.campaign.report import MapReport
from eigencontact_verification.campaign.runs import perform_runs, points_of
from eigencontact_verification.campaign.scenes import judge_by_scene

if TYPE_CHECKING:
    from eigencontact.engines.cluster import Cluster
    from eigencontact_verification.campaign.campaign import Campaign
    from eigencontact_verification.campaign.elements import CasesOf
    from eigencontact_verification.crosscheck.worker import Outcome, Task

__all__ = ["perform"]

#: Called with what has ended, how many runs have, and how many there are by now.
ProgressCallback = Callable[[str, int, int], None]


def perform(
    campaign: Campaign,
    folder: Path,
    *,
    coarse: bool = False,
    workers: int = 1,
    cluster: Cluster | None = None,
    memory: float | None = None,
    cases_of: CasesOf | None = None,
    tell: ProgressCallback | None = None,
) -> MapReport:
    """Run and judge; finished runs and solutions of the folder are read, not computed again.

    Parameters
    ----------
    folder : Path
        Runs go into ``runs``, solutions of finite elements into ``solutions``.
    coarse : bool
        Fewer points and cells, for a first look.
    workers, cluster : int, Cluster
        Number of processes at a time, or the cluster that performs runs and solutions instead.
    memory : float, optional
        Memory of a finite-element solution [byte]; 6 GB by default.
    cases_of : callable, optional
        Makes the cases of a folder of results, for a judge of your own; by default those of the file.
    tell : callable, optional
        Called for each run and solution as it ends.
    """
    began = time.perf_counter()
    points = points_of(campaign, coarse=coarse)
    counted = _Counted(tell, sum(1 + len(point.reference) for point in points))
    counted.labels = {point.model.variant.label: point.label for point in points}
    ran = perform_runs(
        points, folder / "runs", workers=workers, cluster=cluster, by_itself=campaign.whole_scenes, tell=counted.count
    )
    if campaign.judge == "scene":
        ratio = campaign.coarse_ratio if coarse else campaign.ratio
        judged_points = [judge_by_scene(campaign, point, folder / "runs", ratio=ratio) for point in ran]
    else:
        from eigencontact_verification.campaign.elements import cases_for, executor_for, judge_by_elements, plugins_of

        judged_points = judge_by_elements(
            campaign, ran, folder, cases_of=cases_of or cases_for(campaign, coarse=coarse),
            executor=executor_for(plugins_of(ran), workers=workers, cluster=cluster, memory=memory), progress=counted,
        )  # fmt: skip
    return MapReport(campaign=campaign, points=tuple(judged_points), coarse=coarse, seconds=time.perf_counter() - began)


class _Counted:
    """Counts runs and then solutions in one row; a `Progress` of the campaign of solutions."""

    def __init__(self, tell: ProgressCallback | None, total: int) -> None:
        self._tell, self._total, self._done = tell, total, 0
        #: Label of each point by the name of its folder, with which the names of its cases begin.
        self.labels: dict[str, str] = {}

    def count(self, label: str) -> None:
        """Something has ended."""
        self._done += 1
        if self._tell is not None:
            self._tell(label, self._done, self._total)

    def started(self, tasks: Sequence[Task]) -> None:
        """Solutions are to come."""
        self._total += len(tasks)

    def finished(self, task: Task, outcome: Outcome) -> None:
        """A solution has ended."""
        folders = [folder for folder in self.labels if task.case.name.startswith(f"{folder}_")]
        folder = max(folders, key=len, default="")
        name = task.case.name.removeprefix(f"{folder}_").replace("-", " ")
        label = ", ".join(text for text in (self.labels.get(folder, ""), name) if text)
        self.count(f"{label}: {task.label}{f': {outcome.reason}' if outcome.reason else ''}")
