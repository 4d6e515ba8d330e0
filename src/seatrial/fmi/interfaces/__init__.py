"""FMI 1.0, 2.0, and 3.0, co-simulation and model exchange, as one kind of instance."""
