"""A rig with closed forms: a source, a lag, a body on a spring, and values of every type."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

COMPONENTS = '''
"""Small components."""
import math

from seatrial.model.component import Component, Input, Output, Parameter
from seatrial.model.plant import Plant, State


class Source(Component):
    """y = level, at once."""

    level = Parameter(1.0, "V", "level", tunable=True, min=0.0, max=10.0)
    y = Output("V", "level")

    def outputs(self, t):
        self.y = self.level


class Lag(Component):
    """T y' = u - y, exact for an input that is held."""

    time_constant = Parameter(0.5, "s", "time constant", min=1e-6)
    u = Input("V", "signal")
    y = Output("V", "filtered signal")

    def start(self, t):
        self._y = 0.0

    def step(self, t, h):
        self._y += (self.u - self._y) * -math.expm1(-h / self.time_constant)

    def outputs(self, t):
        self.y = self._y


class Body(Plant):
    """m v' = F."""

    mass = Parameter(1.0, "kg", "mass")
    force = Input("N", "force")
    x = State("m", "position", start=1.0)
    v = State("m/s", "velocity")

    def equations(self, x, u, p):
        return {"x": x.v, "v": u.force / p.mass}, {}


class Spring(Component):
    """F = -k (x - x0) at once."""

    stiffness = Parameter(1.0, "N/m", "k")
    rest = Input("m", "x0")
    x = Input("m", "end")
    force = Output("N", "force on the end")
    feedthrough = {"force": ("x", "rest")}

    def outputs(self, t):
        self.force = -self.stiffness * (self.x - self.rest)


class Types(Component):
    """Values of every type; it fails at a time."""

    fails = Parameter(1e9, "s", "time of the failure")
    place = Input("m", "where", axes="xyz")
    turn = Output("rad", "an angle")
    flag = Output("1", "flag", type=bool)
    count = Output("1", "count", type=int)
    text = Output("1", "text", type=str)
    echo = Output("m", "place", axes="xyz")
    feedthrough = {"echo": ("place",)}

    def step(self, t, h):
        if t >= self.fails - 1e-9:
            raise ZeroDivisionError("the boat has sunk")

    def outputs(self, t):
        self.turn = t
        self.flag = t >= 0.5
        self.count = round(t * 100)
        self.text = f'at "{t:.2f}", é'
        self.echo = self.place


class Overshoot(Component):
    """y after a step is -1.5 u: in a loop with itself it swings from step to step, and grows."""

    u = Input("N", "force")
    y = Output("N", "the next one")

    def start(self, t):
        self._y = 1e-3

    def step(self, t, h):
        self._y = -1.5 * self.u

    def outputs(self, t):
        self.y = self._y


class Careful(Component):
    """Refuses long steps after a second; counts what it takes, in s."""

    y = Output("s", "length of all steps")
    halves = Output("1", "short steps", type=int)

    def start(self, t):
        self._y, self._halves = 0.0, 0

    def step(self, t, h):
        if t > 0.99 and h > 0.06:
            raise ValueError("that is too long")
        self._y += h
        self._halves += h < 0.06

    def outputs(self, t):
        self.y, self.halves = self._y, self._halves


class Outside(Component):
    """Has a world of its own."""

    rolls_back = False
    y = Output("1", "nothing")
'''
RIG = """
step = "100 ms"
algorithm = "{algorithm}"

[components]
source = {{ fmu = "parts.py:Source" }}
lag    = {{ fmu = "parts.py:Lag"{slow} }}
body   = {{ fmu = "parts.py:Body" }}
spring = {{ fmu = "parts.py:Spring" }}
types  = {{ fmu = "parts.py:Types" }}

[connections]
"source.y"     = "lag.u"
"body.x"       = "spring.x"
"spring.force" = "body.force"
"""
TRIAL = """
rig = "rig.toml"
stop = "3 s"

[[events]]
at = "500 ms"
set = { "source.level" = "2 V", "types.place" = ["10 cm", 0.2, 0.3] }

[[faults]]
what = "fixed"
where = "lag.u"
value = 5.0
at = "1 s"
for = "1 s"

[[faults]]
what = "fixed"
where = "spring.force"
value = "-300 mN"
at = "1 s"
for = "1 s"

[[criteria]]
name = "the lag stays low"
check = "lag.y < 3 V"

[[criteria]]
name = "the body stays near"
check = "abs(body.x) < 200 cm"
"""


@pytest.fixture
def rig(tmp_path: Path) -> Callable[..., str]:
    """Return a function that writes the components and a rig, and returns its path."""

    def write(
        algorithm: str = "jacobi", slow: str = "", more: str = "", connection: str = ""
    ) -> str:
        (tmp_path / "parts.py").write_text(COMPONENTS, "utf-8")
        text = RIG.format(algorithm=algorithm, slow=slow)
        path = tmp_path / "rig.toml"
        text = text.replace("[connections]", f"{more}\n[connections]") + connection
        path.write_text(text, "utf-8")
        return str(path)

    return write


@pytest.fixture
def trial(rig: Callable[..., str], tmp_path: Path) -> str:
    """Write a trial with events on that rig, and return its path."""
    rig()
    path = tmp_path / "trial.toml"
    path.write_text(TRIAL, "utf-8")
    return str(path)
