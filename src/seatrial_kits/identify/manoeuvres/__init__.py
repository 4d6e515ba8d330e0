"""Models of vehicles identified from standard manoeuvres."""
