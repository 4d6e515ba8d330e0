"""Reports of runs and of campaigns."""
