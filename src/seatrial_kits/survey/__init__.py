"""Survey of the FMUs of a folder: which load, run, and agree with FMPy."""
