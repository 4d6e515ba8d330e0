"""Actuators and sensors."""
