"""From files to a system: parameters, fitted parts, bonds, and profiles put together."""
