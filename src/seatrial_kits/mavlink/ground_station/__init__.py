"""A ground station in the place of a person: it sends a MAVLink vehicle on a mission.

`component` is what a rig uses. `conversation` has what was received and asks again where nothing
was, `errand` is what it does, one thing after another.
"""
