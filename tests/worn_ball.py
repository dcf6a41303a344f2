"""A ball that slides and wears: numbers of case WR-9, by rings in implicit steps."""

#: Worn volume over π a⁴/4R: largest pressure over p0, depth over a²/R, contact radius over a.
SLIDING = {
    0.01: (0.9967, 0.00374, 1.005),
    0.1: (0.9674, 0.03688, 1.040),
    1.0: (0.7200, 0.31907, 1.215),
    10.0: (0.2182, 1.50099, 1.840),
    100.0: (0.0670, 4.95873, 3.180),
}
