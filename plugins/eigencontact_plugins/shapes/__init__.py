"""Inclusion shapes: regions of the body that may carry an eigenstrain."""
