"""Fields of a step that only a contact with friction has."""

from __future__ import annotations

from eigencontact.plugin import FloatArray, SceneError, StepView

__all__ = ["friction_field"]


def friction_field(observer: str, step: StepView, name: str) -> FloatArray:
    """Field of a step ``(ny, nx)``; a step without friction is refused, `observer` is for the message."""
    if name not in step.fields:
        fields = ", ".join(sorted(step.fields))
        raise SceneError(
            f"{observer} must observe a contact with friction (got fields {fields}); add a table [friction]"
        )
    return step.fields[name]
