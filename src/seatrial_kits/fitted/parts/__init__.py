"""Propulsors, foils and ballast: equations of one part each."""
