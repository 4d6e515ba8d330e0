"""Messages that a vehicle sends of itself."""
