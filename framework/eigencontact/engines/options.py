"""Options of commands that can use a cluster, with few imports because the help loads this module."""

from __future__ import annotations

from typing import Annotated

import typer

__all__ = ["ClusterAddress", "TaskMemory", "TaskThreads"]

ClusterAddress = Annotated[
    str | None,
    typer.Option(
        "--cluster", metavar="ADDRESS", help="Scheduler of dask.distributed, its file, or `local:N` (N local workers)."
    ),
]
TaskMemory = Annotated[
    float | None,
    typer.Option("--memory", metavar="GB", min=0.1, help="Memory of a cluster's worker for one run."),
]
TaskThreads = Annotated[
    int | None,
    typer.Option("--threads", metavar="N", min=1, help="Threads of a cluster's worker for one run."),
]
