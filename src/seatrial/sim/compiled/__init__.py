"""The master's steps in C, for FMUs in C: `master.c`, and what brings it and Python together."""
