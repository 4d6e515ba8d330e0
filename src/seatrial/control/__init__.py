"""Autopilots: guidance, control laws and control allocation."""
