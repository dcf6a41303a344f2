"""Eigenstrain fields: uniform, tabulated over depth, thermal, peened layer, from a file."""
