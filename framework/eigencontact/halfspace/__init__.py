"""The half-space theorem: from a shape's potentials to displacement, strain and stress under a free surface."""
