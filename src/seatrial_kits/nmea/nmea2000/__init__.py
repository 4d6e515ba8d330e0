"""NMEA 2000: nodes of a simulated CAN bus as instruments, autopilots and plotters are.

`component` is one node. `codec` turns messages into frames and back, with the package nmea2000,
which has canboat's tables; `catalogue` says which messages a node sends and reads, `measurements`
and `received` what their fields mean, `address_claim`, `services` and `group_functions` are the
network's protocols: they see messages and simulated time and nothing else.
"""
