"""Cables and tethers."""
