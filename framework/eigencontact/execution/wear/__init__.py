"""Surfaces that wear: rates, state, jumps over cycles, and the blocks before and after the contact."""
