"""Findings about a component and its mistakes, remembered by the hash of its code."""

from __future__ import annotations

import ast
import difflib
import hashlib
import json
import math
import random
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ... import __version__
from ...errors import InputError
from ...kits import is_ours
from ...model.component import Component, Input
from ...model.plant import Plant
from ...model.ports import Output, Port
from ...model.sampled import Sampled
from ..cache import cache_folder, write_named
from ..components.source import ComponentSource
from .found import Through, feedthrough_of, found
from .text import first_argument, methods, self_names, tree_of
from .values import UndecidedError


@dataclass(frozen=True)
class Checked:
    """What a component's outputs depend on."""

    through: Through
    undecided: str
    """Why that of undeclared outputs is unknown, if so: they depend on all inputs."""


def refuse_mistakes(cls: type[Component]) -> None:
    """Raise InputError for outputs that nothing sets, and declarations that are wrong."""
    refuse_mistyped(cls)
    refuse_dependent(cls)


def checked(source: ComponentSource, code: str) -> Checked:
    """Return what the outputs of a component depend on, from the user's cache if it is there.

    ``code`` is the name of its bundle, which carries the hash of its code. Raises InputError as
    `refuse_mistakes` does.
    """
    path = cache_folder("feedthrough") / f"{code}-{_tag()}.json"
    try:
        content = json.loads(path.read_bytes())
        through = {name: tuple(inputs) for name, inputs in content["through"].items()}
        return Checked(through, content["undecided"])
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        pass
    made = check(source.component_class())
    content = {"through": made.through, "undecided": made.undecided}
    write_named(path, json.dumps(content).encode())
    return made


def check(cls: type[Component]) -> Checked:
    """Return what the outputs of a class depend on. Raises InputError as `refuse_mistakes` does."""
    refuse_mistakes(cls)
    through = feedthrough_of(cls)
    is_known = all(name in cls.feedthrough for name in through)
    return Checked(through, "" if is_known else found(cls).undecided)


@cache
def _tag() -> str:
    """Return a tag of what besides the component's code decides what is found."""
    digest = hashlib.sha256(__version__.encode())
    for module in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(module.read_bytes())
    return digest.hexdigest()[:8]


_NEAR = 0.8
_NAMED = ("getattr", "hasattr", "setattr")
_PLAIN = ("isinstance", "super", "type", "id")
_ZERO = ([0], [0.0], [""], [False])


def refuse_mistyped(cls: type[Component]) -> None:
    """Raise InputError for an output that nothing sets, or an attribute nearly called as a port.

    An attribute is meant that is read and never set, or set and never read; its name has no
    underscore first, and differs little from a port's. Classes whose text hands ``self`` on, or
    sets attributes by computed names, are not checked: there anything may be set. An
    output whose declaration gives a start value other than zero may be a constant, a text may
    have nothing to say, and a class without a method does nothing on purpose.
    """
    try:
        own = [function for function in methods(cls) if not is_ours(function.__module__)]
        if any(_hands_on(tree_of(function)) for function in own):
            return
        named = self_names(cls)
        texts = {text for function in own for text in _texts(tree_of(function))}
    except UndecidedError:
        return
    used = {name: places for name, places in named.items() if name not in dir(cls)}
    unset = [name for name in _set_by_text(cls) if name not in texts and not _is_set(name, named)]
    for name in unset if own else ():
        near = difflib.get_close_matches(name, used, n=1, cutoff=_NEAR)
        if cls.ports[name].type is str and not near:  # it has nothing to say
            continue
        hint = f"; {_place(used[near[0]][0])} has self.{near[0]}" if near else ""
        raise InputError(f"{cls.__name__}: nothing sets the output {name!r}{hint}")
    for name, places in used.items():
        ways = {reads for _, _, reads in places}
        near = difflib.get_close_matches(name, cls.ports, n=1, cutoff=_NEAR)
        if len(ways) == 1 and near and not name.startswith("_") and name not in texts:
            way, other = ("reads", "sets") if ways.pop() else ("sets", "reads")
            raise InputError(
                f"{cls.__name__}: {_place(places[0])} {way} self.{name}, which nothing {other}; "
                f"did you mean the {cls.ports[near[0]].kind} {near[0]!r}?"
            )


def _set_by_text(cls: type[Component]) -> Iterator[str]:
    """Yield the outputs that the methods of a user's class have to set."""
    if issubclass(cls, Plant):  # its equations give every output, or are refused
        return
    for base in cls.__mro__:
        if is_ours(base.__module__):
            continue
        for name in vars(base).get("_declared", ()):
            port = cls.ports[name]
            if type(port) is Output and port.start[:1] in _ZERO and not port.role:
                yield name


def _is_set(name: str, named: dict[str, list[tuple[ast.Attribute, str, bool]]]) -> bool:
    return any(not reads for _, _, reads in named.get(name, ()))


def _texts(tree: ast.AST) -> Iterator[str]:
    """Yield the texts of a function: a name that is set by its text is among them."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def _hands_on(tree: ast.FunctionDef | ast.Lambda) -> bool:
    """Say if a method does with ``self`` what its text does not show."""
    me = first_argument(tree)
    plain: set[ast.AST] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            if node.attr in ("values", "__dict__") and _is(node.value, me):
                return True
            plain.add(node.value)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            by_text = len(node.args) > 1 and isinstance(node.args[1], ast.Constant)
            if node.func.id in _PLAIN or (node.func.id in _NAMED and by_text):
                plain |= set(node.args)
        elif _is(node, me) and node not in plain:
            return True
    return False


def _is(node: ast.AST, me: str | None) -> bool:
    return isinstance(node, ast.Name) and node.id == me


def _place(place: tuple[ast.Attribute, str, bool]) -> str:
    return f"{Path(place[1]).name}, line {place[0].lineno},"


_POINTS = 12
_SPAN = 2.0
"""Inputs without limits are tried between minus and plus so much."""
_STEP_S = 0.01


def refuse_dependent(cls: type[Component]) -> None:
    """Raise InputError if an output follows from an input that its declaration leaves out.

    Both are tried at several points of a run with random inputs within their limits. A
    component that reaches outside is not started; one that refuses the values is not checked.
    """
    narrowed = _narrowed(cls)
    if not narrowed or not cls.rolls_back:
        return
    draw = random.Random(1)
    try:
        component = cls(cls.__name__)
        _begin(component)
    except Exception:  # it needs what only a rig gives, such as files
        return
    step = component.fixed_step or (component.period if isinstance(component, Sampled) else _STEP_S)
    for point in range(1, _POINTS + 1):  # before the first step states may follow from inputs
        try:
            component.advance((point - 1) * step, step)
            for port in _inputs(cls):
                component.set(port.name, _drawn(port, draw))
            shown = {output: component.get(output) for output in narrowed}
        except Exception:
            return
        for name in sorted({name for inputs in narrowed.values() for name in inputs}):
            _try(component, name, draw, narrowed, shown)


def _begin(component: Component) -> None:
    for name, value in component.exercised.items():
        component.set(name, value)
    component.setup(0.0)
    component.initialise()
    component.begin()


def _narrowed(cls: type[Component]) -> dict[str, set[str]]:
    """Return the inputs that may act on outputs, and that their declarations leave out."""
    by_equations = cls.output_ports if issubclass(cls, Plant) else ()
    checked = {port.name for port in by_equations}
    if not cls.feedthrough.keys() - checked:
        return {}
    through = found(cls).through
    left_out = {
        output: set(through[output]) - set(inputs)
        for output, inputs in cls.feedthrough.items()
        if output not in checked
    }
    return {output: inputs for output, inputs in left_out.items() if inputs}


def _inputs(cls: type[Component]) -> Iterable[Port]:
    return (port for port in cls.ports.values() if port.kind == "input")


def _drawn(port: Port, draw: random.Random) -> Any:
    """Return a random value of an input, within its limits."""
    if port.type is str:
        choices = port.choices if isinstance(port, Input) else ()
        return draw.choice(choices) if choices else port.start[0]
    values = []
    for index in range(port.size):
        least, most = port.limit("min", index), port.limit("max", index)
        low = -_SPAN if least is None else least
        high = max(low, _SPAN if most is None else most)
        low = min(low, high)
        number = draw.uniform(low, high)
        values.append(number > 0.0 if port.type is bool else port.type(number))
    return values if port.axes else values[0]


def _alike(a: Any, b: Any) -> bool:
    """Say if two values differ by no more than what is left where a loop has settled."""
    if isinstance(a, list):
        return all(map(_alike, a, b))
    return a == b or (isinstance(a, float) and math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12))


def _try(
    component: Component,
    name: str,
    draw: random.Random,
    narrowed: dict[str, set[str]],
    shown: dict[str, Any],
) -> None:
    """Change one input, compare the outputs that do not depend on it, and change it back."""
    before, value = component.get(name), _drawn(component.ports[name], draw)
    try:
        component.set(name, value)
        changed = {output: component.get(output) for output in narrowed if name in narrowed[output]}
    except Exception:
        changed = {}
    component.set(name, before)
    for output, found_now in changed.items():
        if not _alike(found_now, shown[output]):
            raise InputError(
                f"{type(component).__name__}.feedthrough says that {output!r} does not depend on "
                f"{name!r}, but at the same instant {output} is {shown[output]!r} with {name} = "
                f"{before!r} and {found_now!r} with {name} = {value!r}: name it there, or leave "
                f"{output!r} out, then it is found"
            )
