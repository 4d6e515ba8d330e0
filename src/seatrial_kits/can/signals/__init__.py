"""Messages that a DBC describes, between a CAN bus and ports."""
