"""Inclusion shapes: regions of the body with an eigenstrain or another material."""
