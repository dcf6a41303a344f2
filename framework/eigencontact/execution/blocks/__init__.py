"""Base of the blocks of a run: inputs, outputs, cost and precision; load steps and increments."""
