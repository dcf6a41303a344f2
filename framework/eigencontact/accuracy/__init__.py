"""Errors of the numbers of a run, estimated from coarser runs of the same scene."""
