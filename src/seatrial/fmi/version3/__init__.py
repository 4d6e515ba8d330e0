"""FMI 3.0 in front of FMI 2.0: C that any of our libraries can carry, and its description."""
