"""Autopilots that pitch an underwater vehicle."""
