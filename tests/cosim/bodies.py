"""Coupled systems with closed forms: an adder chain, a decay, two bodies, added mass."""

TEXT = '''
"""Systems that have closed forms."""
import math
import random

from seatrial.model.component import Component, Input, Output, Parameter
from seatrial.model.plant import Plant, State
from seatrial.model.sampled import Sampled


class Counter(Component):
    """y = number of steps taken; nothing before the first."""

    y = Output("1", "steps")

    def start(self, t):
        self.count = 0

    def step(self, t, h):
        self.count += 1

    def outputs(self, t):
        self.y = self.count


class StepAdd(Component):
    """y = u + 1, computed by a step: whoever declares no feed-through is read after steps only."""

    u = Input("1", "input")
    y = Output("1", "u + 1 as of the last step")

    def start(self, t):
        self.sum = 0.0

    def step(self, t, h):
        self.sum = self.u + 1.0

    def outputs(self, t):
        self.y = self.sum


class Decay(Plant):
    """x' = -k u: Dahlquist's equation, if u is x."""

    rate = Parameter(1.0, "1/s", "k")
    u = Input("m", "what decays")
    x = State("m", "position", start=1.0)

    def equations(self, x, u, p):
        return {"x": -p.rate * u.u}, {}


class Body(Plant):
    """m v' = F - d v."""

    mass = Parameter(100.0, "kg", "mass")
    drag = Parameter(30.0, "N.s/m", "drag")
    force = Input("N", "force")
    x = State("m", "position", start=1.0)
    v = State("m/s", "velocity")

    def equations(self, x, u, p):
        return {"x": x.v, "v": (u.force - p.drag * x.v) / p.mass}, {}


class Appendage(Plant):
    """A body on a spring and damper: gives its force, takes the motion of what carries it."""

    mass = Parameter(8.0, "kg", "mass")
    stiffness = Parameter(400.0, "N/m", "spring")
    damping = Parameter(12.0, "N.s/m", "damper")
    x_hull = Input("m", "position of the hull")
    v_hull = Input("m/s", "velocity of the hull")
    force = Output("N", "force on the hull")
    y = State("m", "position")
    w = State("m/s", "velocity")
    feedthrough = {"force": ("x_hull", "v_hull")}

    def equations(self, x, u, p):
        force = p.stiffness * (x.y - u.x_hull) + p.damping * (x.w - u.v_hull)
        return {"y": x.w, "w": -force / p.mass}, {"force": force}


class Rigid(Component):
    """A body that gives its acceleration: m a = F + 1 N, as of its last step."""

    mass = Parameter(1.0, "kg", "mass")
    force = Input("N", "force")
    a = Output("m/s2", "acceleration")
    v = Output("m/s", "velocity")

    def start(self, t):
        self.acceleration, self.velocity = 0.0, 0.0

    def step(self, t, h):
        self.acceleration = (self.force + 1.0) / self.mass
        self.velocity += h * self.acceleration

    def outputs(self, t):
        self.a, self.v = self.acceleration, self.velocity


class AddedMass(Component):
    """The water's reaction: F = -m_a a, as of its last step."""

    mass = Parameter(0.5, "kg", "added mass")
    a = Input("m/s2", "acceleration")
    force = Output("N", "force")

    def start(self, t):
        self.reaction = 0.0

    def step(self, t, h):
        self.reaction = -self.mass * self.a

    def outputs(self, t):
        self.force = self.reaction


class Water(Component):
    """The same, at once."""

    mass = Parameter(0.5, "kg", "added mass")
    a = Input("m/s2", "acceleration")
    force = Output("N", "force")
    feedthrough = {"force": ("a",)}

    def outputs(self, t):
        self.force = -self.mass * self.a


class Accelerated(Component):
    """m a = F + 1 N, at once."""

    mass = Parameter(1.0, "kg", "mass")
    force = Input("N", "force")
    a = Output("m/s2", "acceleration")
    feedthrough = {"a": ("force",)}

    def outputs(self, t):
        self.a = (self.force + 1.0) / self.mass


class Coarse(Component):
    """Integrates its input by explicit Euler; takes no step above a limit after a time."""

    limit = Parameter(0.03, "s", "longest step")
    after = Parameter(0.35, "s", "before, any step will do")
    u = Input("m", "input")
    x = Output("m.s", "integral")
    taken = Output("1", "steps taken", type=int)

    def start(self, t):
        self.sum, self.count = 0.0, 0

    def step(self, t, h):
        if t >= self.after and h > self.limit:
            raise RuntimeError(f"step of {h} s is too long")
        self.sum += h * self.u
        self.count += 1

    def outputs(self, t):
        self.x, self.taken = self.sum, self.count


class Stubborn(Component):
    """Has no state to save."""

    rolls_back = False
    y = Output("m", "time")

    def outputs(self, t):
        self.y = t


class Opaque(Component):
    """Holds something that is no plain data."""

    y = Output("m", "time")

    def start(self, t):
        self.thing = object()

    def outputs(self, t):
        self.y = t


class Nominal(Component):
    """Doubles its input at each step, and says what is usual."""

    u = Input("m", "input")
    y = Output("m", "twice the input", nominal=2.0)

    def start(self, t):
        self.value = 1.0

    def step(self, t, h):
        self.value = 2.0 * self.u

    def outputs(self, t):
        self.y = self.value


class Wave(Component):
    """y = exp(growth k) sin(2 pi k / period + phase), k steps of 0.1 s from the start."""

    period = Parameter(10.0, "1", "steps per period")
    phase = Parameter(0.0, "1", "phase")
    growth = Parameter(0.0, "1", "growth per step")
    y = Output("m", "oscillation")

    def outputs(self, t):
        k = t / 0.1
        self.y = math.exp(self.growth * k) * math.sin(math.tau * k / self.period + self.phase)


class Switched(Component):
    """White noise of 1 mm, from 4 s on of 10 m."""

    seed = Parameter(0.0, "1", "seed")
    y = Output("m", "noise")

    def outputs(self, t):
        draw = random.Random(round(1000 * self.seed + t / 0.1)).gauss(0.0, 1.0)
        self.y = draw * (10.0 if t >= 4.0 else 1e-3)


class Usual(Component):
    """y = gain u + bias, at once, and says what is usual."""

    gain = Parameter(0.5, "1", "gain")
    bias = Parameter(1.0, "m", "bias")
    u = Input("m", "input")
    y = Output("m", "output", nominal=1.0)
    feedthrough = {"y": ("u",)}

    def outputs(self, t):
        self.y = self.gain * self.u + self.bias


class Blend(Component):
    """y = first u + second w + bias, at once."""

    first = Parameter(1.0, "1", "gain of u")
    second = Parameter(0.0, "1", "gain of w")
    bias = Parameter(0.0, "m", "bias")
    u = Input("m", "input")
    w = Input("m", "input")
    y = Output("m", "output")
    feedthrough = {"y": ("u", "w")}

    def outputs(self, t):
        self.y = self.first * self.u + self.second * self.w + self.bias


class Jumps(Sampled):
    """y = 1e-12 (-10)^k, held from one instant to the next."""

    y = Output("m/s2", "jumps")

    def sample(self, t, k):
        self.y = 1e-12 * (-10.0) ** k
'''
