"""Trials run: prepared, stepped, supervised, recorded."""
