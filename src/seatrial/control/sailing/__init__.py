"""Sails and courses of sailing robots."""
