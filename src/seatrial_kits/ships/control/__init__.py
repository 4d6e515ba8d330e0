"""Autopilots of ships, and what they know of the motion."""
