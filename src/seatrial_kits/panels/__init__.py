"""Craft by the tables of panel codes, with the memory of their waves."""
