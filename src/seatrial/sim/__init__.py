"""The master: rigs of slaves, stepped and recorded."""
