"""Lines along which a run of a line contact is compared with finite elements, and the run's own error there.

Values stand for means over strips, and may differ from the middle by an eighth of the second difference between
neighbours (`contact_lines`). The half width is a zero of the squared pressure, known to a tenth of a strip where it is
that of a smooth contact (Hertz: 0.01, from fewer strips 0.07), else to half a strip: where shear presses, runs differ
from the elements by up to 0.4. Where a body yields the pressure ends flat: runs of
'plastic-line-contact' with 12 and 16 strips differ from one with 24 by up to 1.1 of their strips. Where cells cut
regions of other constants, their boundary may be off by half a cell: what they cause is uncertain by its change over
half a cell along both axes.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.line_scene import StoredLine
from eigencontact_verification.audit.lines import spread
from eigencontact_verification.audit.stored_profile import Form, StoredProfile, stored_profile
from eigencontact_verification.oracles.line_contact import flamant

__all__ = ["line_profiles"]

FloatArray = NDArray[np.float64]

#: Surface within this part of the half width is compared, and stress at these depths, in it.
_INNER, _SHALLOW, _FARTHEST = 0.8, 0.2, 2.4
_POINTS = 40
#: Depth of the history of stress below a geometry that travels, in half widths: of the largest orthogonal shear.
_LOADED = 0.5
#: Parts of a strip by which the half width may be wrong where a body yields, and of a smooth contact.
_PLASTIC, _SMOOTH = 1.25, 0.1
#: Contacts are compared in width from this part of the widest.
_WIDE = 0.6
#: Part by which loads of steps may differ and count as one.
_LOAD_TOLERANCE = 1e-4
_MEAN = 1 / 8
#: Distance from boundaries of regions and of layers that stress is compared from, and of columns, in half widths.
_MARGIN, _THIN, _APART = 0.1, 0.02, 0.1
#: Distance of a point from the middle of a cell, in its height.
_MIDDLE = 0.1
_FORMS: dict[str, Form] = {
    "half width": ("strain", "step [1]", ("a",), "largest a"),
    "pressure": ("stress", "x [m]", ("s_zz",), "Pa"),
    "shear": ("stress", "x [m]", ("s_xz",), "Pa"),
    "slip": ("displacement", "x [m]", ("u_x",), "m"),
    "stress": ("stress", "z [m]", ("s_xx", "s_yy", "s_zz", "s_xz"), "Pa"),
    "history of stress": ("stress", "step [1]", ("s_xx", "s_yy", "s_zz", "s_xz"), "Pa"),
    "plastic strain": ("strain", "z [m]", ("e_p",), "1"),
}
_line = partial(stored_profile, _FORMS)


def line_profiles(stored: StoredLine) -> list[StoredProfile]:
    """Half width, pressure, shear, slip, columns of stress and of plastic strain."""
    a, last = stored.half_width, len(stored.load) - 1
    peak, pulled = _first_largest(stored.load), _first_largest(np.abs(stored.force))
    compared = list(dict.fromkeys((peak, pulled, last)))
    wide = np.flatnonzero(a > _WIDE * a.max())
    if stored.travels:  # the elements are small at the edges of the contact in the compared steps
        compared = sorted({peak, last, int(wide[np.abs(stored.place[wide]).argmin()])})
        wide = np.intersect1d(wide, compared)
    widths = np.stack((wide + 1.0, 0 * wide, 0 * wide), axis=1)
    scale = float(a.max())
    strips = _PLASTIC if stored.yields else _SMOOTH if stored.smooth else 0.5
    half = np.full(wide.size, strips * stored.cell / scale)
    lines = [
        _line("half width", "half width", widths, widths[:, 0], a[wide] / scale, half, tuple(int(k) for k in wide))
    ]
    for kind, field, sign in (("pressure", "pressure", -1.0), ("shear", "shear_x", 1.0), ("slip", "slip_x", 1.0)):
        steps = (peak,) if kind == "pressure" else (pulled, last)
        for k in compared if stored.travels else dict.fromkeys(steps):
            values = stored.fields.get(field, 0 * stored.load[:, None] * stored.x)[k]
            chosen = spread(np.flatnonzero(np.abs(stored.x - stored.place[k]) < _INNER * a[k]), _POINTS)
            if np.any(values[chosen]):
                points = np.stack((stored.x[chosen], 0 * stored.x[chosen], 0 * stored.x[chosen]), axis=1)
                error = np.maximum(_bend(values)[chosen], _bend(values)[chosen].mean())
                if kind == "pressure" and any(body["cut"] for body in stored.scene["bodies"]):
                    error = error + _by_regions(stored, k)[chosen]
                name = f"{kind}, step {k + 1}"
                lines.append(_line(kind, name, points, stored.x[chosen], sign * values[chosen], error, (k,)))
    for k in compared:
        lines += _stress(stored, k)
    return lines + (_histories(stored) if stored.travels else []) + _strains(stored)


def _by_regions(stored: StoredLine, k: int) -> FloatArray:
    """Change over half a cell of what distinguishes the pressure from an ellipse, and half of its largest."""
    a, p, x = stored.half_width[k], stored.fields["pressure"][k], stored.x - stored.place[k]
    ellipse = 2 * stored.load[k] / (np.pi * a) * np.sqrt(np.maximum(0.0, 1 - (x / a) ** 2))
    change = stored.pitch / 2 * np.abs(np.gradient(p - ellipse, x))
    inner = np.abs(x) < _INNER * a
    return np.asarray(np.maximum(change, change[inner].max() / 2))


def _first_largest(values: FloatArray) -> int:
    """First step whose value is the largest but for the tolerance of a load."""
    return int(np.flatnonzero(values >= (1 - _LOAD_TOLERANCE) * values.max())[0])


def _stress(stored: StoredLine, k: int) -> list[StoredProfile]:
    """Columns of a section in the middle, near the left edge of the contact (largest tension), and through regions."""
    numbers = [body["number"] for body in stored.scene["bodies"]]
    a = float(stored.half_width.max())
    lines = []
    for region in stored.regions[k]:
        if region.axes != ("z", "x") or region.body not in numbers:
            continue
        body = stored.scene["bodies"][numbers.index(region.body)]
        for place, where in _columns(body, a):
            column = int(np.abs(region.points[0, :, 0] - place).argmin())
            points, stress = region.points[:, column], region.stress[:, column][:, [0, 1, 2, 4]]
            good = (points[:, 2] > max(_SHALLOW * a, 2 * stored.cell)) & (points[:, 2] < _FARTHEST * a)
            good &= _clear(stored, body, points, a)
            chosen = spread(np.flatnonzero(good), _POINTS)
            if chosen.size < 5:
                continue
            error = np.stack([_bend(component, good) for component in stress.T], axis=1)
            if body["cut"]:
                beside = np.clip(column + np.array([-1, 0, 1]), 0, region.points.shape[1] - 1)
                caused = [
                    region.stress[:, at][:, [0, 1, 2, 4]] - _homogeneous(stored, k, body, region.points[:, at])
                    for at in beside
                ]
                across = [
                    np.abs(cause - caused[1]) / max(np.ptp(region.points[0, [column, at], 0]), stored.cell / 2)
                    for cause, at in zip(caused, beside, strict=True)
                ]
                change = np.abs(np.gradient(caused[1], points[:, 2], axis=0)) + np.maximum(across[0], across[2])
                padded = np.pad(change, ((1, 1), (0, 0)), mode="edge")  # where a change happens to vanish no error does
                error += stored.pitch / 2 * np.maximum.reduce([padded[:-2], change, padded[2:]])
            error = np.maximum(error, error[good].max(axis=0) / 2)[chosen]
            name = f"stress {where}, step {k + 1}, {region.name}"
            number = numbers.index(region.body) + 1
            lines.append(_line("stress", name, points[chosen], points[chosen, 2], stress[chosen], error, (k,), number))
    return lines


def _histories(stored: StoredLine) -> list[StoredProfile]:
    """Stress over the steps half of a half width below the middle of a section, over which the geometry travels."""
    numbers = [body["number"] for body in stored.scene["bodies"]]
    a = float(stored.half_width.max())
    steps = spread(np.arange(len(stored.load)), _POINTS)
    lines = []
    for at, region in enumerate(stored.regions[0]):
        if region.axes != ("z", "x") or region.body not in numbers:
            continue
        body = numbers.index(region.body)
        column = int(np.abs(region.points[0, :, 0]).argmin())
        points = region.points[:, column]
        row = int(np.abs(points[:, 2] - _LOADED * a).argmin())
        if not _clear(stored, stored.scene["bodies"][body], points[row : row + 1], a).all():
            continue
        columns = np.stack([stored.regions[k][at].stress[:, column][:, [0, 1, 2, 4]] for k in steps])
        error = np.stack([[_bend(component)[row] for component in values.T] for values in columns])
        along = np.broadcast_to(points[row], (steps.size, 3))
        error = np.maximum(error, error.max(axis=0) / 2)
        moments = tuple(int(k) for k in steps)
        name, number = f"history of stress, {region.name}", np.asarray(steps + 1.0, dtype=float)
        lines.append(_line("history of stress", name, along, number, columns[:, row], error, moments, body + 1))
    return lines


def _columns(body: dict[str, Any], a: float) -> list[tuple[float, str]]:
    """Places x of columns, and words for them."""
    columns = [(0.0, "in the middle"), (-0.9 * a, "near the edge")]
    for number, region in enumerate(body["regions"], 1):
        if region["kind"] != "layer":
            x = region["x"] if region["kind"] == "ellipse" else (region["left"] + region["right"]) / 2
            if all(abs(x - place) > _APART * a for place, _ in columns):
                columns.append((x, f"through region {number}"))
    return columns


def _clear(stored: StoredLine, body: dict[str, Any], points: FloatArray, a: float) -> NDArray[np.bool_]:
    """Points away from the boundaries of regions; among cells of other constants only those in the middle of one."""
    x, z = points[:, 0], points[:, 2]
    good = np.ones(len(x), dtype=bool)
    margin = max(_MARGIN * a, 1.5 * stored.pitch if body["cut"] else 0.0)
    for region in body["regions"]:
        near = _THIN * a if region["kind"] == "layer" else margin
        good &= ~_inside(region, x, z, near) | _inside(region, x, z, -near)
    if body["cut"]:
        middles_x, middles_z = stored.middles[body["number"]]
        h = float(np.diff(middles_z).max(initial=0.0)) or stored.cell
        among = (np.abs(x - (middles_x[0] + middles_x[-1]) / 2) < (middles_x[-1] - middles_x[0]) / 2 + stored.cell) & (
            np.abs(z - (middles_z[0] + middles_z[-1]) / 2) < (middles_z[-1] - middles_z[0]) / 2 + 0.6 * h
        )
        good &= ~among | (np.abs(z[:, None] - middles_z).min(axis=1) < _MIDDLE * h)
    return good


def _inside(region: dict[str, Any], x: FloatArray, z: FloatArray, margin: float) -> NDArray[np.bool_]:
    """Whether points lie in a region that is larger by a margin all around."""
    if region["kind"] == "ellipse":
        half = region["half_width"] + margin, region["half_height"] + margin
        far = ((x - region["x"]) / half[0]) ** 2 + ((z - region["depth"]) / half[1]) ** 2
        return np.asarray((far < 1.0) & (min(half) > 0))
    left, right = region.get("left", -np.inf), region.get("right", np.inf)
    top = region["top"] or -np.inf  # the surface is no boundary between materials
    return np.asarray((x > left - margin) & (x < right + margin) & (z > top - margin) & (z < region["bottom"] + margin))


def _homogeneous(stored: StoredLine, k: int, body: dict[str, Any], points: FloatArray) -> FloatArray:
    """Stress (n, 4) of a homogeneous body under the stored tractions of a step, by line forces in the strips."""
    x, z = points[:, 0, None] - stored.x, np.maximum(points[:, 2], stored.cell)[:, None]
    along_z, along_x = flamant(x, np.broadcast_to(z, x.shape))
    sign = 1 if body["number"] == 1 else -1
    shear = stored.fields["shear_x"][k] if "shear_x" in stored.fields else 0 * stored.x
    xx, zz, xz = stored.cell * (along_z @ stored.fields["pressure"][k] + sign * (along_x @ shear))
    return np.stack((xx, body["poisson_ratio"] * (xx + zz), zz, sign * xz), axis=1)


def _strains(stored: StoredLine) -> list[StoredProfile]:
    """Columns of cells in the middle and near the left edge of the contact, after the last step."""
    numbers = [body["number"] for body in stored.scene["bodies"]]
    a, last = float(stored.half_width.max()), len(stored.load) - 1
    lines = []
    for strain in stored.strains:
        deep = np.flatnonzero((strain.z > _SHALLOW * a) & (strain.z < _FARTHEST * a))
        for place, where in ((0.0, "in the middle"), (-0.9 * a, "near the edge")):
            column = int(np.abs(strain.x - place).argmin())
            chosen = spread(deep, _POINTS)
            values = strain.values[chosen, column]
            if chosen.size < 5 or not values.any():
                continue
            z = strain.z[chosen]
            points = np.stack((np.full_like(z, strain.x[column]), 0 * z, z), axis=1)
            error = np.maximum(_bend(strain.values[:, column]), _bend(strain.values[:, column]).max() / 2)[chosen]
            body = numbers.index(strain.body) + 1
            name = f"plastic strain {where}, step {last + 1}, body {strain.body}"
            lines.append(_line("plastic strain", name, points, z, values, error, (last,), body))
    return lines


def _bend(values: FloatArray, good: NDArray[np.bool_] | None = None) -> FloatArray:
    """An eighth of the second difference, the largest of three neighbours; 0 where it needs what is not good."""
    padded = np.pad(values, 1, mode="reflect", reflect_type="odd")
    second = _MEAN * np.abs(np.diff(padded, 2))
    if good is not None:
        whole = np.pad(good, 1, mode="edge")
        second[~(whole[:-2] & good & whole[2:])] = 0.0
    return np.asarray(np.maximum.reduce([second, np.roll(second, 1), np.roll(second, -1)]))
