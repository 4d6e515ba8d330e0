"""Multirotors that land on a moving deck by themselves: plant, sensors, control, decks."""
