"""Parameters of a vehicle: definitions, tables of ArduPilot and PX4, files."""
