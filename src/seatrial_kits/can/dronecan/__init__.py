"""DroneCAN (UAVCAN v0): ESCs, servos, receivers and autopilots as nodes of a CAN bus.

`peripheral` and `autopilot` are what a rig uses; `node` is what both share: identity, status,
parameters, a node ID. Below it `transfers` makes frames into transfers and back, with the types
and the codec of the `dronecan` package (`codec`).
"""
