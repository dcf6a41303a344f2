"""Hardening laws."""
