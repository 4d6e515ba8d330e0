"""Exit statuses of the commands."""

FAILED = 1
"""A criterion does not hold, or two runs differ."""
BAD_INPUT = 2
BROKEN = 3
"""The simulation could not go on, or was stopped."""
