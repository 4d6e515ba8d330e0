"""A vehicle on the bench: services in simulated time, a transport that records what is sent."""

import math
from dataclasses import replace

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Origin
from seatrial_kits.mavlink.modes import dialect
from seatrial_kits.mavlink.node import Node, Settings
from seatrial_kits.mavlink.parameters.parameters import vehicle_parameters
from seatrial_kits.mavlink.transport import Sender
from seatrial_kits.mavlink.vehicle import Estimates, Identity, Vehicle

ORIGIN = Origin(math.radians(-31.78), math.radians(-52.26), 2.0)
STATION = Sender(255, 190, 0)
OTHER_STATION = Sender(250, 190, 1)


class RecordingTransport:
    """A transport with two links, that keeps what is sent: (link, message), None for all links."""

    def __init__(self):
        self.there = [0, 1]
        self.sent = []

    def links(self):
        return self.there

    def send(self, link, message):
        assert message.pack(mavlink.MAVLink(None, 7, 1))  # it can be sent at all
        self.sent.append((link, message))

    def broadcast(self, message):
        self.send(None, message)

    def take(self, kind=None, link=...):
        """Return and forget messages, of one kind, over one link."""
        found, self.sent, before = [], [], self.sent
        for to, message in before:
            asked = kind in (None, message.get_type()) and (link is ... or to == link)
            (found if asked else self.sent).append((to, message))
        return [message for _, message in found]


class Bench:
    """A node with time that is let pass in steps of 10 ms; messages are from `STATION`.

    ``pace`` is how many of its seconds pass in one of wall time.
    """

    def __init__(
        self,
        *,
        submerged=False,
        autopilot="ardupilotmega",
        valid=True,
        plans=None,
        failures=(),
        log=lambda: None,
        **settings,
    ):
        kind = dialect(autopilot, submerged=submerged)
        types = (mavlink.MAV_TYPE_SURFACE_BOAT, mavlink.MAV_TYPE_SUBMARINE)
        identity = Identity(7, 1, types[submerged], submerged, "4.5.1-beta", 12345, 10**15)
        self.vehicle = Vehicle(identity, kind, ORIGIN, kind.mode("hold"))
        self.vehicle.estimates = Estimates(position_valid=valid, heading_valid=valid)
        self.transport = RecordingTransport()
        self.settings = Settings(**settings)
        self.parameters = vehicle_parameters(self.vehicle, self.settings, failures=failures)
        self.ticks, self.pace = 0, 1.0
        self.node = Node(
            self.vehicle,
            self.transport,
            self.settings,
            self.parameters,
            plans,
            clock=lambda: self.now / self.pace,
            failures=failures,
            log=log,
        )

    @property
    def now(self):
        return self.ticks / 100

    def measure(self, **changes):
        self.vehicle.estimates = replace(self.vehicle.estimates, **changes)

    def receive(self, message, sender=STATION):
        self.node.receive(message, sender, self.now)

    def wait(self, seconds):
        """Let so many seconds pass, the instant at their end included."""
        for _ in range(round(seconds * 100)):
            self.ticks += 1
            self.node.tick(self.now)

    def tick(self):
        self.wait(0.01)

    def command(self, number, *parameters, sender=STATION, system=7, component=1):
        """Give a COMMAND_LONG and return the result of its one answer, None without an answer."""
        self.transport.take("COMMAND_ACK")
        given = [*parameters, *[0.0] * (7 - len(parameters))]
        self.receive(
            mavlink.MAVLink_command_long_message(system, component, number, 0, *given), sender
        )
        return self._answer(number, sender)

    def command_int(self, number, *parameters, frame, x, y, z, sender=STATION):
        self.transport.take("COMMAND_ACK")
        given = [*parameters, *[0.0] * (4 - len(parameters))]
        self.receive(
            mavlink.MAVLink_command_int_message(7, 1, frame, number, 0, 0, *given, x, y, z), sender
        )
        return self._answer(number, sender)

    def _answer(self, number, sender):
        answers = self.transport.take("COMMAND_ACK")
        if not answers:
            return None
        (answer,) = answers
        assert answer.command == number
        assert (answer.target_system, answer.target_component) == (sender.system, sender.component)
        return answer.result

    def enter(self, name):
        """Change the mode as a ground station does, and check that it is entered."""
        mode = self.vehicle.dialect.mode(name)
        self.receive(mavlink.MAVLink_set_mode_message(7, 1, mode.custom_mode))
        assert self.vehicle.mode is mode

    def arm(self):
        assert self.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED

    def heartbeat(self, sender=STATION, kind=mavlink.MAV_TYPE_GCS):
        self.receive(mavlink.MAVLink_heartbeat_message(kind, 8, 0, 0, 4, 3), sender)

    def texts(self):
        """Return and forget the status texts, whole sentences."""
        self.tick()
        return [m.text for m in self.transport.take("STATUSTEXT")]

    def request(self, number):
        """Request one message, and return the copies that came."""
        self.transport.take()
        result = self.command(mavlink.MAV_CMD_REQUEST_MESSAGE, number)
        kind = mavlink.mavlink_map[number].msgname
        return result, self.transport.take(kind, STATION.link)

    def one(self, number):
        """Request one message and return it."""
        result, (message,) = self.request(number)
        assert result == mavlink.MAV_RESULT_ACCEPTED
        return message
