"""Depths and obstacles: a plane or a grid, and shapes that stand on it."""
