"""A simulation that a test steps: recorded, with the other ends of its links."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..api.simulation import Simulation
from ..errors import InputError
from ..plugins import service
from .holding import During, hold_or_fail


class Bench(Simulation):
    """A `seatrial.Simulation` whose outputs are all recorded.

    ``mavlink`` names a component whose vehicle the test is the ground station of: `vehicle`. The
    other arguments are those of `seatrial.Simulation`.
    """

    def __init__(self, rig: str | Path, *, mavlink: str = "", **settings: Any) -> None:
        self.properties = [("seatrial_rig", str(rig))]
        self._station = service("mavlink.station")() if mavlink else None
        if self._station is not None:
            url = {f"{mavlink}.links": self._station.url}
            settings["set"] = {**(settings.get("set") or {}), **url}
        try:
            super().__init__(rig, **settings)
        except BaseException:
            self._hang_up()
            raise
        self.recording = self.record()
        self._vehicle = None
        if self._station is not None:
            self._vehicle = service("mavlink.vehicle")(self, self._station)

    def board(self, name: str) -> Any:
        """Return the Arduino board that is the component ``name``, of the kit ``arduino``."""
        return service("arduino.board")(self, name)

    def bus(self, name: str, database: str | Path | None = None) -> Any:
        """Return the CAN bus that is the component ``name``; ``database`` is a DBC file."""
        return service("can.bus")(self, name, database)

    def pro4(self, name: str) -> Any:
        """Return the device with a Pro 4 line that is the component ``name``."""
        return service("videoray.pro4")(self, name)

    def ros2(self, name: str) -> Any:
        """Return a node of ROS 2 beside the vehicle whose link is the component ``name``."""
        return service("ros2.node")(self, name)

    @property
    def vehicle(self) -> Any:
        """The MAVLink vehicle that ``mavlink`` named. Raises InputError."""
        if self._vehicle is None:
            raise InputError("a vehicle needs simulation(RIG, mavlink=COMPONENT)")
        return self._vehicle

    def assert_holds(self, condition: str, *, during: During = None) -> None:
        """Assert a criterion on what was simulated so far, ``during`` a part of it or all.

        The times of its operators count from the start of that part. Raises AssertionError with
        the worst moment and a plot, InputError for a condition that does not fit.
        """
        __tracebackhide__ = True
        units = {name: signal.unit for name, signal in self.signals.items()}
        recorded = self.recording.signals
        name = self._master.system.rig.read_from.name
        hold_or_fail(condition, during, recorded.t, recorded, units, name, self._path)

    def _path(self, written: str) -> str:
        """Return the path of an output that the rig shows by another name, or the name."""
        if written in self.signals:
            return written
        component, variables = self._variables(written)
        return f"{component}.{variables[0].name}" if len(variables) == 1 else written

    def report_sections(self, *, failed: bool) -> list[tuple[str, str]]:
        """Return what a report of the test shows."""
        return [("seatrial", f"{self!r}")] if failed else []

    def close(self) -> None:
        """End the components, and the ground station."""
        super().close()
        self._hang_up()

    def _hang_up(self) -> None:
        if self._station is not None:
            self._station.socket.close()
