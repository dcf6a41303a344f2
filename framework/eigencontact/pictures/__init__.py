"""Pictures that a user chooses: one field of stored results as a figure or as a file."""
