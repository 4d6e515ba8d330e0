"""Actuators and what drives them."""
