"""Features: one file each, with its corners, references and bounds."""
