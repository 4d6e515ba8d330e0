"""Sockets, serial ports and pseudo-terminals that are polled and never waited for."""
