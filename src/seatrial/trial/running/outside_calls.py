"""Calls of a run to what its files do not decide: clocks, global generators, the environment."""

from __future__ import annotations

import datetime
import os
import random
import sys
import sysconfig
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import numpy as np

from ...kits import OURS
from ...system.system import System
from .call_trace import CallTrace

_CLOCKS = ("time", "monotonic", "perf_counter", "process_time")
_C_CALLS: dict[Any, str] = {
    **{getattr(time, n + end): f"time.{n}{end}" for n in _CLOCKS for end in ("", "_ns")},
    **{getattr(time, name): f"time.{name}" for name in ("localtime", "gmtime", "ctime")},
    os.urandom: "os.urandom",
    random.random: "random.random",
    random.getrandbits: "random.getrandbits",
    datetime.datetime.now: "datetime.now",
    datetime.datetime.utcnow: "datetime.utcnow",
    datetime.date.today: "date.today",
}
_READ: CodeType = type(os.environ).__getitem__.__code__
_SEEDED: CodeType = random.Random.seed.__code__
_LIBRARIES = (sysconfig.get_path("stdlib"), sysconfig.get_path("platlib"), "<frozen")
_PACKAGES = Path(__file__).parents[3]
_OWN = tuple(str(_PACKAGES / name) + os.sep for name in OURS)
_COMPONENTS = tuple(
    str(_PACKAGES / name) + os.sep
    for name in (
        "seatrial/physics", "seatrial/devices", "seatrial/control", "seatrial/links",
        "seatrial_kits",
    )
)  # fmt: skip
"""Where our components are: the rest is what runs them, and has its clocks."""


class OutsideCalls:
    """Notes such calls, each with the component in whose call it was made, and the place.

    Calls of what runs the components are not noted.
    """

    def __init__(self) -> None:
        self._trace, self._names = CallTrace(), list[str]()
        self._loading = ""
        self._counts: Counter[tuple[str, str, str]] = Counter()

    def building(self, what: str) -> None:
        """Take the name of the component that is loaded: ``NAME (KIND)``."""
        self._loading = what.partition(" (")[0]

    def assembled(self, system: System, _manifest: object) -> None:
        """Trace the calls of a rig's components."""
        self._names = list(system.parts)
        for number, part in enumerate(system.parts.values()):
            part.instance = self._trace.traced(part.instance, number)

    def found(self) -> dict[str, list[str]]:
        """Return a line for each kind of call, by component."""
        lines: dict[str, list[str]] = {}
        for (component, called, place), count in sorted(self._counts.items()):
            times = f" {count} times" if count > 1 else ""
            lines.setdefault(component, []).append(f"{called} ({place}){times}")
        return lines

    @contextmanager
    def noted(self) -> Iterator[None]:
        """Note calls of what runs inside, on all threads that it starts."""
        originals = {
            name: function
            for name, function in vars(np.random).items()
            if getattr(function, "__self__", None) is np.random.mtrand._rand
        }
        for name, function in originals.items():
            setattr(np.random, name, self._numpy(name, function))
        threading.setprofile(self._profile)
        sys.setprofile(self._profile)
        try:
            yield
        finally:
            sys.setprofile(None)
            threading.setprofile(None)
            for name, function in originals.items():
                setattr(np.random, name, function)

    # ------------------------------------------------------------------ inside

    def _profile(self, frame: FrameType, event: str, argument: Any) -> None:
        if event == "c_call":
            called = _C_CALLS.get(argument)
            if called is not None:
                self._note(called, frame)
        elif event == "call":
            if frame.f_code is _READ:
                self._note(f"os.environ[{frame.f_locals['key']!r}]", frame.f_back)
            elif frame.f_code is _SEEDED and frame.f_locals.get("a") is None:
                self._note("random.Random()", frame.f_back)

    def _numpy(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(function)
        def called(*arguments: Any, **named: Any) -> Any:
            self._note(f"numpy.random.{name}", sys._getframe(1))
            return function(*arguments, **named)

        return called

    def _note(self, called: str, frame: FrameType | None) -> None:
        while frame is not None and frame.f_code.co_filename.startswith(_LIBRARIES):
            frame = frame.f_back
        if frame is None:
            return
        code = frame.f_code
        component, _ = self._trace.entry(self._names)
        in_component = component and not called.startswith("os.environ")
        heeded = in_component and code.co_filename.startswith(_COMPONENTS)
        if code.co_filename.startswith(_OWN) and not heeded:
            return
        place = f"{Path(code.co_filename).name}:{frame.f_lineno} in {code.co_name}"
        self._counts[component or self._loading, called, place] += 1
