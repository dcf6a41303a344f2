"""Benchmarks: whole solves against bare FFTs and against other codes."""
