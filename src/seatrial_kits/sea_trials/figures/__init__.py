"""Figures of standard manoeuvres: pure functions of a record."""
