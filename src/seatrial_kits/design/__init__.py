"""Design of heading autopilots."""
