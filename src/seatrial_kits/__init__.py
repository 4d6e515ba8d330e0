"""Kits that seatrial ships: each serves one protocol, board, tool or family of questions."""
