"""Tests of autopilots and firmware: a plugin of pytest, and what its fixtures give.

`plugin` is loaded by every pytest on a machine with this package: it imports nothing of it before a
test asks for that.
"""
