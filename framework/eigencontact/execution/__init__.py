"""Driving a plan through its load history, step by step."""
