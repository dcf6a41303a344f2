"""Stored results: one file per run that xarray opens, a summary, VTK."""
