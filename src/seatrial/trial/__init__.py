"""Trials: a rig, its events, its criteria, and the report."""
