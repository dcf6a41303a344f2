"""Search of a refused scene for keys that nothing reads, so that the message can name the nearest known key."""

from __future__ import annotations

import re
from typing import Any

from pydantic import BaseModel

from eigencontact.scene.annotations import class_within
from eigencontact.scene.messages import refuse_unknown

__all__ = ["find_unknown"]


def find_unknown(data: Any, model: type[BaseModel], where: str = "") -> None:
    """Raise `SceneError` for the first unknown key of `data` or of a table in it."""
    if not isinstance(data, dict):
        return
    if model.model_config.get("extra") != "allow":  # else other keys belong to a plugin, which checks them
        place = re.sub(r"\.\d+|\.cycle\b", "", where)
        refuse_unknown(data, model.model_fields, where, f"schema {place}".strip())
    for key, value in data.items():
        field = model.model_fields.get(key.replace("-", "_"))
        inner = None if field is None else class_within(field.annotation, lambda cls: issubclass(cls, BaseModel))
        if inner is not None:
            for number, item in enumerate(value if isinstance(value, list) else [value]):
                place = f"{where}.{key}".strip(".") + (f".{number}" if isinstance(value, list) else "")
                find_unknown(item, inner, place)
