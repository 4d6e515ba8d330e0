"""AIS: transponders, the VHF channel between them, ships with scripted tracks."""
