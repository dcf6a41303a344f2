"""Questions to a constitutive law: strains of every size at places of every size, at rest and after a history."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import wraps
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import SceneError
from eigencontact.plugin import LawStep, LinearLaw, Response
from eigencontact_verification.conformance.report import Check, check

__all__ = [
    "Question",
    "along",
    "answered",
    "finite",
    "history",
    "law_check",
    "law_of_points",
    "pairs",
    "parts",
    "some_strains",
    "state_at_rest",
    "step_at",
    "stress_check",
]

FloatArray = NDArray[np.float64]

#: Points of a question, increments before the last one, and decades of strain and of length [m].
_POINTS, _INCREMENTS = 24, 4
_STRAINS, _LENGTHS = (-6.0, -2.0), (-8.0, -2.0)
#: Young's modulus [Pa] and Poisson's ratio of the body in which a law is asked that lacks them.
_BODY = (7e10, 0.3)


def law_check(function: Check) -> Check:
    """Turn a function of a law into a check; the law is that in a body, where it asks for one."""

    @wraps(function)
    def run(law: Any) -> None:
        function(law.of_body(*_BODY))

    return check(run)


def stress_check(function: Check) -> Check:
    """Turn a function of a law into a check of laws whose stress follows from strain; see `finite`."""

    @wraps(function)
    def run(law: Any) -> None:
        if finite(law):
            function(law)

    return law_check(run)


@dataclass(frozen=True, slots=True, eq=False)
class Question:
    """Input of a law: strain ``(6, n)``, variables before, where and when."""

    strain: FloatArray
    before: Mapping[str, FloatArray]
    step: LawStep

    @property
    def count(self) -> int:
        """Number of points."""
        return int(self.strain.shape[1])


def some_strains(count: int = _POINTS, seed: int = 0) -> FloatArray:
    """Random Mandel strains ``(6, n)`` from 1e-6 to 1e-2; the first are a dilatation, a shear, a pull and a push."""
    rng = np.random.default_rng(seed)
    out = rng.standard_normal((6, count))
    out *= 10.0 ** rng.uniform(*_STRAINS, count) / np.linalg.norm(out, axis=0)
    pure = np.zeros((6, 4))
    pure[[0, 1, 2, 3, 0, 2], [0, 0, 0, 1, 2, 3]] = 0.9173e-3 * np.array([1.0, 1.0, 1.0, 1.0, 1.0, -1.0])
    count_of_cases = min(count, 4)
    out[:, :count_of_cases] = pure[:, :count_of_cases]
    return out


def step_at(count: int = _POINTS, *, time: float = 1.0, duration: float = 1.0) -> LawStep:
    """Random places, 10 nm to 1 cm from the origin, below the surface."""
    rng = np.random.default_rng(7)
    x, y, z = rng.choice([-1.0, 1.0], (3, count)) * 10.0 ** rng.uniform(*_LENGTHS, (3, count))
    return LawStep(x=x, y=y, z=np.abs(z), time=time, duration=duration)


def state_at_rest(law: Any, count: int) -> dict[str, FloatArray]:
    """Variables at rest: zero."""
    return {name: np.zeros((variable.components, count)) for name, variable in law.variables.items()}


def law_of_points(law: Any, step: LawStep) -> Any:
    """Law of the points of a step."""
    return law.at(step.x, step.y, step.z)


def finite(law: Any) -> bool:
    """Whether stress follows from strain: not in rigid solids, nor in incompressible ones."""
    try:
        linear = law_of_points(law, step_at())
        if isinstance(linear, LinearLaw):
            linear.stiffness_matrix()
    except SceneError:
        return False
    return True


def answered(law: Any, question: Question) -> Response:
    """Answer of a law, with a tangent for each point, ``(6, 6, n)``."""
    answer = law.update(question.strain, question.before, question.step)
    tangent = np.asarray(answer.tangent, dtype=float)
    tangent = np.broadcast_to(tangent if tangent.ndim == 3 else tangent[..., None], (6, 6, question.count))
    return Response(stress=np.asarray(answer.stress, dtype=float), tangent=tangent, variables=answer.variables)


def history(law: Any, count: int = _POINTS) -> Iterator[tuple[Question, Response]]:
    """Increments that go to a random strain each, with their answers; each begins where the last has ended."""
    before = state_at_rest(law, count)
    sizes = np.linalg.norm(some_strains(count), axis=0)
    for number in range(1, _INCREMENTS + 1):
        strain = some_strains(count, seed=number)
        strain *= sizes * (1.0 + 0.2 * number) / np.linalg.norm(strain, axis=0)
        strain = some_strains(count) if number == 1 else strain
        question = Question(strain, before, step_at(count, time=0.5 * number, duration=0.5))
        answer = answered(law, question)
        yield question, answer
        before = dict(answer.variables)


def along(law: Any, path: FloatArray) -> Iterator[Response]:
    """Answers along paths of strain ``(increments, 6, n)`` that begin at rest."""
    before = state_at_rest(law, path.shape[2])
    for number, strain in enumerate(path, 1):
        question = Question(strain, before, step_at(path.shape[2], time=number / len(path), duration=1.0 / len(path)))
        answer = answered(law, question)
        yield answer
        before = dict(answer.variables)


def parts(response: Response) -> list[FloatArray]:
    """Arrays of an answer."""
    return [response.stress, response.tangent, *(response.variables[name] for name in sorted(response.variables))]


def pairs(first: Response, second: Response) -> list[tuple[str, FloatArray, FloatArray]]:
    """Parts of two answers, by name."""
    names = ["stress", "tangent", *(f"variable {name!r}" for name in sorted(first.variables))]
    return list(zip(names, parts(first), parts(second), strict=True))
