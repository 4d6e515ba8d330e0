"""Motions of a vessel planned from wanted speeds."""
