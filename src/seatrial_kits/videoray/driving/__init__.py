"""A VideoRay driven with keys or a gamepad."""
