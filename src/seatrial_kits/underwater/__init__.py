"""Under water: the seabed, contact with it, and devices that work by sound."""
