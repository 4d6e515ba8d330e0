"""A real boat's log plays into a system, and the two are compared."""
