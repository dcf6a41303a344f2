"""Fields of a step that require a contact with friction."""

from __future__ import annotations

from eigencontact.plugin import FloatArray, SceneError, StepView

__all__ = ["friction_field"]


def friction_field(observer: str, step: StepView, name: str) -> FloatArray:
    """Field of a step ``(ny, nx)``; refuses a step without friction, with the name of the `observer` in the message."""
    if name not in step.fields:
        fields = ", ".join(sorted(step.fields))
        raise SceneError(
            f"{observer} must observe a contact with friction (got fields {fields}); add a table [friction]"
        )
    return step.fields[name]
