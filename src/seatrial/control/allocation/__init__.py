"""Forces shared out among thrusters."""
