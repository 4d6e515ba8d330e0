"""The vehicle at constant depth, its thrusters, and what disturbs it."""
