"""Answers of laws of the contact that are no array of the pressure's shape, and the words of their refusal."""

import sys

import numpy as np


def wrong_answers(shape, unit, places, written):
    """Answers by case, for arrays with this unit at these `places`; `written` names the array that a law writes to."""
    fails = r"must return without an exception \(got "
    finite = rf"must be zero or positive, and finite \[{unit}\] \(got"

    def poison(state):
        array = getattr(state, written)
        array[0, 0] = 1.0
        return array

    return {
        "shape": (np.ones((5, 3)), r"must be of shape \(3, 5\), that of the pressure \(got shape \(5, 3\)\)"),
        "a number": (1.0, r"must be of shape \(3, 5\), that of the pressure \(got shape \(\)\)"),
        "NaN": (
            lambda state: np.where(state.x > 0, np.nan, state.pressure),
            rf"{finite} nan at x = 1e-06 m, y = -1e-06 m, and at 6 of 15 {places}",
        ),
        "infinite": (np.full(shape, np.inf), rf"{finite} inf at x = -2e-06 m"),
        "negative": (lambda state: -1.0 - state.pressure, rf"{finite} -1"),
        "error": (lambda state: 1 / len(state.x[1:]), rf"{fails}ZeroDivisionError: division by zero, line"),
        "booleans": (np.ones(shape, dtype=bool), r"must be an array, real numbers \(got booleans"),
        "masked": (np.ma.masked_all(shape), r"must return no masked values \(got 15\)"),
        "leaves": (lambda _: sys.exit(0), rf"{fails}SystemExit: 0, line"),
        "text": ("much", r"must be an array, real numbers \(got text"),
        "writes": (poison, rf"{fails}ValueError: assignment destination is"),
    }
