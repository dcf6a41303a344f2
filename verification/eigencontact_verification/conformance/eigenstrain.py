"""Checks of eigenstrain fields: Mandel vectors that broadcast, the same ones each time, as declared."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.conformance.report import check, ensure, ensure_pure
from eigencontact_verification.conformance.sampling import evenly

FloatArray = NDArray[np.float64]

_SCALES = (1e-6, 1e-3, 1.0)
_TIMES = (0.0, 0.5, 1.0, 1.5, 2.0, 5.0)


def _places(scale: float, count: int = 64) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points of the body within `scale` [m] of the origin."""
    x, y, z = scale * evenly(count).T
    return x, y, np.abs(z)


@check
def check_eigenstrain_arrays(field: Any) -> None:
    """Answers are finite Mandel vectors (6, ...) of the broadcast shape, each point for itself."""
    for scale in _SCALES:
        x, y, z = _places(scale, 12)
        cases = {
            "0-d arrays": (np.array(x[0]), np.array(y[0]), np.array(z[0])),
            "(1, 1, 1)": (x[:1, None, None], y[:1, None, None], z[:1, None, None]),
            "(12,)": (x, y, z),
            "(1, 1, 5), (1, 4, 1), (3, 1, 1)": (x[None, None, :5], y[None, :4, None], z[:3, None, None]),
            "(0,)": (x[:0], y[:0], z[:0]),
        }
        for case, arguments in cases.items():
            answer = np.asarray(field.eigenstrain(*arguments, 1.0))
            expected = (6, *np.broadcast_shapes(*(np.shape(argument) for argument in arguments)))
            ensure(
                answer.shape == expected and answer.dtype == np.float64 and np.all(np.isfinite(answer)),
                f"eigenstrain at points of shape {case}",
                f"finite float64 of shape {expected}",
                f"{answer.dtype} of shape {answer.shape}, finite: {bool(np.all(np.isfinite(answer)))}",
                "start from np.zeros((6, *np.broadcast_shapes(x.shape, y.shape, z.shape)))",
            )
        grid = np.asarray(field.eigenstrain(*cases["(1, 1, 5), (1, 4, 1), (3, 1, 1)"], 1.0))
        whole = np.broadcast_arrays(*cases["(1, 1, 5), (1, 4, 1), (3, 1, 1)"])
        ensure(
            np.array_equal(grid, np.asarray(field.eigenstrain(*whole, 1.0))),
            "eigenstrain of coordinates that broadcast",
            "that of the full arrays",
            "something else",
            "treat every point alike",
        )


@check
def check_eigenstrain_pure(field: Any) -> None:
    """Same answer twice; inputs stay as they were, and may be read-only; the answer is the caller's own."""
    points = np.array(_places(1e-3))
    ensure_pure("eigenstrain", lambda: field.eigenstrain(*points, 1.0), [points])
    answer = np.asarray(field.eigenstrain(*points, 1.0))
    saved = answer.copy()
    if answer.flags.writeable:
        answer[...] = -7.0
        ensure(
            np.array_equal(saved, np.asarray(field.eigenstrain(*points, 1.0))), "the answer", "an array of its own",
            "one that is kept and handed out again", "return a copy",
        )  # fmt: skip


@check
def check_declarations(field: Any) -> None:
    """`uniform` and `varies` are true to what eigenstrain returns, and zero amplitude is no eigenstrain."""
    at_times = np.array([[field.eigenstrain(*_places(scale), time) for time in _TIMES] for scale in _SCALES])
    if field.uniform:
        spread = np.max(np.abs(at_times - at_times[:1, :, :, :1]))
        ensure(
            spread == 0, "uniform", "False where the place matters", f"True, but it varies by {spread:.1e}", "set it"
        )
    if not field.varies:
        spread = np.max(np.abs(at_times - at_times[:, :1]))
        ensure(
            spread == 0, "varies", "True where time matters", f"False, but it varies by {spread:.1e}",
            "override the property",
        )  # fmt: skip
    for name in ("amplitude", "value"):
        if isinstance(getattr(field, name, None), float):
            from dataclasses import replace

            nothing = replace(field, **{name: 0.0}).eigenstrain(*_places(1e-3), 1.0)
            ensure(
                not np.any(nothing), f"eigenstrain with {name} = 0", "zero", f"up to {np.max(np.abs(nothing)):.1e}",
                "let it be a factor",
            )  # fmt: skip
