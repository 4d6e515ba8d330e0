"""Vehicles in motion, with sensors that have no errors, and a station that commands and listens."""

import math
import socket
from functools import cache

import pymavlink.dialects.v20.all as mavlink
from pymavlink.rotmat import Matrix3, Vector3

from seatrial import Simulation

VEHICLES = ("bluerov2", "gloria", "hydrone", "mariner", "otter", "videoray")
LINK = "autopilot.mavlink"
_START = {
    "eta_start": {"z": 4.0, "phi": 0.15, "theta": -0.1, "psi": 2.3},
    "nu_start": {"u": 0.4, "v": 0.1, "w": -0.05, "p": 0.1, "q": -0.08, "r": 0.2},
    "current_speed": 0.4,
    "current_direction": 1.0,
    "sea_spectrum": "regular",
    "sea_height": 0.3,
    "sea_period": 4.0,
}
_NO_ERRORS = ("_noise", "_bias", "_instability", "_resolution", "_scale")
_ZERO = ("delay", "antenna", "place", "deviation", "variation", "attitude_time")


@cache
def _settings(vehicle):
    """Return parameters: all in motion, sensors without errors, sampled at each step."""
    choices = {"vehicle": vehicle, "autopilot": "mavlink"}
    with Simulation("sil", choices=choices, set={f"{LINK}.links": "udpin:127.0.0.1:0"}) as sim:
        names, outputs = list(sim.parameters), set(sim.signals)
    found = {}
    for name in names:
        last = name.rpartition(".")[2]
        port = name.split(".")[2] if name.startswith("vehicle.") else ""
        sensor = f"{'.'.join(name.split('.')[:2])}.valid" in outputs
        if sensor and (port.endswith(_NO_ERRORS) or port in _ZERO):
            found[name] = 0.0
        elif sensor and port == "period":
            found[name] = 0.01
        elif sensor and port == "reception":
            found[name] = "everywhere"
        elif port in _START and not sensor:  # a depth sensor feels the waves' pressure too
            value = _START[port]
            value = value.get(last) if isinstance(value, dict) else value
            if value is not None:
                found[name] = value
    return choices, {**found, f"{LINK}.period": 0.01}


class Moving:
    """A vehicle that moves, and what it sends: use it as a context manager."""

    def __init__(self, vehicle, **more):
        self.vehicle = vehicle
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.setblocking(False)
        self._there = None
        port = self._socket.getsockname()[1]
        choices, found = _settings(vehicle)
        settings = dict(found)
        settings[f"{LINK}.links"] = f"udpout:127.0.0.1:{port}"
        settings |= {f"{LINK}.{name}": value for name, value in more.items()}
        self.sim = Simulation("sil", choices=choices, set=settings)
        self.system = int(self.sim.get(f"{LINK}.system_id"))
        self._parser = mavlink.MAVLink(None)
        self._parser.robust_parsing = True
        self._codec = mavlink.MAVLink(None, 255, 190)
        self.said = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.sim.close()
        self._socket.close()

    def send(self, message):
        self._socket.sendto(message.pack(self._codec), self._there)

    def command(self, number, *parameters):
        given = [*parameters, *[0.0] * (7 - len(parameters))]
        self.send(mavlink.MAVLink_command_long_message(self.system, 1, number, 0, *given))

    def step(self):
        """Step, and return the messages of the instant before, with the truth of then."""
        truth = self.truth()
        self.sim.step()
        found = []
        while True:
            try:
                data, self._there = self._socket.recvfrom(4096)
            except BlockingIOError:
                return truth, found
            found += self._parser.parse_buffer(data) or []

    def truth(self):
        """Return the true motion as a dictionary of SI values, rotated by pymavlink's matrices."""
        get = self.sim.get
        roll, pitch, yaw = get(f"{LINK}.true_attitude")
        r = Matrix3()
        r.from_euler(roll, pitch, yaw)
        velocity = r * Vector3(*get(f"{LINK}.true_velocity"))
        weight = r.transposed() * Vector3(0.0, 0.0, 9.81)
        force = Vector3(*get(f"{LINK}.true_acceleration")) - weight
        names = ("north", "east", "down"), ("p", "q", "r")
        position, rates = get(f"{LINK}.true_position"), get(f"{LINK}.true_rates")
        return {
            "roll": roll,
            "pitch": pitch,
            "yaw": yaw,
            **dict(zip(names[0], position, strict=True)),
            **dict(zip(names[1], rates, strict=True)),
            "vn": velocity.x,
            "ve": velocity.y,
            "vd": velocity.z,
            "ahead": math.cos(yaw) * velocity.x + math.sin(yaw) * velocity.y,
            "body": r.transposed() * velocity,
            "fx": force.x,
            "fy": force.y,
            "fz": force.z,
            "matrix": r,
            "time": self.sim.time,
            "pulses": get(f"{LINK}.pulse"),
            "apparent": get(f"{LINK}.wind_speed") if self.vehicle == "gloria" else 0.0,
            "share": get(f"{LINK}.share"),
            "motor_speed": get(f"{LINK}.motor_speed"),
            "motor_current": get(f"{LINK}.motor_current"),
        }
