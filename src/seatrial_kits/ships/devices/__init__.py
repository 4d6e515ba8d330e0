"""Engines, steering gear and thrusters of ships."""
