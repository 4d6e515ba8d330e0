"""Rigs, vehicles and profiles as files, and the system that they make."""
