"""Shapes of vehicles, for pages and records in three dimensions."""
