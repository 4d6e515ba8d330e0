"""Sockets, serial ports and pseudo-terminals that are polled, or waited for."""
