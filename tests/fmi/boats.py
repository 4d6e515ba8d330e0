"""Components that the FMI tests build into FMUs, as users' files."""

COUNTER = '''
"""A user's file."""
from seatrial.model.component import Component, Input, Output, Parameter


class Counter(Component):
    """Sums its input; half of its state is in attributes that are no ports."""

    gain = Parameter(0.1, "1", "gain", min=-5.0, max=5.0)
    bias = Parameter((0.1, 1.0 / 3.0), "m", "bias", axes="ab")
    label = Parameter("plain", "1", "label")
    knob = Parameter(1.0, "1", "may change", tunable=True)
    u = Input("m", "input", min=-1e3, max=1e3, nominal=2.5)
    on = Input("1", "switch", type=bool)
    many = Input("1", "count", type=int)
    say = Input("1", "text", type=str)
    total = Output("m", "sum")
    through = Output("m", "gain times input")
    steps = Output("1", "steps", type=int)
    was_on = Output("1", "switch", type=bool)
    said = Output("1", "text", type=str)

    feedthrough = {"through": ("u",), "said": ("say",), "was_on": ("on",)}

    def start(self, t):
        self.hidden = [0.0, {"steps": 0}]

    def step(self, t, h):
        if self.say == "raise":
            raise ValueError("100% broken %s %d")
        if self.say == "nan":
            self.hidden[0] = float("nan")
        if self.say == "exit":
            raise SystemExit(3)
        self.hidden[0] += self.u
        self.hidden[1]["steps"] += 1

    def outputs(self, t):
        if self.say == "bad output":
            raise RuntimeError("outputs cannot be had")
        self.total = self.hidden[0]
        self.steps = self.hidden[1]["steps"]
        self.through = self.gain * self.u * self.knob
        self.was_on = self.on
        self.said = self.say if self.say != "nul" else "a" + chr(0) + "b"
'''

USES_HELPER = '''
import constants
from constants import NUMBER as number
from seatrial.model.component import Component, Output


class Boat(Component):
    """Publishes a number of the helper beside it."""

    value = Output("1", "the number")

    def outputs(self, t):
        self.value = constants.NUMBER + 0 * number
'''

BARGE = '''
"""A user's craft with terminals."""
from seatrial.model.component import Component, Input, Output
from seatrial.model.terminals import terminal
from seatrial.model.terms import Terms


class Barge(Component):
    """Adds the loads on it."""

    force = Terms(3, "N", "force on the barge", axes="xyz")
    moment = Terms(2, "N.m", "moment on the barge", axes="xyz")
    lift = Terms(2, "N", "lift")
    pulse = Input("s", "pulse")
    position = Output("m", "place", axes="xyz")
    attitude = Output("rad", "Euler angles", axes=("phi", "theta", "psi"))
    depth = Output("m", "depth of its only gauge", axes=("a",))
    said = Output("1", "text", type=str)

    terminals = {
        "motion": terminal("position", "attitude"),
        "wrench": terminal("force", "moment", "lift", rule="plug"),
        "actuators": terminal(ch1="pulse"),
        "reading": terminal("depth", "said", heel="attitude__phi"),
    }

    def outputs(self, t):
        self.position, self.attitude = self.force, (0.0, 0.0, 0.0)
        self.depth = (self.lift + self.moment[0],)
'''
