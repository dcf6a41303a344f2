"""Tangential contact with friction: shear tractions bounded by a friction law, stick and slip, load history."""
