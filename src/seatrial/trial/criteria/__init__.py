"""Criteria: their grammar, and margins over records."""
