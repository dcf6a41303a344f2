"""Table of the tractions of a contact: names, directions, fields, and signs on each body."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["ALONG", "TRACTIONS", "Traction", "side"]


@dataclass(frozen=True, slots=True)
class Traction:
    """One component of the traction between the bodies.

    Attributes
    ----------
    name : str
        As influence plugins name it.
    direction : str
        In which it pushes body 1, and along which it displaces most: ``"x"``, ``"y"`` or ``"z"``.
    field : str
        Surface field that holds it.
    words : str
        For people.
    """

    name: str
    direction: str
    field: str
    words: str

    @property
    def row(self) -> int:
        """Place of its direction in arrays ``(3, ny, nx)``."""
        return "xyz".index(self.direction)


#: By name; the pressure first, as contacts without friction know no other.
TRACTIONS = {
    item.name: item
    for item in (
        Traction("p", "z", "pressure", "pressure p"),
        Traction("q_x", "x", "shear_x", "shear q_x"),
        Traction("q_y", "y", "shear_y", "shear q_y"),
    )
}
#: By direction.
ALONG = {item.direction: item for item in TRACTIONS.values()}


def side(body: int, direction: str) -> float:
    """Sign of a body's contribution to a relative quantity of the surfaces.

    Pressure loads both bodies alike, and their normal displacements add up. Shear acts on body 2 in the opposite
    direction, and its displacement along the surface counts negative.

    Examples
    --------
    >>> side(2, "z"), side(2, "x"), side(1, "x")
    (1.0, -1.0, 1.0)
    """
    return -1.0 if body == 2 and direction != "z" else 1.0
