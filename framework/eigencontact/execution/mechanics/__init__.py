"""Contact of two bodies over their interiors, and fields of a contact other than pressure and shear."""
