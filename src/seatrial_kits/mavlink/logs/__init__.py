"""Logs of MAVLink vehicles, read: telemetry logs, and what they share with ArduPilot's own."""
