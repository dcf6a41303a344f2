"""Messages of solvers about a step, with the table and the key of the scene."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from eigencontact.core.rigid_modes import NORMAL_MODES, TANGENTIAL_MODES
from eigencontact.errors import NotConverged, SceneError
from eigencontact.scene.steps import Step, named_ramps

__all__ = ["keys_of_scene"]

_NAMES = [name for mode in (*NORMAL_MODES, *TANGENTIAL_MODES) for name in mode]


@contextmanager
def keys_of_scene(steps: Sequence[Step], ramp: int | None = None, load_step: int | None = None) -> Iterator[None]:
    """Context in which a message about ``step.shift_x`` names the key of the scene, ``steps.2.shift-x``.

    Parameters
    ----------
    steps : sequence of Step
        As of a scene.
    ramp : int, optional
        Number of the ramp that is solved; by default the first that prescribes the value.
    load_step : int, optional
        Number of the load step, for the message.

    Examples
    --------
    >>> with keys_of_scene([Step(normal_load=1.0), Step(shift_x=1e-6, increments=9)], ramp=1, load_step=7):
    ...     raise SceneError("step.shift_x must be smaller (got 1e-06)")
    Traceback (most recent call last):
    eigencontact.errors.SceneError: steps.1.shift-x, at load step 7, must be smaller (got 1e-06)
    """
    try:
        yield
    except (SceneError, NotConverged) as problem:
        words = str(problem)
        if about := re.match(rf"step\.({'|'.join(_NAMES)})\b", words):
            named = named_ramps(steps)
            giving = [number for number, (_, step) in enumerate(named) if getattr(step, about[1]) is not None]
            # A ramp that does not prescribe a value keeps that of the ramp before.
            number = giving[0] if ramp is None else max((item for item in giving if item <= ramp), default=ramp)
            tail = re.sub(rf"\b({'|'.join(_NAMES)})\b", lambda name: name[0].replace("_", "-"), words[about.end() :])
            at = "" if load_step is None else f", at load step {load_step},"
            problem.args = (f"{named[number][0]}.{about[1].replace('_', '-')}{at}{tail}", *problem.args[1:])
        raise
