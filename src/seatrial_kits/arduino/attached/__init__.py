"""Devices of a board whose other end is outside of it: flash, CAN controller, WiFi."""
