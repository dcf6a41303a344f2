"""Parameter studies: the trends of the literature, computed anew and drawn, one file of data and one command each."""
