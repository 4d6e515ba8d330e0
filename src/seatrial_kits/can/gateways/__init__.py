"""Gateways: programs on the simulated bus, each by its own protocol."""
