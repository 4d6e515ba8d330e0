"""Packets between vehicles: acoustic modems and radios."""
