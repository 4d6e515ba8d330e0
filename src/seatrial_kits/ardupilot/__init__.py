"""ArduPilot's simulated firmware over its JSON physics interface, in lockstep.

`component` is what a rig uses. `packet` reads what the firmware sends, `reply` writes what it gets,
`lockstep` has one firmware at a UDP port, and `firmware` the options of a program of a user's.
"""
