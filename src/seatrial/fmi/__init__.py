"""FMUs: components put behind FMI, and FMUs loaded."""
