"""Environment of a craft: rotor wakes, wind, step disturbances."""
