"""Interiors: what lies below the surface and displaces it, prescribed or in answer to the tractions."""
