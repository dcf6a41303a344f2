"""All benchmarks, by name."""

from __future__ import annotations

from eigencontact_verification.benchmarks import (
    cloud,
    eigenstrain,
    fidelity,
    hertz,
    inhomogeneity,
    largest,
    layers,
    plasticity,
    predictions,
    rough,
    start,
    store,
    stress,
    tangential,
    trade,
    wear,
)
from eigencontact_verification.benchmarks.benchmark import Benchmark

__all__ = ["BENCHMARKS"]

_MODULES = (
    hertz,
    stress,
    fidelity,
    eigenstrain,
    cloud,
    trade,
    tangential,
    inhomogeneity,
    largest,
    layers,
    plasticity,
    wear,
    rough,
    predictions,
    start,
    store,
)
BENCHMARKS: dict[str, Benchmark] = {module.BENCHMARK.name: module.BENCHMARK for module in _MODULES}
