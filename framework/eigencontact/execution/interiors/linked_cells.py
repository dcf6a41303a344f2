"""Selection of cells of history-dependent laws for second-order treatment."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.core.material import Material
from eigencontact.errors import EigencontactError
from eigencontact.execution.interiors.material_cells import MaterialCells
from eigencontact.plugin import ConstitutiveLaw, LawStep
from eigencontact.solvers.cell_conditions import compliance
from eigencontact.solvers.law_answers import answer_of
from eigencontact.solvers.second_order import Faces, linked_faces

__all__ = ["linked_cells"]

#: Relative difference below which a law has the constants of the matrix, at a stress of this part of Young's modulus.
_ELASTIC_TOLERANCE = 1e-6
_SMALL = 1e-9
#: Number of cells of a law that are tested.
_TESTED = 64


def linked_cells(
    content: MaterialCells,
    laws: Sequence[tuple[ConstitutiveLaw, IntArray]],
    places: tuple[FloatArray, FloatArray, FloatArray],
    matrix: Material,
) -> Faces | None:
    """Faces between whole cells of one law that has the constants of the matrix at the start.

    All other cells keep means: a contact over cells of other constants is well posed only with means.

    Parameters
    ----------
    content : MaterialCells
    laws : sequence of (ConstitutiveLaw, cells)
        Laws that are not linear, with the flat indices of their cells.
    places : tuple of arrays
        x, y, z of all cells [m].
    matrix : Material
    """
    whole = content.fraction.ravel() >= 1.0
    groups = []
    for law, cells in laws:
        tested = cells[:: -(-cells.size // _TESTED)]
        x, y, z = (axis[tested] for axis in places)
        if _begins_like(law, matrix, LawStep(x=x, y=y, z=z, time=1.0, duration=1.0)):
            groups.append(cells[whole[cells]])
    return linked_faces(groups, content.shape)


def _begins_like(law: ConstitutiveLaw, matrix: Material, step: LawStep) -> bool:
    """Whether the response of a law at rest to a small strain equals that of the matrix."""
    count = step.x.size
    stress = _SMALL * matrix.young_modulus * np.random.default_rng(0).standard_normal((6, count))
    before = {name: np.zeros((variable.components, count)) for name, variable in law.variables.items()}
    try:
        answer = answer_of(law, compliance(matrix) @ stress, before, step).stress
    except EigencontactError:
        return False
    difference = np.linalg.norm(answer - stress, axis=0)
    return bool(np.all(difference <= _ELASTIC_TOLERANCE * np.linalg.norm(stress, axis=0)))
