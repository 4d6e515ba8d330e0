"""What surrounds a craft: rotor wakes, wind, waves, current."""
