"""Velocities and trajectories of vessels held."""
