"""Checks of inclusion shapes: bounds that enclose it, in the body; an indicator that broadcasts."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from eigencontact.core.places import place_field
from eigencontact.halfspace.voxels import Voxels, volume_fractions
from eigencontact_verification.conformance.report import check, ensure, ensure_pure, place_of
from eigencontact_verification.conformance.sampling import evenly, inside, region, sample

#: What a thousand samples of a cell may miss of the part that a boundary cuts off it.
_SAMPLED = 0.05


@check
def check_bounds(shape: Any) -> None:
    """Bounds are two corners, low below high, and no point outside them is inside the shape."""
    corners = np.asarray(shape.bounds, dtype=float)
    ordered = corners.shape == (2, 3) and np.all(np.isfinite(corners)) and np.all(corners[0] < corners[1])
    ensure(
        ordered,
        "bounds",
        "((x, y, z) lowest, (x, y, z) highest), finite, in this order",
        shape.bounds,
        "return two tuples of three lengths [m]",
    )
    box = region(shape)
    around = box.center + 2 * (box.half + 0.05 * box.size) * evenly(4096)
    slack = 1e-9 * box.size
    out = np.any((around < box.low - slack) | (around > box.high + slack), axis=1)
    outside = around[out & inside(shape, around)]
    ensure(
        len(outside) == 0,
        "bounds",
        "around every point that contains accepts",
        f"{len(outside)} points outside them, the first at {place_of(outside)}",
        "widen bounds, or compare its centre with that of contains",
    )
    sample(shape)  # says so where contains is true nowhere


@check
def check_in_body(shape: Any) -> None:
    """The shape lies in the body, z >= 0: z points into it, the surface is z = 0."""
    lowest = region(shape).low[2]
    ensure(
        lowest >= 0,
        "the lowest z of bounds",
        "0 or more [m]",
        f"{lowest:.6g}",
        "give the component a deeper centre; a shape refuses what sticks out of the body in __post_init__",
    )


@check
def check_place(shape: Any) -> None:
    """Another value of the field annotated `Place` moves the shape by the difference, and changes nothing else."""
    name = place_field(type(shape))
    if name is None:
        return
    box = region(shape)
    shift = 4.0 * box.size * np.array([0.3, -0.7, 1.1])
    moved = replace(shape, **{name: tuple((np.array(getattr(shape, name), dtype=float) + shift).tolist())})
    error = np.abs(np.array(moved.bounds) - np.array(shape.bounds) - shift).max() / box.size
    ensure(
        error < 1e-9,
        f"bounds after {name} moved by {tuple(shift.tolist())}",
        "moved by the same",
        moved.bounds,
        "annotate with Place the field that says where the shape is, and no other",
    )
    probes = box.center + 1.2 * box.half * evenly(512)
    differing = np.flatnonzero(inside(shape, probes) != inside(moved, probes + shift))
    ensure(
        differing.size < 3,  # what rounding may bring to the other side of the boundary
        "contains of the moved shape at moved points",
        "what it was",
        f"{differing.size} of 512 points that differ, the first at {place_of(probes[differing])}",
        "count coordinates from the place",
    )


@check
def check_contains_arrays(shape: Any) -> None:
    """Answers are booleans of the broadcast shape: scalars, vectors, (nz, ny, nx), mixed, empty."""
    box = region(shape)
    ends = zip(box.center - 1.2 * box.half, box.center + 1.2 * box.half, (5, 4, 3), strict=True)
    x, y, z = (np.linspace(low, high, n) for low, high, n in ends)
    cases = {
        "numbers": (x[2], y[2], z[1]),
        "0-d arrays": (np.array(x[2]), np.array(y[2]), np.array(z[1])),
        "(1,)": (x[:1], y[:1], z[:1]),
        "(3,)": (x[:3], y[:3], z),
        "(1, 1, 5), (1, 4, 1), (3, 1, 1)": (x[None, None, :], y[None, :, None], z[:, None, None]),
        "(5,) and two numbers": (x, y[1], z[1]),
        "(0,)": (x[:0], y[:0], z[:0]),
    }
    whole = np.zeros(0, bool)
    for case, arguments in cases.items():
        answer = np.asarray(shape.contains(*arguments))
        expected = np.broadcast_shapes(*(np.shape(argument) for argument in arguments))
        ensure(
            answer.shape == expected and answer.dtype == bool,
            f"contains of {case}",
            f"booleans of shape {expected}",
            f"{answer.dtype} of shape {answer.shape}",
            "write it with numpy functions of whole arrays that broadcast",
        )
        if answer.ndim == 3:
            whole = answer
    single = np.array([[[bool(shape.contains(a, b, c)) for a in x] for b in y] for c in z])
    ensure(
        np.array_equal(whole, single),
        "contains of a grid",
        "what it says of each of its points alone",
        f"{int(np.sum(whole != single))} of {single.size} points that differ",
        "do not reduce over the points",
    )


@check
def check_contains_pure(shape: Any) -> None:
    """Same answer twice; inputs stay as they were, and may be read-only."""
    box = region(shape)
    points = np.ascontiguousarray((box.center + box.half * evenly(64)).T)
    ensure_pure("contains", lambda: shape.contains(*points), [points])


@check
def check_volume_fractions(shape: Any) -> None:
    """Fractions of the cells of a lattice are those that ``contains`` finds; of one that holds the shape and of a part.

    A shape may leave any lattice to ``contains``.
    """
    box = region(shape)
    edges = (box.high - box.low) / (4, 3, 2)
    samples = SimpleNamespace(key=shape.key, bounds=shape.bounds, contains=shape.contains)
    for low, size, cells in (
        (box.low - 0.5 * edges, edges, (3, 4, 5)),
        (box.low + 0.3 * (box.high - box.low), 0.4 * edges, (1, 2, 2)),
    ):
        (x, y, z), (dx, dy, dz) = low.tolist(), size.tolist()
        stated = shape.volume_fractions((x, y, z), (dx, dy, dz), cells)
        if stated is None:
            continue
        fractions = volume_fractions(shape, Voxels(low, size, cells))
        sampled = volume_fractions(samples, Voxels(low, size, cells))
        error = np.abs(fractions - sampled)
        k, j, i = np.unravel_index(int(error.argmax()), cells)
        ensure(
            error.max() < _SAMPLED,
            f"the fraction of cell (z, y, x) = {(int(k), int(j), int(i))} of {cells}",
            f"{sampled[k, j, i]:.3f} within {_SAMPLED}, as contains finds it",
            f"{fractions[k, j, i]:.3f}",
            "count cells from the corner low, in the order (nz, ny, nx)",
        )
