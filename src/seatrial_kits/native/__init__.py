"""Plants to FMUs in C, which need no Python where they run."""
