"""Trained networks as components: the ports of a policy's file, and what its network does."""

from __future__ import annotations

import hashlib
import json
import math
from functools import lru_cache
from typing import Any, ClassVar

from seatrial.model.component import Component, Input, Output, Parameter, terminal
from seatrial.model.dense import Dense, dense
from seatrial.model.sampled import Sampled


class Network(Component):
    """A trained network between inputs and outputs that a file declares.

    Observations o are expressions of the inputs, SI. One with a range is scaled and limited to
    -1 to 1, 2 (o - low) / (high - low) - 1. The network's steps follow one upon the other, in
    doubles: dense layers W x + b, summed from b on in the order of x; scales a x + b; limits; and

        relu  max(x, 0)            leaky_relu  x, below 0 alpha x     sigmoid   1 / (1 + exp(-x))
        tanh  tanh(x)              elu         x, below 0 alpha (exp(x) - 1)
        softplus  log(1 + exp(x))

    Actions become outputs: one with a range is limited to -1 to 1, which are low and high.

    ``inside`` and ``outside`` are there if the file says ranges of training: whether all
    observations are within theirs, and how many are not. The network acts all the same.
    """

    _program: ClassVar[tuple[Any, ...]] = ()
    """Operations with their operands, a number or earlier operations; inputs are given by place."""
    _observed: ClassVar[tuple[int, ...]] = ()
    """The operations whose results are the observations."""
    _scaled: ClassVar[tuple[tuple[float, ...], ...]] = ()
    """Low and high of each observation; nothing: as it is."""
    _trained: ClassVar[tuple[tuple[float, ...], ...]] = ()
    """Lowest and highest value of each observation in training; nothing: not known."""
    _steps: ClassVar[tuple[tuple[Any, ...], ...]] = ()
    _acted: ClassVar[tuple[tuple[float, ...], ...]] = ()
    """Low and high of each action, in the unit of its output; nothing: as it is."""
    _inputs_by_name: ClassVar[tuple[tuple[str, bool], ...]] = ()
    """Names of the inputs, and whether each has axes."""
    _outputs_by_name: ClassVar[tuple[tuple[str, bool, tuple[int, ...]], ...]] = ()
    """Names of the outputs, whether each has axes, and the actions that it is."""

    def _act(self) -> None:
        """Observe, ask the network, and publish its actions."""
        observed = self._observations()
        if any(self._trained):
            self._compare(observed)
        values = self._answer(self._normalised(observed))
        actions = []
        for value, limits in zip(values, self._acted, strict=True):
            if limits:
                share = 0.5 * (min(max(value, -1.0), 1.0) + 1.0)
                actions.append(limits[0] + share * (limits[1] - limits[0]))
            else:
                actions.append(value)
        for name, has_axes, places in self._outputs_by_name:
            given = [actions[place] for place in places]
            setattr(self, name, given if has_axes else given[0])

    def _observations(self) -> list[float]:
        """Return the observations, SI."""
        measured: list[float] = []
        for name, has_axes in self._inputs_by_name:
            given = getattr(self, name)
            measured = [*measured, *given] if has_axes else [*measured, given]
        found: list[float] = []
        for operation, a, b in self._program:
            match operation:
                case "input":
                    value = measured[a]
                case "number":
                    value = a
                case "+":
                    value = found[a] + found[b]
                case "-":
                    value = found[a] - found[b]
                case "*":
                    value = found[a] * found[b]
                case "/":
                    value = found[a] / found[b]
                case "negative":
                    value = -found[a]
                case "abs":
                    value = abs(found[a])
                case "min":
                    value = min(found[a], found[b])
                case "max":
                    value = max(found[a], found[b])
                case "sqrt":
                    value = math.sqrt(found[a])
                case "sin":
                    value = math.sin(found[a])
                case "cos":
                    value = math.cos(found[a])
                case "tan":
                    value = math.tan(found[a])
                case "atan2":
                    value = math.atan2(found[a], found[b])
                case _:  # wrap, to (-pi, pi]
                    value = math.pi - (math.pi - found[a]) % math.tau
            found.append(value)
        return [found[place] for place in self._observed]

    def _compare(self, observed: list[float]) -> None:
        """Publish how many observations are outside of the ranges of training."""
        outside = 0
        for value, limits in zip(observed, self._trained, strict=True):
            if limits:
                outside += 0 if limits[0] <= value <= limits[1] else 1
        self.outside = outside
        self.inside = outside == 0

    def _normalised(self, observed: list[float]) -> list[float]:
        """Return the observations as the network takes them."""
        found = []
        for value, limits in zip(observed, self._scaled, strict=True):
            if limits:
                value = 2.0 * (value - limits[0]) / (limits[1] - limits[0]) - 1.0
                value = min(max(value, -1.0), 1.0)
            found.append(value)
        return found

    def _answer(self, values: list[float]) -> list[float]:
        """Return what the network makes of its inputs."""
        for kind, a, b in self._steps:
            match kind:
                case "dense":
                    values = dense(a, values)
                case "scale":
                    values = [each * s + o for each, s, o in zip(values, a, b, strict=True)]
                case "clip":
                    values = [min(max(each, a), b) for each in values]
                case "relu":
                    values = [max(each, 0.0) for each in values]
                case "leaky_relu":
                    values = [each if each > 0.0 else a * each for each in values]
                case "tanh":
                    values = [math.tanh(each) for each in values]
                case "sigmoid":
                    values = [_sigmoid(each) for each in values]
                case "elu":
                    values = [each if each > 0.0 else a * math.expm1(each) for each in values]
                case _:  # softplus
                    values = [max(each, 0.0) + math.log1p(math.exp(-abs(each))) for each in values]
        return values


class SampledNetwork(Network, Sampled):
    """A `Network` that acts at the instants of its period, and holds its outputs between them."""

    def sample(self, t: float, k: int) -> None:
        """Act."""
        self._act()


class StaticNetwork(Network):
    """A `Network` whose outputs follow its inputs at once."""

    def outputs(self, t: float) -> None:
        """Act."""
        self._act()


def _sigmoid(x: float) -> float:
    small = math.exp(-abs(x))
    return (1.0 if x > 0.0 else small) / (1.0 + small)


@lru_cache(maxsize=64)
def policy_component(text: str) -> type[Network]:
    """Return the component of a policy, as `policy_file.frozen_policy` writes it."""
    content = json.loads(text)
    base: type[Network] = StaticNetwork if content["period"] is None else SampledNetwork
    inputs = {port["name"]: _port(Input, port) for port in content["inputs"]}
    outputs = {port["name"]: _port(Output, port) for port in content["outputs"]}
    own: dict[str, Any] = {**inputs, **outputs}
    if any(content["trained"]):
        own["inside"] = Output("1", "whether all observations are as in training", type=bool)
        own["outside"] = Output("1", "observations outside of their range in training", type=int)
    if content["period"] is not None:
        own["period"] = Parameter(content["period"], "s", "sample period", min=1e-6)
    published = [name for name, port in own.items() if isinstance(port, Output)]
    return type(
        f"Policy_{hashlib.sha256(text.encode()).hexdigest()[:12]}",
        (base,),
        {
            **own,
            "__doc__": content["title"] or f"Network of {content['file']}.",
            "__module__": __name__,
            "terminals": {n: terminal(*members) for n, members in content["terminals"].items()},
            "feedthrough": dict.fromkeys(published, tuple(inputs)),
            "_program": tuple(map(tuple, content["program"])),
            "_observed": tuple(content["observed"]),
            "_scaled": tuple(map(tuple, content["scaled"])),
            "_trained": tuple(map(tuple, content["trained"])),
            "_steps": tuple(_step(*step) for step in content["steps"]),
            "_acted": tuple(map(tuple, content["acted"])),
            "_inputs_by_name": tuple((n, port.axes is not None) for n, port in inputs.items()),
            "_outputs_by_name": tuple(
                (port["name"], port["axes"] is not None, tuple(port["places"]))
                for port in content["outputs"]
            ),
        },
    )


def _port(kind: type[Input] | type[Output], content: Any) -> Any:
    unit, axes = content["unit"], content["axes"]
    port = kind(
        tuple(unit) if isinstance(unit, list) else unit,
        content["description"],
        axes=axes,
        frame=content["frame"],
    )
    port.name = content["name"]
    return port


def _step(kind: str, a: Any = 0.0, b: Any = 0.0) -> tuple[Any, ...]:
    if kind == "dense":
        return kind, Dense(a, b), 0.0
    return kind, *(tuple(each) if isinstance(each, list) else each for each in (a, b))


RESERVED = frozenset((*dir(SampledNetwork), "name", "values", "inside", "outside"))
"""Names that a port cannot have: attributes of the component."""
