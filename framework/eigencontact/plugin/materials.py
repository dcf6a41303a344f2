"""Laws with parameters for each material of a surface, by its name in the scene."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import SceneError

__all__ = ["SUBSTRATE", "NamesMaterials", "by_material", "only_substrate"]

#: Name of what a body is made of where neither a layer nor an inclusion is.
SUBSTRATE = "substrate"


@runtime_checkable
class NamesMaterials(Protocol):
    """Optional ability of a friction or wear law: parameters by the name of the material.

    The program refuses a scene whose bodies have no material of such a name, and suggests the nearest name.
    """

    @property
    def materials(self) -> Collection[str]:
        """Names of the materials of the law."""
        ...


def only_substrate() -> NDArray[np.intp]:
    """Exposed material of a state without this information, ``(1, 1)``: the substrate everywhere."""
    return np.zeros((1, 1), dtype=np.intp)


def by_material(law: str, state: Any, names: Collection[str]) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """Each exposed material by name, with its cells ``(ny, nx)``.

    Parameters
    ----------
    law : str
        Name of the law for messages.
    state : FrictionState or WearState
        With ``material``, ``materials``, ``pressure``, ``x`` and ``y``.
    names : collection of str
        Materials of the law. Other materials may be exposed out of contact; the function omits them.

    Raises
    ------
    SceneError
        A material in contact without parameters in the law.
    """
    material = np.broadcast_to(state.material, state.pressure.shape)
    for number in np.unique(material):
        name, exposed = state.materials[number], np.asarray(material == number)
        if name in names:
            yield name, exposed
            continue
        unknown_cells = exposed & (state.pressure > 0)
        if unknown_cells.any():
            row, column = (int(index) for index in np.argwhere(unknown_cells)[0])
            raise SceneError(
                f"{law} must know every material in contact (got {', '.join(map(repr, names))}, and {name!r} at x = "
                f"{float(state.x[0, column]):.6g} m, y = {float(state.y[row, 0]):.6g} m); give it numbers for {name!r}"
            )
