"""Import paths of before 0.2: they work until 0.3, with a DeprecationWarning."""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, cast

MOVED = {
    "campaigns.ask": "seatrial_kits.search.ask",
    "cosim.osp": "seatrial_kits.interchange.osp",
    "cosim.rig_fmu": "seatrial_kits.interchange.rig_fmu",
    "cosim.ssp": "seatrial_kits.interchange.ssp",
    "fmi.native": "seatrial_kits.native",
    "fmi.standalone": "seatrial_kits.native.standalone",
    "identification": "seatrial_kits.identify",
    "links.ais": "seatrial_kits.nmea.ais",
    "links.arduino": "seatrial_kits.arduino",
    "links.ardupilot": "seatrial_kits.ardupilot",
    "links.can": "seatrial_kits.can",
    "links.can_signals": "seatrial_kits.can.signals",
    "links.dronecan": "seatrial_kits.can.dronecan",
    "links.gprs": "seatrial_kits.gprs",
    "links.ground_station": "seatrial_kits.mavlink.ground_station",
    "links.mavlink": "seatrial_kits.mavlink",
    "links.nmea0183": "seatrial_kits.nmea.nmea0183",
    "links.nmea2000": "seatrial_kits.nmea.nmea2000",
    "links.px4": "seatrial_kits.px4",
    "links.videoray": "seatrial_kits.videoray",
    "live": "seatrial_kits.live",
    "testing.arduino_board": "seatrial_kits.arduino.testing",
    "testing.can_bus": "seatrial_kits.can.testing",
    "testing.mavlink_vehicle": "seatrial_kits.mavlink.testing",
    "testing.pro4": "seatrial_kits.videoray.testing",
    "trials.export": "seatrial_kits.interchange.export",
    "trials.heading_design": "seatrial_kits.design.heading",
    "trials.identify": "seatrial_kits.identify.studies",
    "trials.logs": "seatrial_kits.logs",
    "trials.motion_plan": "seatrial_kits.videoray.plan.motion",
}
"""Modules and packages of ``seatrial``, and where they are now."""
_PREFIX = "seatrial."


class MovedFinder:
    """Finds modules by the paths that they had: the same modules, not copies.

    Without the base classes of `importlib.abc`, whose import takes as long as all of this package.
    """

    _spec: ModuleSpec | None = None

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return how a moved module is loaded; None for all others."""
        new = _moved(fullname)
        return None if new is None else ModuleSpec(fullname, cast(Any, self), origin=new)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return the module of the new path."""
        assert spec.origin is not None
        warnings.warn(
            f"{spec.name} is {spec.origin} now; the old path is gone in 0.3",
            DeprecationWarning,
            stacklevel=2,
        )
        module = importlib.import_module(spec.origin)
        self._spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Leave the module what it is: it ran when it was imported."""
        module.__spec__ = self._spec


def _moved(name: str) -> str | None:
    if not name.startswith(_PREFIX):
        return None
    old, rest = name.removeprefix(_PREFIX), ""
    while old:
        if old in MOVED:
            return MOVED[old] + rest
        old, dot, last = old.rpartition(".")
        rest = f"{dot}{last}{rest}"
    return None


def find_moved() -> None:
    """Let Python find modules by their old paths, before it looks into the packages' folders."""
    if not any(isinstance(finder, MovedFinder) for finder in sys.meta_path):
        sys.meta_path.insert(0, MovedFinder())
