"""SSP packages: systems of FMUs in the file that other co-simulation tools read and write."""
