"""Pause: simulated time stands still, and the links are served all the same."""

from __future__ import annotations

import time
from collections.abc import Callable

from seatrial.links.interruption import Interruption
from seatrial.links.watchdog import Waiting

from .node import Node
from .parameters.simulation import SPEEDUP
from .parameters.table import ParameterTable
from .service import NOTICE, WARNING
from .settings import Settings

POLL_S = 0.02


def stand_still(
    exchange: Callable[[], bool],
    node: Node,
    settings: Settings,
    parameters: ParameterTable,
    *,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> None:
    """Serve the links until the pause is over; `Vehicle.paused_s` is how long it took.

    ``exchange`` takes in what has arrived, sends what is due, and returns whether any has.
    It is over when a station sets SIM_SPEEDUP above 0, when no station is left, that is
    when nothing arrived for ``station_timeout`` of wall time, or when the process is requested to
    end. Then the run goes on at the speed before.
    """
    vehicle = node.vehicle
    vehicle.report(NOTICE, f"Paused: {SPEEDUP} above 0 goes on")
    begun, before = clock(), vehicle.paused_s
    received, waiting = begun, Waiting()
    with Interruption() as interruption:
        while settings.paused and not interruption.requested:
            sleep(POLL_S)
            waiting.note()
            now = clock()
            vehicle.paused_s = before + now - begun
            if exchange():
                received = now
            elif now - received > settings.station_timeout:
                parameters.put(SPEEDUP, settings.speedup)
                vehicle.report(WARNING, "No station is left to end the pause")
    if not settings.paused:
        vehicle.report(NOTICE, f"Goes on at {SPEEDUP} {settings.speedup:g}")
