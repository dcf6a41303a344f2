"""Constrained solvers of contact problems, one algorithm per file."""
