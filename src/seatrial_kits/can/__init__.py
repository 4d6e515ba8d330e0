"""CAN: a simulated bus in exact time, its nodes' operations, and gateways to real buses."""
