"""Work on stored runs: open them, compute another region, draw a chosen field; no contact is solved again."""
