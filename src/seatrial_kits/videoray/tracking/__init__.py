"""Velocities of a vessel: wanted, estimated, held."""
