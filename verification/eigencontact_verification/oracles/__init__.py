"""Closed forms and quadratures that share no code with what they judge."""
