"""Geometries: the initial separation of two surfaces."""
