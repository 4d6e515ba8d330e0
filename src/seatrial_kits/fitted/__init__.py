"""Craft by data: propulsors, foils and ballast, and the allocation to them."""
