"""PX4 as a component: sensors of the true motion out, actuators in, one exchange per step."""

from __future__ import annotations

import math
import time
from pathlib import Path

from seatrial.errors import InputError, SimulationError
from seatrial.links.endpoints.endpoint import report
from seatrial.links.endpoints.tcp import TcpServer
from seatrial.links.endpoints.url import open_endpoints, other_end
from seatrial.links.program import Program
from seatrial.links.servos import Servo, read_servos
from seatrial.links.truth import require_possible
from seatrial.links.watchdog import EVERY_S, Watchdog
from seatrial.model.component import Component

from .firmware import arguments, by_hand, check_build, environment, instance_of, read_parameters
from .instruments import Instruments, microseconds
from .lockstep import Lockstep
from .ports import CHANNELS, Px4Ports

LONGEST_STEP = 0.02
"""A step of a slower rate than 50 Hz starves PX4's estimator, s."""
FREE_SPEEDUP = 10.0
"""Most times real time while PX4 does not answer: it cannot say that it does not keep up."""


class Px4(Px4Ports):
    """PX4's simulated firmware in the place of an autopilot, over its simulator's MAVLink.

    **Lockstep.** In each communication step, from t to t + h, it gets HIL_SENSOR of t, which sets
    its clock, and its HIL_ACTUATOR_CONTROLS of that time are the output ``pulse`` from t + h on.
    So each reaction takes one step. PX4's controllers answer every ``answer_period``, which may
    be several steps, and only while they run, those of rovers while they are armed. Until the first
    answer, and when none comes for ``answer_limit`` of wall time, the run goes on without waiting,
    at ``speedup`` and 10 times real time at most; with the next answer it is in lockstep again.

    **The firmware** connects to ``link``, which only listens. While none is connected simulated
    time stands still; messages say who is being waited for and since when. After ``wait_limit``
    of wall time it fails, so that no tool that it is an FMU in waits without end. With ``program``
    it is started beside the run, in a folder of the run folder with this component's name that
    keeps its parameters and its log (ULog), and ended with it. Without, a message says what to
    start by hand. One that is started again goes on with the motion as it is then
    (``restarts``). A second one is left out while the first is connected.

    **Instruments** are made here of the true motion: see `px4.instruments`. ``without`` takes one
    away. Noise of a sample is keyed by seed and time. A vehicle under water has GNSS only with
    ``reception`` "everywhere", as if its position came from elsewhere.

    **Pulses.** A channel's control u from -1 to 1 gives neutral + u (max - neutral) of the
    actuator that ``actuators`` has on it, neutral + u (neutral - min) below 0, neutral for what is
    no number; all are neutral while it says that it is disarmed or is not connected. A channel
    without an actuator gives 0.

    Raises InputError at the start for a link, program, file, date or actuator that cannot be, and
    SimulationError in a step for one longer than 0.02 s, for a motion that no craft has, when no
    firmware connects in ``wait_limit``, and when a program it started ends.

    It cannot be rolled back: what was sent has been sent.
    """

    discrete = True
    rolls_back = False
    transient = Component.transient | {"_lockstep", "_firmware", "_connecting", "_answering"}

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._lockstep: Lockstep | None = None
        self._firmware: Program | None = None

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Open the port."""
        self.close()
        try:
            self._servos = read_servos(self.actuators)
            self._parameters = read_parameters(self.defaults)
            self._instruments = Instruments(self, self.now_ns)
            if self.program:
                check_build(self.program)
                instance_of(_port(self.link))
            (endpoint,) = open_endpoints("link", self.link)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        assert isinstance(endpoint, TcpServer)  # _check_link
        self._lockstep = Lockstep(endpoint)
        where = endpoint.url.partition(":")[2]
        self._connecting = Watchdog(
            self.name, f"PX4, which is to connect to {where}", self.wait_limit
        )
        self._answering = Watchdog(self.name, "PX4's actuators")
        self._seen = 0
        self._paced_until = self._quiet_until = -math.inf
        self._has_begun = False

    def step(self, t: float, h: float) -> None:
        """Send the sensors of ``t``, and wait for the actuators of ``t + h``."""
        lockstep = self._lockstep
        assert lockstep is not None
        if not self._has_begun:
            self._begin(h)
        if not lockstep.wait_for_firmware(self._while_connecting):
            return
        self._connecting.received()
        self._note_connection()
        try:
            truth = self.true_motion()
            require_possible(truth, "PX4")
        except SimulationError as error:
            raise SimulationError(f"{self.name}: {error}") from None
        messages = self._instruments.messages(self.now_ns, truth)
        before = lockstep.missed
        lockstep.exchange(
            microseconds(self.now_ns),
            messages,
            self._every_us,
            self.answer_limit,
            self._while_answering,
        )
        self._answering.received()
        if lockstep.missed > before and lockstep.is_armed and time.monotonic() >= self._quiet_until:
            self._quiet_until = time.monotonic() + EVERY_S
            self._answering.say(
                f"PX4 is armed and gave no actuators within {self.answer_limit:g} s of wall time, "
                f"at t = {t:g} s: the run goes on without waiting for them"
            )
        self._pace(h)

    def outputs(self, t: float) -> None:
        """Publish the pulses, and how the exchange goes."""
        lockstep = self._lockstep
        assert lockstep is not None
        self.connected, self.armed = lockstep.is_connected, lockstep.is_armed
        self.lockstep = lockstep.is_locked
        controls = lockstep.controls if lockstep.is_armed else ()
        padded = (*controls, *(0.0,) * (CHANNELS - len(controls)))
        self.pulse = tuple(
            pulse(control, self._servos.get(number)) for number, control in enumerate(padded, 1)
        )
        self.restarts, self.missed = max(0, lockstep.connections - 1), lockstep.missed
        self.frames_refused = lockstep.refused
        self.reached_at = other_end(lockstep.endpoint.url)
        report(self, [lockstep.endpoint])

    def close(self) -> None:
        """End the program, and close the port."""
        if self._firmware is not None:
            self._firmware.close()
        if self._lockstep is not None:
            self._lockstep.close()
        self._firmware = self._lockstep = None

    # ------------------------------------------------------------------ inside

    def _begin(self, h: float) -> None:
        """Check the step, and start the firmware or say what to start."""
        if h > LONGEST_STEP + 1e-9:
            raise SimulationError(
                f"{self.name}: the communication step is {h:g} s, at most {LONGEST_STEP:g} s is "
                "needed: PX4's estimator takes no slower inertial unit"
            )
        self._has_begun = True
        self._every_us = round(1e6 * h * max(1, math.ceil(self.answer_period / h - 1e-9)))
        variables = environment(self, self._parameters)
        if not self.program:
            assert self._lockstep is not None
            typed = by_hand(variables, _port(self._lockstep.endpoint.url))
            self._connecting.say(f"start PX4, in a folder of its own:\n  {typed}")
            return
        path, build = check_build(self.program)
        command = [str(path), *arguments(instance_of(_port(self.link)), str(build / "etc"))]
        folder = Path(self.run_folder, self.name) if self.run_folder else None
        self._firmware = Program(self.name, "PX4", command, folder, variables)

    def _note_connection(self) -> None:
        lockstep = self._lockstep
        assert lockstep is not None
        if 0 < self._seen < lockstep.connections:
            self._connecting.say(f"PX4 connected again, at t = {self.now:g} s")
        self._seen = lockstep.connections

    def _pace(self, h: float) -> None:
        """Wait until the step has taken as long as it should at least."""
        assert self._lockstep is not None
        limit = self.speedup if self._lockstep.is_locked else min(self.speedup, FREE_SPEEDUP)
        now = time.monotonic()
        if now > self._paced_until + 1.0:  # it was waited for: what is lost is not caught up
            self._paced_until = now
        self._paced_until += h / limit
        self._lockstep.idle(self._paced_until)

    def _while_connecting(self) -> None:
        self._check_program()
        self._connecting.waiting()

    def _while_answering(self) -> None:
        self._check_program()
        self._answering.waiting()

    def _check_program(self) -> None:
        if self._firmware is not None:
            self._firmware.check()


def _port(url: str) -> int:
    return int(url.rpartition(":")[2])


def pulse(control: float, servo: Servo | None) -> float:
    """Return the pulse, s, of a control from -1 to 1; 0 where there is no actuator."""
    if servo is None:
        return 0.0
    u = min(1.0, max(-1.0, control)) if math.isfinite(control) else 0.0
    neutral = servo.pulse_neutral
    span = servo.pulse_max - neutral if u >= 0.0 else neutral - servo.pulse_min
    return 1e-6 * (neutral + u * span)
