"""A kit for seatrial: craft with a skeg, and an inclinometer."""
