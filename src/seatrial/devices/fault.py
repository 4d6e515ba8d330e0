"""Faults of devices, by an input."""

from __future__ import annotations

from ..errors import InputError
from ..model.component import Component, Input
from ..model.faults.catalogue import FAILURES
from ..model.faults.text import Written, read_text

SLOWER = 10
"""How many times slower a slow device is."""
SHARE_WRONG = 0.1
"""By how much of its range a wrong device is off."""


class Fallible(Component):
    """Base of the devices that fail on demand, by their input ``fault``.

    It is ``none``, one of `FAILURES`, or, of a sensor, a fault of what it measures
    (`model.faults.text`). What each of them does is in `Sensor` and `Actuator`; with ``none``
    it is as if there were no such input. It acts from the device's next measurement, or step, on.
    """

    fault = Input(
        "1",
        f"what is wrong: none, {', '.join(FAILURES)}",
        type=str,
        start="none",
        optional=True,
        role="fault",
    )

    def failure(self) -> str:
        """Return the name of the fault that acts. Raises InputError for one that there is not."""
        return self.written_fault().what

    def written_fault(self) -> Written:
        """Return the fault that acts. Raises InputError for one that there is not."""
        text: str = self.fault
        try:
            return read_text(text)
        except InputError as error:
            raise InputError(f"{self.name}.fault: {error}") from None
