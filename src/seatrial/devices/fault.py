"""Failures of devices, by an input."""

from __future__ import annotations

from ..component import Component, Input
from ..errors import InputError, unknown

FAULTS = ("off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent")
"""Values of the input ``fault`` beside ``none``: MAVLink's FAILURE_TYPE from 1, in its order."""

SLOWER = 10
"""How many times slower a slow device is."""
SHARE_WRONG = 0.1
"""By how much of its range a wrong device is off."""


class Fallible(Component):
    """Base of the devices that fail on demand: the input ``fault`` is ``none`` or one of `FAULTS`.

    What each of them does is in `Sensor` and `Actuator`; with ``none`` it is as if there
    were no such input. It acts from the device's next measurement, or step, on.
    """

    fault = Input(
        "1",
        f"failure: none, {', '.join(FAULTS)}",
        type=str,
        start="none",
        optional=True,
    )

    def failure(self) -> str:
        """Return the failure that acts. Raises InputError for one that there is not."""
        fault: str = self.fault
        if fault != "none" and fault not in FAULTS:
            raise InputError(f"{self.name}: {unknown('fault', fault, ('none', *FAULTS))}")
        return fault
