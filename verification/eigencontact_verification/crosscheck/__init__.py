"""Cross-check: every kernel against a finite-element model whose own error is known."""
