"""Logs of real boats and of runs: formats, channels, and the quantities that they serve."""
