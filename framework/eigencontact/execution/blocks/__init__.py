"""Blocks as they are planned: inputs, outputs, cost and precision; load steps and increments."""
