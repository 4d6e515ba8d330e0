"""Equations of motion of craft."""
