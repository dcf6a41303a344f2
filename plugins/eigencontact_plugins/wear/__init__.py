"""Wear laws."""
