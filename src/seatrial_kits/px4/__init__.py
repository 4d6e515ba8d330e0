"""PX4's simulated firmware over its simulator's MAVLink interface, in lockstep.

`component` is what a rig uses. `instruments` makes the sensors of the true motion, `lockstep` has
one firmware at a TCP port, and `firmware` the command of a build of a user's.
"""
