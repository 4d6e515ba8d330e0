"""Trials: a rig, what happens to it, what must hold, and the report."""
