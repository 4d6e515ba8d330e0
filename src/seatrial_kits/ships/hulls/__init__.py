"""Equations of ships."""
