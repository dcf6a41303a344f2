"""Finite-element models that judge the semi-analytical kernels; they import none of the code that they judge."""
