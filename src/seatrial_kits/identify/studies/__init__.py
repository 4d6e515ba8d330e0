"""Identification of a vehicle's parameters from a log: files, study and page."""
