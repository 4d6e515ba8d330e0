"""GPRS: a modem that takes AT commands, and a base station at the other end of its connection."""
