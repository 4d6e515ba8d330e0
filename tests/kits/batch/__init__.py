"""Copies of systems in compiled code."""
