"""NMEA 0183: sentences to and from instruments, chart plotters and autopilots."""
