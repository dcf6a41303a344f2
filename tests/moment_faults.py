"""Wrong factors in the potentials of polynomial densities over a ball, one family of densities each."""

from contextlib import contextmanager
from typing import NamedTuple
from unittest.mock import patch

import numpy as np

from eigencontact_plugins.shapes import sphere_moments

__all__ = ["FAULTS", "planted"]

SOUND = sphere_moments._potentials


class Row(NamedTuple):
    """r^(2k) R_l^m."""

    k: int
    l: int
    m: int


def scaled(where, names, factor):
    """The potentials of some sides with the rows of densities multiplied by a wrong factor."""

    def potentials(degree, side):
        sound = SOUND(degree, side)
        if side not in where:
            return sound
        rows = np.array([factor(Row(*indices[:3])) for indices in sphere_moments._densities(degree)])
        return {name: rows[:, None] * value if name in names else value for name, value in sound.items()}

    return potentials


def of_parity(parity, wrong):
    return lambda row: wrong(row) if row.l % 2 == parity else 1.0


def wrong_charge(row):
    """2l + 2k + 1 for 2l + 2k + 3."""
    return (2 * row.l + 2 * row.k + 3) / (2 * row.l + 2 * row.k + 1)


def wrong_inner(row):
    """2k + 2l + 2 for n + 2l + 1."""
    return (2 * row.k + 2 * row.l + 3) / (2 * row.k + 2 * row.l + 2)


def wrong_biharmonic(row):
    """2l + 5 for 2l + 3."""
    return (2 * row.l + 3) / (2 * row.l + 5)


OUTSIDE, ALL = (("outer", "image"), ("phi", "psi", "chi")), ("phi", "psi", "chi")
FAULTS = {
    "charge, even l": (*OUTSIDE, of_parity(0, wrong_charge)),
    "charge, odd l": (*OUTSIDE, of_parity(1, wrong_charge)),
    "Phi inside, even l": (("inner",), ("phi",), of_parity(0, wrong_inner)),
    "Phi inside, odd l": (("inner",), ("phi",), of_parity(1, wrong_inner)),
    "Psi inside, even l": (("inner",), ("psi",), of_parity(0, wrong_biharmonic)),
    "Psi inside, odd l": (("inner",), ("psi",), of_parity(1, wrong_biharmonic)),
    "image sign of l alone": (("image",), ALL, lambda row: (-1.0) ** row.m),
    "no image sign": (("image",), ALL, lambda row: (-1.0) ** (row.l + row.m)),
    "no image sign of Chi": (("image",), ("chi",), lambda row: (-1.0) ** (row.l + row.m)),
}


@contextmanager
def planted(fault):
    """A fault in the table of potentials; what is derived from the table is made anew before and after."""
    with patch.object(sphere_moments, "_potentials", scaled(*FAULTS[fault])):
        sphere_moments._derivatives.cache_clear()
        yield
    sphere_moments._derivatives.cache_clear()
