"""The contact of two bodies over their interiors, and the fields that a contact has besides pressure and shear."""
