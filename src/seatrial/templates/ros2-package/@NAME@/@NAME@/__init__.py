"""Nodes for a boat in seatrial."""
