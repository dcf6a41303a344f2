"""Reports: one self-contained HTML page about a run, made from its stored results."""
