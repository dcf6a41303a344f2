"""Figures, tables and claims of the thesis that the program implements, and the verdict on each claim."""
