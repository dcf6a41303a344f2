"""Fatigue criteria."""
