"""Fatigue criteria: time for many points and steps, and how much a value depends on the axes.

The stress is out of phase about a mean, another at each point. In turned axes a criterion has the same value; what it
differs by is the error of its search for planes, or of its quadrature over them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.reporting.table import Column

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["BENCHMARK", "CRITERIA", "cycle_of", "measure"]

#: Parameters of each criterion.
CRITERIA: dict[str, dict[str, Any]] = {
    "crossland": {"slope": 0.3, "limit_amplitude": 250e6},
    "dang-van": {"slope": 0.3, "limit_amplitude": 250e6},
    "findley": {"slope": 0.3, "limit_amplitude": 260e6},
    "mcdiarmid": {"limit_amplitude": 250e6, "tensile_strength": 900e6},
    "smith-watson-topper": {"limit_product": 0.8e6},
    "fatemi-socie": {"slope": 0.3, "yield_stress": 900e6, "limit_strain_amplitude": 4e-3},
    "papadopoulos": {"slope": 0.3, "limit_amplitude": 250e6},
}
#: Points and steps by name of the case.
_CASES = {"1000 points, 24 steps": (1000, 24), "30000 points, 24 steps": (30_000, 24)}
#: Young's modulus [Pa] and Poisson's ratio of the strain; points that are compared in turned axes.
_YOUNG, _POISSON, _TURNED = 200e9, 0.3, 200


def cycle_of(points: int, steps: int, axes: NDArray[np.float64] | None = None) -> Any:
    """Cycle of Mandel stress and elastic strain, in turned axes where a rotation ``(3, 3)`` is named."""
    from eigencontact.core.elasticity import mandel_rotation
    from eigencontact.plugin import StressCycle

    mean, first, second, third = 1e8 * np.random.default_rng(1).normal(size=(4, 6, points))
    phase = (2.0 * np.pi * np.arange(steps) / steps)[:, None, None]
    stress = 0.3 * mean + np.cos(phase) * first + np.sin(phase) * second + 0.3 * np.cos(2 * phase) * third
    if axes is not None:
        stress = np.einsum("ij,tjp->tip", mandel_rotation(axes), stress)
    strain = (1.0 + _POISSON) / _YOUNG * stress
    strain[:, :3] -= _POISSON / _YOUNG * stress[:, :3].sum(axis=1, keepdims=True)
    return StressCycle(stress=stress, strain=strain)


def measure(code: Code, task: Task) -> Sample:
    """Measure one criterion in this process, which is a fresh one; compiling is set-up."""
    from eigencontact import make

    points, steps = _CASES[task.case]
    criterion = make(code.name, kind="fatigue-criterion", **CRITERIA[code.name])
    cycle, short_cycle = cycle_of(points, steps), cycle_of(_TURNED, steps)
    axes = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    axes *= np.sign(np.linalg.det(axes))

    def judge(_: Any) -> dict[str, Any]:
        value, turned = (criterion.damage(item).value for item in (short_cycle, cycle_of(_TURNED, steps, axes)))
        return {"turned": float(np.max(np.abs(turned / value - 1.0)))}

    trial = Trial(call=lambda: criterion.damage(cycle), judge=judge, setup=lambda: criterion.damage(short_cycle))
    return trial.run(task, warm=0)


BENCHMARK = Benchmark(
    name="fatigue",
    help="fatigue criteria at many points",
    measure=measure,
    medians=("turned",),
    methods={
        name: Code(name=name, distribution="eigencontact", modules=("eigencontact.core.paths",), settings=str(table))
        for name, table in CRITERIA.items()
    },
    ours=tuple(CRITERIA),
    cases=tuple(_CASES),
    columns=(
        Column("case", "case"),
        Column("criterion", "code"),
        Column("wall time [s]", "first_s", ".3g"),
        Column("processor time [s]", "first_cpu_s", ".3g"),
        Column("change in turned axes", "turned", ".1e"),
    ),
)
