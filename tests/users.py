"""Components of users that the master's tests connect."""

CHAIN = '''
"""Small components for rigs."""
from seatrial.model.component import Component, Input, Output, Parameter
from seatrial.model.sampled import Sampled


class Ramp(Component):
    """y = t."""

    y = Output("m", "ramp")

    def outputs(self, t):
        self.y = t


class Add(Component):
    """y = u + 1, at once."""

    u = Input("m", "input")
    y = Output("m", "u + 1")
    feedthrough = {"y": ("u",)}

    def outputs(self, t):
        self.y = self.u + 1.0


class Scale(Component):
    """y = gain u + bias, at once."""

    gain = Parameter(0.5, "1", "gain")
    bias = Parameter(1.0, "m", "bias")
    u = Input("m", "input")
    y = Output("m", "output")
    feedthrough = {"y": ("u",)}

    def outputs(self, t):
        self.y = self.gain * self.u + self.bias


class Sum(Component):
    """Integrates its input by explicit Euler."""

    rate = Parameter(1.0, "1/s", "rate", tunable=True)
    u = Input("m", "input")
    angle = Input("rad", "an angle")
    on = Input("1", "switch", type=bool)
    x = Output("m", "sum")
    seen = Output("rad", "the angle as it arrived")

    def start(self, t):
        self.state = 0.0

    def step(self, t, h):
        self.state += h * self.rate * self.u

    def outputs(self, t):
        self.x, self.seen = self.state, self.angle
    feedthrough = {"seen": ("angle",)}


class Limited(Component):
    """A parameter with a limit."""

    width = Parameter(0.5, "m", "width", max=0.55, tunable=True)
    y = Output("m", "the width")

    def outputs(self, t):
        self.y = self.width


class Bad(Component):
    """Fails at a time, in a way."""

    when = Parameter(0.5, "s", "time of the failure")
    how = Parameter("raise", "1", "how", choices=("raise", "nan"))
    y = Output("m", "fine until then")

    def step(self, t, h):
        if t >= self.when - 1e-9:
            if self.how == "raise":
                raise ZeroDivisionError("the boat has sunk")
            self.y = float("nan")
        else:
            self.y = t


class Turn(Component):
    """Publishes an angle in degrees, a flag, a count and a text."""

    a = Output("deg", "angle")
    flag = Output("1", "flag", type=bool)
    count = Output("1", "count", type=int)
    text = Output("1", "text", type=str)

    def outputs(self, t):
        self.a = 90.0 + 10.0 * t
        self.flag = t >= 0.5
        self.count = round(t * 100)
        self.text = f'at "{t:.2f}", é'


class Inverse(Component):
    """y = 1 / (0.5 - u), at once."""

    u = Input("m", "input")
    y = Output("1/m", "output")
    feedthrough = {"y": ("u",)}
    as_nan = Parameter(0.0, "1", "NaN instead of an exception")

    def outputs(self, t):
        if self.as_nan and self.u >= 0.5:
            self.y = float("nan")
        else:
            self.y = 1.0 / (0.5 - self.u)


class Odd(Component):
    """Outputs that FMI cannot carry, or an exit."""

    how = Parameter("fine", "1", "how")
    count = Output("1", "count", type=int)
    text = Output("1", "text", type=str)

    def step(self, t, h):
        if self.how == "exit":
            raise SystemExit(5)

    def outputs(self, t):
        if self.how == "big" and t > 0.05:
            self.count = 2**31
        if self.how == "nul" and t > 0.05:
            self.text = "a" + chr(0)
        if self.how == "surrogate" and t > 0.05:
            self.text = chr(0xD800)


class Kelvin(Component):
    """Shows a temperature and a count as real numbers."""

    k = Input("K", "temperature")
    n = Input("1", "count")
    t = Input("m", "pair", axes="ab")
    z = Output("K", "temperature")
    r = Output("1", "count")
    feedthrough = {"z": ("k",), "r": ("n",)}

    def outputs(self, t):
        self.z, self.r = self.k, self.n


class Celsius(Component):
    """A temperature and a count."""

    y = Output("degC", "temperature")
    n = Output("1", "count", type=int)

    def outputs(self, t):
        self.y, self.n = 20.0, 3


class Clock(Sampled):
    """Samples its input every period."""

    u = Input("m", "input")
    y = Output("m", "as sampled")
    k = Output("1", "samples taken", type=int)
    feedthrough = {"y": ("u",)}

    def reset(self, t):
        self.taken = 0

    def sample(self, t, k):
        self.y = self.u

    def update(self, t, k):
        self.taken += 1

    def hold(self, t):
        self.k = self.taken
'''
