"""Distribution of one number of a profile over the components of a strain."""

from __future__ import annotations

from typing import Literal

from eigencontact.plugin import FloatArray, Row, mandel_strain, require

__all__ = ["Direction", "directed"]


#: How one number is spread over the components: all three alike, along the surface alone, or by three weights.
Direction = Literal["isotropic", "in-plane"] | Row


def directed(key: str, direction: Direction) -> FloatArray:
    """Mandel vector ``(6,)`` that one number of a profile multiplies."""
    directions = {"isotropic": 1.0, "in-plane": (1.0, 1.0, 0.0)}
    if isinstance(direction, str):
        require(direction in directions, key, "direction", direction, "'isotropic', 'in-plane' or three numbers")
        return mandel_strain(key, "direction", directions[direction])  # type: ignore[arg-type]
    return mandel_strain(key, "direction", direction)
