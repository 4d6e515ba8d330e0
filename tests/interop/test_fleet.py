"""Two ground stations and three vehicles in one real-time run."""

from __future__ import annotations

import json
import socket
import time

import numpy as np
from pymavlink import mavutil

from .running import HOST, free_port, running, wait_for

HYDRONE, GLORIA, VIDEORAY = 1, 2, 3
NAMES = {HYDRONE: "hydrone", GLORIA: "gloria", VIDEORAY: "videoray"}
GUIDED = {HYDRONE: 15, GLORIA: 15, VIDEORAY: 4}
SET_MODE, ARM = mavutil.mavlink.MAV_CMD_DO_SET_MODE, mavutil.mavlink.MAV_CMD_COMPONENT_ARM_DISARM
COMMAND_DEADLINE_S = 60.0


class Station:
    """A ground station: one or several connections, and the last message of each kind and system."""

    def __init__(self, system, *urls):
        self.system = system
        self.links = [
            mavutil.mavlink_connection(url, source_system=system, source_component=190)
            for url in urls
        ]
        self.received = {}
        self.trips = []
        self._beat = 0.0
        self._pings = {}

    def serve(self):
        """Send heartbeat and ping each second, and take in what has come."""
        now = time.monotonic()
        if now - self._beat > 1.0:
            self._beat = now
            number = len(self._pings)
            self._pings[number] = now
            for link in self.links:
                link.mav.heartbeat_send(6, 8, 0, 0, 4)
                link.mav.ping_send(0, number, 0, 0)
        for link in self.links:
            while (message := link.recv_match()) is not None:
                kind, system = message.get_type(), message.get_srcSystem()
                self.received[kind, system] = message
                if kind == "PING" and message.target_system == self.system:
                    self.trips.append(time.monotonic() - self._pings[message.seq])

    def systems(self):
        return {system for kind, system in self.received if kind == "HEARTBEAT"}

    def command(self, system, number, *parameters):
        for link in self.links:
            given = [*parameters, *[0.0] * (7 - len(parameters))]
            link.mav.command_long_send(system, 1, number, 0, *given)

    def steer(self, system, north, east):
        """Ask one vehicle for a velocity, north and east, m/s."""
        for link in self.links:
            link.mav.set_position_target_local_ned_send(
                0, system, 1, 1, 0b110111000111, 0, 0, 0, north, east, 0, 0, 0, 0, 0, 0
            )

    def close(self):
        for link in self.links:
            link.close()


def served(stations, condition, what, each=lambda: None):
    """Wait for a condition while the stations go on."""

    def check():
        each()
        for station in stations:
            station.serve()
        return condition()

    wait_for(check, what, COMMAND_DEADLINE_S)


def ordered(stations, system, number, *parameters, done):
    """Give a command of the first station until the vehicle shows that it is carried out."""
    last = [0.0]

    def again():
        if time.monotonic() - last[0] > 2.0:
            last[0] = time.monotonic()
            stations[0].command(system, number, *parameters)

    served(stations, done, f"{NAMES[system]}: command {number}", again)


def is_armed(station, system):
    beat = station.received.get(("HEARTBEAT", system))
    return bool(beat and beat.base_mode & mavutil.mavlink.MAV_MODE_FLAG_SAFETY_ARMED)


def mode_of(station, system):
    return station.received["HEARTBEAT", system].custom_mode


def test_two_stations_see_three_vehicles_and_each_obeys_its_own_orders(tmp_path, record_property):
    port = free_port()
    servers = {name: free_port(socket.SOCK_STREAM) for name in NAMES.values()}
    links = {
        f"{name}__autopilot__mavlink__links": f"udpout:{HOST}:{port} tcpin:{HOST}:{server}"
        for name, server in servers.items()
    }
    # One station receives all vehicles at its port, the other is a client of each.
    by_udp = Station(255, f"udpin:{HOST}:{port}")
    with running("fleet", tmp_path, stop="6000 s", **links) as trial:
        wait_for(lambda: trial.is_running, "the trial", 180.0)
        by_tcp = Station(250, *(f"tcp:{HOST}:{server}" for server in servers.values()))
        stations = (by_udp, by_tcp)
        served(stations, lambda: all(s.systems() == set(NAMES) for s in stations), "all vehicles")

        for system in NAMES:  # one after the other: those not addressed stay as they are
            others = set(NAMES) - {s for s in NAMES if s <= system}
            ordered(
                stations,
                system,
                SET_MODE,
                1,
                GUIDED[system],
                done=lambda s=system: mode_of(by_udp, s) == GUIDED[s],
            )
            ordered(stations, system, ARM, 1, done=lambda s=system: is_armed(by_udp, s))
            for other in others:
                assert not is_armed(by_udp, other)
                assert mode_of(by_udp, other) != GUIDED[other]

        wanted = {HYDRONE: (0.5, 0.0), VIDEORAY: (0.0, -0.2), GLORIA: (0.0, 1.0)}
        began = trial_time(by_udp)

        def steer():
            for system, (north, east) in wanted.items():
                (by_udp if system != VIDEORAY else by_tcp).steer(system, north, east)

        served(
            stations,
            lambda: all(trial_time(s) > began + 10.0 for s in stations),
            "ten seconds of set-points",
            steer,
        )
        run = trial.stop()
        timing = json.loads((trial.folder / "timing.json").read_text())
        for station in stations:
            station.close()

    # What the plants did: each went its own way, and no other.
    courses = {
        "hydrone.vehicle.hull": 0.0,
        "videoray.vehicle.hull": -90.0,
        "gloria.vehicle.boat": 90.0,
    }
    for plant, course in courses.items():
        moved = [
            run.signals[f"{plant}.position.{a}"][-1] - run.signals[f"{plant}.position.{a}"][0]
            for a in "xy"
        ]
        assert np.hypot(*moved) > 0.5
        assert abs(wrapped(np.degrees(np.arctan2(moved[1], moved[0])) - course)) < 60.0, plant
    report(record_property, stations, timing)


def trial_time(station):
    """Return the simulated time that the Hydrone's attitude was sent at, s."""
    return station.received["ATTITUDE", HYDRONE].time_boot_ms * 1e-3


def wrapped(degrees):
    return (degrees + 180.0) % 360.0 - 180.0


def report(record_property, stations, timing):
    """Report latency and overruns: figures of the machine, which no test may assert."""
    for station, name in zip(stations, ("udp", "tcp"), strict=True):
        trips = np.array(station.trips) * 1e3
        assert trips.size
        summary = ", ".join(f"p{p} {np.percentile(trips, p):.1f} ms" for p in (50, 90, 99))
        record_property(f"ping_{name}", summary)
        print(f"PING over {name}: {summary} ({trips.size})")
    pacing = timing["pacing"]
    late = pacing["overruns"]["steps"]
    cost = sum(times["mean_s"] for times in timing["step_times"].values())
    summary = f"{late} of {timing['steps']} steps late, {cost * 1e3:.1f} ms per step"
    record_property("overruns", summary)
    print(f"fleet: {summary}")
