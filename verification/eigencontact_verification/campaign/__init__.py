"""Campaigns over parameters: where in the space of parameters a model is as good as its file says, and where not."""
