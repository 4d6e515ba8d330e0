"""A whole rig as one FMU."""
