"""Constrained solvers of contact problems, one algorithm a file."""
