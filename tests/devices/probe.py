"""A sensor of two numbers, for tests of all sensors."""

from seatrial.devices.sensor import Measured, Sensor
from seatrial.model.component import Input


class Probe(Sensor):
    """Measures two numbers."""

    truth = Input("m", "truth", axes="xy")
    y = Measured("m", "measured", axes="xy", span=((-1.0, 0.0), (1.0, 10.0)))
    feedthrough = {"y": ("truth",)}  # noqa: RUF012

    def measure(self):
        return self.truth
