"""Autopilots and what they are made of."""
