"""ArduPilot as a component: true motion out, servo pulses in, one frame per step."""

from __future__ import annotations

import math
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, SimulationError
from seatrial.links.endpoints.endpoint import report
from seatrial.links.endpoints.udp import UdpListener
from seatrial.links.endpoints.url import open_endpoints, other_end
from seatrial.links.geodesy import Ned, Origin
from seatrial.links.parameter_validation import start_us
from seatrial.links.program import Program, check_program
from seatrial.links.servos import read_servos
from seatrial.links.truth import Truth
from seatrial.links.vehicle_sensors import read_instruments
from seatrial.links.watchdog import Watchdog
from seatrial.model.component import Component
from seatrial.physics.craft.kinematics import to_body

from .lockstep import Lockstep
from .packet import MOST_CHANNELS
from .ports import LOOP_HZ, ArduPilotPorts
from .reply import RANGES, Earth, blows_from, read_fields, reply
from .simulated import Simulated, simulated, write_parameters

BOOTED_S = 10.0
"""Pulses before are those of a firmware that boots: 1000 us for half a second, s."""
LONGEST_STEP = 0.1
"""A firmware's time stands still while steps are as long as this, s."""


class ArduPilot(ArduPilotPorts):
    """ArduPilot's simulated firmware in the place of an autopilot, over its JSON interface.

    **Lockstep.** In each communication step, from t to t + h, it answers the frame that the
    firmware waits with by the true motion at t, and waits for the next one, whose pulses are on
    the output ``pulse`` from t + h on. So each reaction takes one step. The timestamp is simulated
    time; the firmware's clock follows it, however fast the run is. While no frame comes, simulated
    time stands still; messages say who is being waited for and since when. After ``wait_limit`` of
    wall time it fails, so that no tool that it is an FMU in waits without end.

    **The firmware** makes its own GNSS, compass, barometer and inertial units from the truth, with
    the errors, delays and places of the profile's sensors as far as ArduPilot has them
    (``instruments``; `ardupilot.simulated`): a file of SIM_* parameters in the run folder, read
    after ``defaults``. With ``program`` it is started beside the
    run, in a folder of the run folder with this component's name that keeps its parameters
    and logs, and ended with it. Without, a message says what to start by hand. One that is
    started again, from another port too, goes on with the motion as it is then (``restarts``). See
    `Lockstep` for what is repeated or comes from others.

    ArduSub's home is at altitude 0, wherever the lake is: its simulated pressure sensor feels
    water below that only. ArduCopter gets the mean specific force since the frame before, from
    the change of velocity: legs that meet a deck push for less than a step.

    **Several firmwares** in one run each need a ``link`` and an ``instance`` of their own.

    **Conventions.** Position and velocity in {n} from ``latitude``, ``longitude``, ``altitude``,
    which is the firmware's home; rates and specific force in {b}, level at rest
    (0, 0, -``gravity``); attitude ZYX. ``wind_angle`` is where the apparent wind blows to,
    ArduPilot's vane where it comes from: the vane gets the opposite. ``wind`` is where the air
    goes, there too. Pulses s here, us there.

    **Fields** beside the motion are sent if ``fields`` names them: ``windvane`` (while
    ``wind_valid``), ``velocity_wind``, ``airspeed``, ``rng_1`` to ``rng_6``, ``rc``, ``battery``.

    **No pulse.** A channel whose pulse is 0, disabled or not assigned, gives the neutral pulse of
    the actuator that ``actuators`` has on it, and 0 if there is none.

    **Armed.** The interface does not say whether the firmware is armed. ``armed`` is true from the
    first frame on in which the pulse of an actuator is not its neutral one, 10 s or more after
    the start: a firmware that is disarmed commands nothing, but for some pulses while it boots,
    when its estimator does not let it arm yet.

    Raises InputError at the start for a link, program, field or actuator that cannot be, and
    SimulationError in a step for one of 0.1 s or longer, in which the firmware's time stands
    still, for a motion that no craft has, when no frame comes in ``wait_limit``, and when a
    program it started ends. A step longer than the firmware's main loop is warned of.

    It cannot be rolled back: what was sent has been sent.
    """

    discrete = True
    rolls_back = False
    transient = Component.transient | {"_lockstep", "_firmware", "_watchdog"}

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._lockstep: Lockstep | None = None
        self._firmware: Program | None = None

    # ------------------------------------------------------------------ running

    def start(self, t: float) -> None:
        """Open the port."""
        self.close()
        try:
            self._fields = read_fields(self.fields)
            neutral = {n: each.pulse_neutral for n, each in read_servos(self.actuators).items()}
            if self.program:
                check_program(self.program)
            (endpoint,) = open_endpoints("link", self.link)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        assert isinstance(endpoint, UdpListener)  # _check_link
        self._neutral = tuple(1e-6 * neutral.get(n, 0.0) for n in range(1, MOST_CHANNELS + 1))
        self._pulses = self._neutral
        self._given: tuple[int, ...] = ()
        self._lockstep = Lockstep(endpoint)
        self._earth = Earth(self.latitude)
        where = endpoint.url.partition(":")[2]
        whom = f"ArduPilot, which is to send to {where}"
        self._watchdog = Watchdog(self.name, whom, self.wait_limit)
        self._has_begun = self._armed = False
        self._before: tuple[float, Ned] | None = None
        self._booted = t + BOOTED_S

    def step(self, t: float, h: float) -> None:
        """Answer with the motion at ``t``, and wait for the pulses of ``t + h``."""
        assert self._lockstep is not None
        if not self._has_begun:
            self._begin(h)
        # The first time, and after an interruption, nothing waits for an answer yet.
        if self._wait():
            try:
                answer = reply(t, self._motion(t), self._earth, self._others())
            except SimulationError as error:
                raise SimulationError(f"{self.name}: {error}") from None
            self._lockstep.answer(answer)
            self._wait()
        if t >= self._booted:
            commanded = zip(self._pulses, self._neutral, strict=True)
            self._armed = self._armed or any(rest and pulse != rest for pulse, rest in commanded)

    def outputs(self, t: float) -> None:
        """Publish the pulses, and how the exchange goes."""
        lockstep = self._lockstep
        assert lockstep is not None
        frame = lockstep.frame
        self.pulse, self.armed = self._pulses, self._armed
        self.connected = frame is not None
        self.frame_rate = 0.0 if frame is None else float(frame.rate)
        self.restarts, self.repeated = lockstep.restarts, lockstep.repeated
        self.lost, self.frames_refused = lockstep.lost, lockstep.refused
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
        if h >= LONGEST_STEP:
            raise SimulationError(
                f"{self.name}: the communication step is {h:g} s, less than {LONGEST_STEP:g} s is "
                "needed: ArduPilot's time stands still in longer ones"
            )
        rate = LOOP_HZ[self.firmware]
        if h * rate > 1.0 + 1e-9:
            self._watchdog.say(
                f"the communication step is {h:g} s, and ArduPilot's {self.firmware} runs its "
                f"main loop every {1.0 / rate:g} s"
            )
        assert self._lockstep is not None
        options = self._options(h)
        if self.program:
            folder = Path(self.run_folder, self.name) if self.run_folder else None
            command = [str(check_program(self.program)), *options]
            self._firmware = Program(self.name, "ArduPilot", command, folder)
        else:
            typed = by_hand(f"ardu{self.firmware}", options)
            self._watchdog.say(f"start ArduPilot, in a folder of its own:\n  {typed}")
        self._has_begun = True

    def _options(self, h: float) -> list[str]:
        assert self._lockstep is not None
        port = int(self._lockstep.endpoint.url.rpartition(":")[2])
        latitude, longitude, altitude = Origin(
            self.latitude, self.longitude, self.altitude
        ).geodetic((0.0, 0.0, 0.0))
        heading = math.degrees(self.true_attitude[2]) % 360.0
        files = [Path(self.defaults).resolve()] if self.defaults else []
        files += self._of_instruments()
        defaults = ",".join(map(str, files))
        if self.firmware == "sub":
            altitude = 0.0  # above it, its simulated pressure sensor is in the air
        home = (latitude, longitude, altitude, heading)
        return arguments(
            port,
            home,
            h,
            self.speedup,
            defaults=defaults,
            serial0=self.serial0,
            instance=round(self.instance),
        )

    def simulated_instruments(self) -> list[Simulated]:
        """Return the firmware's parameters that follow from the sensors of the profile."""
        home = self.latitude, self.longitude, self.altitude
        sensors = read_instruments(self.instruments)
        return simulated(sensors, self.firmware, home, 1e-6 * start_us(self.date))

    def _of_instruments(self) -> list[Path]:
        """Write the file of parameters of the profile's sensors, if there is a run folder."""
        found = self.simulated_instruments()
        if not found or not self.run_folder:
            return []
        return [write_parameters(Path(self.run_folder, self.name), found)]

    def _wait(self) -> bool:
        """Wait for a frame and take its pulses; return whether one is there to be answered."""
        lockstep = self._lockstep
        assert lockstep is not None
        before = lockstep.restarts
        frame = lockstep.wait_for_frame(self._while_waiting)
        self._watchdog.received()
        if lockstep.restarts > before:
            self._watchdog.say(f"ArduPilot was started again, at t = {self.now:g} s")
        if frame is None:
            return False
        if frame.pwm != self._given:
            self._given = frame.pwm
            widths = (*frame.pwm, *(0,) * (MOST_CHANNELS - len(frame.pwm)))
            self._pulses = tuple(
                1e-6 * width if width else rest
                for width, rest in zip(widths, self._neutral, strict=True)
            )
        return True

    def _while_waiting(self) -> None:
        if self._firmware is not None:
            self._firmware.check()
        self._watchdog.waiting()

    def _motion(self, t: float) -> Truth:
        """Return the motion to send at ``t``."""
        truth = self.true_motion()
        before, self._before = self._before, (t, truth.velocity_n)
        if self.firmware != "copter" or before is None or t <= before[0]:
            return truth
        span = t - before[0]
        mean = [(v - w) / span for v, w in zip(truth.velocity_n, before[1], strict=True)]
        mean[2] -= self.gravity
        return replace(truth, specific_force=to_body(truth.attitude, mean))

    def _others(self) -> dict[str, Any]:
        """Return what is sent beside the motion."""
        return {name: self._field(name) for name in self._fields if self._is_measured(name)}

    def _is_measured(self, name: str) -> bool:
        return name != "windvane" or self.wind_valid

    def _field(self, name: str) -> Any:
        match name:
            case "windvane":
                return {"direction": blows_from(self.wind_angle), "speed": self.wind_speed}
            case "velocity_wind":
                return self.wind
            case "airspeed":
                return self.airspeed
            case "rc":
                return {f"rc_{n}": round(1e6 * width) for n, width in enumerate(self.rc, 1)}
            case "battery":
                return {"voltage": self.voltage, "current": self.current}
        return self.distance[RANGES.index(name)]


def arguments(
    port: int,
    home: tuple[float, float, float, float],
    step: float,
    speedup: float,
    *,
    defaults: str = "",
    serial0: str = "",
    instance: int = 0,
) -> list[str]:
    """Return the firmware's options.

    ``home`` is latitude, longitude and heading in degrees, with the altitude in m before the
    heading; ``step`` the communication step in s; ``defaults`` a parameter file, ``serial0`` the
    device of its first serial port, each empty for its own; ``instance`` counts the firmwares of
    one machine from 0.
    """
    latitude, longitude, altitude, heading = home
    options = [
        "--model", "JSON:127.0.0.1", "--sim-port-out", str(port),
        "--home", f"{latitude:.9f},{longitude:.9f},{altitude:g},{heading:.3f}",
        "--rate", f"{round(1.0 / step)}", "--speedup", f"{speedup:g}",
    ]  # fmt: skip
    if instance:
        options += ["--instance", f"{instance}", "--sysid", f"{instance + 1}"]
    given = {"--defaults": defaults, "--serial0": serial0}
    return [*options, *(word for key, text in given.items() if text for word in (key, text))]


def by_hand(program: str, options: Sequence[str]) -> str:
    """Return the command as a person types it."""
    return shlex.join([program, *options])
