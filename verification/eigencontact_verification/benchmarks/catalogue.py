"""All benchmarks, by name."""

from __future__ import annotations

from importlib import import_module

from eigencontact_verification.benchmarks.benchmark import Benchmark

__all__ = ["BENCHMARKS"]

#: Modules of this folder with a `BENCHMARK`, which has the name of its module.
_NAMES = (
    "hertz", "stress", "fidelity", "eigenstrain", "cloud", "trade", "tangential", "inhomogeneity", "degrees",
    "degree_errors", "error_bars", "field_errors", "accuracy_asked", "balls", "largest", "layers", "plasticity", "wear",
    "rough", "fatigue", "lines",
    "predictions", "start", "store",
)  # fmt: skip
BENCHMARKS: dict[str, Benchmark] = {
    name: import_module(f"eigencontact_verification.benchmarks.{name}").BENCHMARK for name in _NAMES
}
