"""Electronics profiles."""
