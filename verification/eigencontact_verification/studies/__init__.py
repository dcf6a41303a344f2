"""Parameter studies: the trends of a chapter of the literature, computed anew and drawn, one command each."""
