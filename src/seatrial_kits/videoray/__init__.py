"""VideoRay's serial protocols: the Pro 4's, both ends, and VRCSR of the M5 thrusters."""
