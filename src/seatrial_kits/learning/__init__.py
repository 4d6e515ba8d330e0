"""Agents that learn in compiled copies of a system, and trained networks as components."""
