"""What a cluster costs beyond the runs: variants that are refused before they run, on workers of this machine.

``python -m eigencontact_verification.benchmarks.handing_out [VARIANTS [WORKERS]]`` prints the figures.
"""

from __future__ import annotations

import pickle
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from time import perf_counter

__all__ = ["main"]

#: Variants at the beginning that are not counted: workers import what they need.
_FIRST = 100


def main(count: int = 2000, workers: int = 2) -> None:
    """Print cost of each variant, in time of a worker."""
    from eigencontact.app import load_scene
    from eigencontact.engines.cluster import Cluster
    from eigencontact.sweeps.axes import axes_of
    from eigencontact.sweeps.runner import outcomes
    from eigencontact.sweeps.variants import variants_of

    axes = axes_of({"steps.normal-load": {"from": 0.1, "to": 1.0, "count": count + _FIRST}})
    scene, began = load_scene("hertz"), perf_counter()
    variants = variants_of(scene, axes, pairs=False, pictures=False)
    print(f"made: {1e3 * (perf_counter() - began) / len(variants):.2f} ms, {len(pickle.dumps(variants[0]))} bytes")
    trivial, within = [replace(one, refused="trivial") for one in variants], 0.0
    with tempfile.TemporaryDirectory() as folder:
        for done, outcome in enumerate(outcomes(trivial, Path(folder), engine=Cluster(f"local:{workers}")), 1):
            if done == _FIRST:
                began, within = perf_counter(), 0.0
            within += outcome.seconds
        wall = perf_counter() - began
    print(f"{count} variants in {wall:.3g} s: {count / wall:.3g} a second")
    print(f"beyond the run: {1e3 * (wall * workers - within) / count:.3g} ms of a worker")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
