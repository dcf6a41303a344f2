"""Numerical stability at the corners of the parameter space: `eigencontact extremes`.

A feature is one file of `features`: it declares its corners, what each is compared with, and the bound with its reason.
"""
