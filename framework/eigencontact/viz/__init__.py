"""Pictures of results.

Functions that draw return a figure of matplotlib, and name their arguments alike:

- ``dataset``: results of a run, as `eigencontact.results.stored.open_stored` and xarray provide them, with the fields
  that the picture shows;
- ``step``: position along the dimension ``step``; by default the last;
- ``on``: frame of an animation to draw in (`eigencontact.viz.frame.Frame`). A history in a frame ends at ``step``;
  without a frame all steps are drawn.
"""
