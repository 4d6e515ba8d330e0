"""Cables: strain and bending of a line of nodes, and the tether made of it."""
