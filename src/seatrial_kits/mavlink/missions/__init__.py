"""Missions, fences and rally points: plans, their checks, their course."""
