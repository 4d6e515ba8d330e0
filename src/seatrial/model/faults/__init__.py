"""Faults: what can go wrong with a signal, a stream, a device, a bus and a component."""
