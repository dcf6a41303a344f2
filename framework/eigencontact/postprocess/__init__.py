"""Evaluations of stored runs without a new contact solution: open them, compute regions, draw fields."""
