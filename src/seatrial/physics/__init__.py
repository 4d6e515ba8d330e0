"""Equations of craft and of their surroundings: sea, seabed, contact, foils, thrusters."""
