"""How far a finite-element result may be from the exact solution, and what it then says about another result.

Three meshes give the discretisation error, two outer boundary conditions the error of truncating the half-space:

- *observed order* from the norms of both differences over the profile, and again in a moving window of five points,
  because the order near a source need not be that of the far field;
- *Richardson value* where the order is credible, the fine mesh elsewhere;
- *grid convergence index*: safety factor 1.25, and 3 where the order is not credible (below 0.5, more than two above
  the formal order) or the differences change sign from mesh to mesh; there the order in use is at least 1. The smaller
  of both orders counts, never more than the formal one. The difference that enters is the larger of fine-medium and
  medium-coarse brought to the fine mesh, and the largest among neighbours: where one difference happens to vanish, the
  error does not. Twice the scatter of both differences about the order in use is added to 1.25 times the difference
  (as Eça and Hoekstra add the deviation of their fit), and nowhere less than a tenth of the largest value of all
  components on the profile is used: both make the interval hold at all points together, which is what a verdict asks.
  Of all components, because they belong to one vector or tensor: axes turned by six degrees mix a tenth of one into
  another, and what is known of a field does not depend on how its axes are named;
- *truncation*: the mean of fixed and free outer faces is the value, half their distance the uncertainty. It is a smooth
  field of the size of the body, so nowhere less than half of its largest value on the profile is used. That the truth
  lies between both is an assumption (it holds exactly for a dilating ball in a concentric ball); check it with another
  reach where much depends on it.

The parts are *added*, not combined by root sum square: both are systematic errors of one model whose signs need not
be independent, and a sum of bounds is a bound. The price is at most a factor of 1.41.

References
----------
P. J. Roache, "Perspective: a method for uniform reporting of grid refinement studies", J. Fluids Eng. 116 (1994)
405-413, doi:10.1115/1.2910291. ASME V&V 20-2009, Standard for verification and validation in computational fluid
dynamics and heat transfer, section 2. L. Eça, M. Hoekstra, "A procedure for the estimation of the numerical uncertainty
of CFD calculations based on grid refinement studies", J. Comput. Phys. 262 (2014) 104-130,
doi:10.1016/j.jcp.2014.01.006 (orders below 0.5 are not credible).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Estimate", "Verdict", "estimate", "verdict", "verdicts"]

FloatArray = NDArray[np.float64]

#: Least order that is believed, and least that is used.
LOWEST_ORDER = 0.5
SAFETY, CAUTIOUS = 1.25, 3.0
#: Least discretisation error of a component at a point, as a part of the largest of all components on the profile.
FLOOR = 0.1
#: A component whose judged values stay below this part of the field is zero by symmetry.
ZERO = 1e-6


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimate:
    """Value of a field with its uncertainty.

    Attributes
    ----------
    value, uncertainty : (n,) or (n, components) float64
        The exact value is expected within ``value ± uncertainty`` at every point.
    order : (components,) float64
        Observed order over all points; nan where the meshes do not differ. One entry for a field of shape (n,).
    credible : (components,) bool
        Whether that order is believed.
    parts : dict of arrays like `value`
        ``"discretisation"``, ``"truncation"`` and ``"iteration"``: they add up to `uncertainty`.
    """

    value: FloatArray
    uncertainty: FloatArray
    order: FloatArray
    credible: NDArray[np.bool_]
    parts: dict[str, FloatArray]


def _window(values: FloatArray, half: int) -> FloatArray:
    """Each column's values at a point and its `half` neighbours on both sides: (2 half + 1, n, c), ends repeated."""
    index = np.arange(len(values))
    return np.stack([values[np.clip(index + shift, 0, len(values) - 1)] for shift in range(-half, half + 1)])


def _order(older: FloatArray, newer: FloatArray, ratio: float, axis: int) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Order from the norms of successive differences along `axis`, and whether they keep their sign."""
    before, after = np.linalg.norm(older, axis=axis), np.linalg.norm(newer, axis=axis)
    with np.errstate(divide="ignore", invalid="ignore"):
        order = np.log(before / after) / np.log(ratio)
    return order, np.sum(older * newer, axis=axis) > 0.0


def _believed(order: FloatArray, monotone: NDArray[np.bool_], formal: float) -> NDArray[np.bool_]:
    return monotone & (order >= LOWEST_ORDER) & (order <= formal + 2.0)


def estimate(
    coarse: ArrayLike,
    medium: ArrayLike,
    fine: ArrayLike,
    *,
    ratio: float,
    formal_order: float,
    other_outer: ArrayLike | None = None,
    other_level: Literal[0, 1, 2] = 2,
    iteration: float = 1e-7,
) -> Estimate:
    """Value and uncertainty of a finite-element field.

    Parameters
    ----------
    coarse, medium, fine : (n,) or (n, components)
        One field at the same points on three meshes; neighbours on the profile are neighbours in the arrays.
    ratio : float
        Element size over that of the next finer mesh, the same twice; > 1.
    formal_order : float
        Largest order to be used; observed ones above it are cut.
    other_outer : like `fine`, optional
        The field with the other condition on the outer faces (free if the meshes are fixed). Without it the
        uncertainty says nothing of truncation.
    other_level : {0, 1, 2}
        Mesh of `other_outer`: 0 coarse, 1 medium, 2 fine.
    iteration : float
        Error of the iterative solution as a part of the field's largest value.

    Returns
    -------
    Estimate
        Arrays of the shape of `fine`.

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 9)
    >>> meshes = [np.cos(x) + 0.1 * h**2 * np.exp(-x) for h in (0.4, 0.2, 0.1)]
    >>> found = estimate(*meshes, ratio=2.0, formal_order=2.0)
    >>> print(found.order.round(3), bool(np.all(abs(found.value - np.cos(x)) <= found.uncertainty)))
    [2.] True
    """
    meshes = [np.asarray(mesh, dtype=float) for mesh in (coarse, medium, fine)]
    shape = meshes[2].shape
    if not ratio > 1.0:
        raise ValueError(f"estimate ratio must be > 1 (got {ratio}); it is coarse over fine")
    if not formal_order >= LOWEST_ORDER:
        raise ValueError(f"estimate formal_order must be at least {LOWEST_ORDER} (got {formal_order}); see the element")
    if len(shape) not in (1, 2) or not shape[0] or any(mesh.shape != shape for mesh in meshes):
        shapes = [mesh.shape for mesh in meshes]
        raise ValueError(f"estimate meshes must share one shape (n,) or (n, c) (got {shapes}); use the same points")
    if other_outer is not None and np.shape(other_outer) != shape:
        raise ValueError(f"estimate other_outer must be {shape} (got {np.shape(other_outer)}); use the same points")
    c, m, f = (mesh.reshape(shape[0], -1) for mesh in meshes)
    scale = float(np.max(np.abs(f)))
    older, newer = c - m, m - f
    value, discretisation, order, credible = _discretisation(older, newer, f, ratio, formal_order, 1e-13 * scale)
    truncation = np.zeros_like(f)
    if other_outer is not None:
        half = (np.asarray(other_outer, dtype=float).reshape(f.shape) - (c, m, f)[other_level]) / 2.0
        value = value + half
        near = _window(np.abs(half), 1).max(axis=0)
        truncation = np.maximum(near, 0.5 * np.abs(half).max(axis=0))
    contributions = {
        "discretisation": discretisation.reshape(shape),
        "truncation": truncation.reshape(shape),
        "iteration": np.full(shape, iteration * scale),
    }
    return Estimate(
        value=value.reshape(shape), uncertainty=sum(contributions.values(), start=np.zeros(shape)), order=order,
        credible=credible, parts=contributions,
    )  # fmt: skip


def _discretisation(
    older: FloatArray, newer: FloatArray, fine: FloatArray, ratio: float, formal: float, tiny: float
) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.bool_]]:
    """Richardson value, grid convergence index, order and its credibility; arrays (n, c), (n, c), (c,), (c,)."""
    order, monotone = _order(older, newer, ratio, axis=0)
    zero = (np.abs(older) <= tiny).all(axis=0) & (np.abs(newer) <= tiny).all(axis=0)
    order = np.where(zero, np.nan, order)
    credible = zero | _believed(order, monotone, formal)

    local, local_credible = _order(_window(older, 2), _window(newer, 2), ratio, axis=0)
    local = np.where(np.isfinite(local), local, order)
    sound = credible & (zero | _believed(local, local_credible, formal))
    low = np.minimum(np.where(np.isfinite(order), order, formal), np.where(np.isfinite(local), local, formal))
    used = np.clip(low, np.where(sound, LOWEST_ORDER, min(formal, 1.0)), formal)

    difference = np.maximum(np.abs(newer), np.abs(older) / ratio**used)
    difference = _window(difference, 1).max(axis=0)
    scatter = np.sqrt(np.mean(_window(newer - older / ratio**used, 2) ** 2, axis=0))
    index = SAFETY * difference + 2.0 * scatter
    uncertainty = np.where(sound, index, np.maximum(index, CAUTIOUS * difference)) / (ratio**used - 1.0)
    uncertainty = np.maximum(uncertainty, FLOOR * uncertainty.max())
    whole = np.clip(np.where(np.isfinite(order), order, formal), LOWEST_ORDER, formal)
    value = np.where(sound, fine - newer / (ratio**whole - 1.0), fine)
    return value, uncertainty, order, credible


Word = Literal["agrees", "disagrees", "inconclusive"]


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """Verdict of a reference and its uncertainty on a judged component.

    Attributes
    ----------
    word : {"agrees", "disagrees", "inconclusive"}
        Inconclusive is no agreement.
    reason : str
        Why, in a few words.
    difference : float
        Largest absolute difference of judged and reference, in the unit of the field.
    uncertainty : float
        Largest uncertainty of the reference, in the unit of the field.
    ratio : float
        Largest difference over uncertainty at one point; above 1 they disagree.
    scale : float
        Largest value of the field: what the limit refers to.
    largest : float
        Largest value of this component of the reference.
    """

    word: Word
    reason: str
    difference: float
    uncertainty: float
    ratio: float
    scale: float
    largest: float


def verdict(
    judged: ArrayLike,
    estimate: Estimate,
    *,
    limit: float = 0.02,
    resolution: float = 0.25,
    small: float = 0.0,
    scale: float | None = None,
) -> Verdict:
    """Judge a field; of several components the worst verdict counts (`verdicts` gives all).

    Parameters
    ----------
    judged : (n,) or (n, components)
        The result in question at the points of `estimate`.
    estimate : Estimate
        The reference with its uncertainty.
    limit : float
        Largest uncertainty that allows agreement, as a part of the field's largest value.
    resolution : float
        Largest uncertainty that allows agreement, as a part of the component's own largest value, unless the component
        is zero: a reference that cannot tell a component from its double cannot confirm it.
    small : float
        Part of the field below which a component counts as if it had that size: what is confirmed is then that it is as
        small as it is said to be, not its shape.
    scale : float, optional
        Largest value of the field; by default that of all components given.

    Returns
    -------
    Verdict
        *disagrees* where the difference exceeds the uncertainty at any point, however large that is; otherwise
        *agrees* if the uncertainty is within both limits, else *inconclusive*.

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 9)
    >>> meshes = [np.cos(x) + 0.1 * h**2 for h in (0.4, 0.2, 0.1)]
    >>> found = estimate(*meshes, ratio=2.0, formal_order=2.0)
    >>> verdict(np.cos(x), found).word, verdict(1.01 * np.cos(x), found).word
    ('agrees', 'disagrees')
    """
    rank = ("disagrees", "inconclusive", "agrees")
    component_verdicts = verdicts(judged, estimate, limit=limit, resolution=resolution, small=small, scale=scale)
    return min(
        component_verdicts, key=lambda component_verdict: (rank.index(component_verdict.word), -component_verdict.ratio)
    )


def verdicts(
    judged: ArrayLike,
    estimate: Estimate,
    *,
    limit: float = 0.02,
    resolution: float = 0.25,
    small: float = 0.0,
    scale: float | None = None,
) -> tuple[Verdict, ...]:
    """`verdict` of each component.

    Examples
    --------
    >>> field = np.array([[1.0, 0.0], [2.0, 0.0]])
    >>> found = estimate(field, field, field, ratio=2.0, formal_order=2.0)
    >>> [one.word for one in verdicts(field + np.array([0.0, 0.1]), found)]
    ['agrees', 'disagrees']
    """
    values = np.asarray(judged, dtype=float)
    if values.shape != estimate.value.shape:
        raise ValueError(f"verdict judged must be {estimate.value.shape} (got {values.shape}); use the same points")
    n = len(values)
    value, band = estimate.value.reshape(n, -1), estimate.uncertainty.reshape(n, -1)
    field = float(np.max(np.abs(value))) if scale is None else float(scale)
    columns = zip(values.reshape(n, -1).T, value.T, band.T, strict=True)
    return tuple(_judge(*column, field=field, limit=limit, resolution=resolution, small=small) for column in columns)


def _judge(
    judged: FloatArray, value: FloatArray, band: FloatArray, *, field: float, limit: float, resolution: float,
    small: float,
) -> Verdict:  # fmt: skip
    difference, largest = np.abs(judged - value), float(np.max(np.abs(value)))
    band_top = float(np.max(band))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.where(difference == 0.0, 0.0, difference / band)
    ratio = float(np.max(ratios))
    zero = float(np.max(np.abs(judged))) <= ZERO * field
    word: Word = "inconclusive"
    if not np.isfinite(judged).all():
        word, reason, ratio = "disagrees", "the judged values are not all finite", float("inf")
    elif not (np.isfinite(value).all() and np.isfinite(band).all() and np.isfinite(field)):
        reason = "the reference is not finite everywhere"
    elif ratio > 1.0:
        word, reason = "disagrees", f"outside by a factor of {ratio:.3g} at the worst of {len(value)} points"
    elif band_top > limit * field:
        size = f"{100 * band_top / field:.2g} % of the field" if field > 0.0 else f"{band_top:.2g} in a field of zeros"
        reason = f"the uncertainty, {size}, exceeds the limit of {100 * limit:.3g} %"
    elif not zero and band_top > resolution * max(largest, small * field):
        reason = f"the uncertainty exceeds {100 * resolution:.3g} % of this small component"
    elif zero:
        word, reason = "agrees", "zero within the uncertainty"
    elif band_top > resolution * largest:
        word, reason = "agrees", "small, and within the uncertainty everywhere"
    else:
        word, reason = "agrees", "within the uncertainty everywhere"
    return Verdict(
        word=word, reason=reason, difference=float(np.max(difference)), uncertainty=band_top, ratio=ratio, scale=field,
        largest=largest,
    )  # fmt: skip
