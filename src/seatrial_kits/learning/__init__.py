"""Agents that learn in compiled copies of a system."""
