"""A contact that outgrows its window is refused with its step, in a step that settles too."""

from types import SimpleNamespace

import pytest

from eigencontact.core.stopwatch import Stopwatch
from eigencontact.errors import DomainTooSmall
from eigencontact.execution.run.driver import _Course


def outgrown(_):
    raise DomainTooSmall("grid must hold the contact")


@pytest.mark.parametrize("settling", [False, True])
def test_the_step_is_noted(settling):
    plan = SimpleNamespace(
        scene=SimpleNamespace(friction=None, geometry=True, steps=[], bulk_at_rest={}), growth=None, steps=1, blocks=[]
    )
    course, step = _Course(plan, None, Stopwatch()), object()
    course._running = [(SimpleNamespace(name="contact", settles=True), SimpleNamespace(advance=outgrown))]
    with pytest.raises(DomainTooSmall) as caught:
        course.advance(step, settling=settling)
    assert caught.value.step is step
