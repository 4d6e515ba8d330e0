"""CAN: a simulated bus in exact time, what its nodes say, and the way to real buses."""
