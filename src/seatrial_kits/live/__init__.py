"""Runs to look at: a scene in three dimensions, live, played back and in reports."""
