"""Protocols as components, and what they share."""
