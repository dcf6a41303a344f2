"""Vocabulary shared by every layer: grids, tensors, materials, quantities. No physics, no I/O."""
