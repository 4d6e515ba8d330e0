"""Messages: their definitions, and their bytes."""
