"""Manual control of a pilot in the page: sliders, and keys while the page has the focus."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .helm import Helm

_STEP = 0.2
"""Of a deflection, for each key that is pressed."""
_FIRST = 1_000_000
"""Numbers of the faults by which a helm that somebody else orders is taken."""
_KEYS: tuple[tuple[Any, str, float], ...] = (
    ("W", "surge", _STEP),
    ("S", "surge", -_STEP),
    ("A", "yaw", -_STEP),
    ("D", "yaw", _STEP),
    ("Q", "sway", -_STEP),
    ("E", "sway", _STEP),
    ("F", "heave", _STEP),
    ("R", "heave", -_STEP),
)


class Pilot:
    """The helm of the pilots of a rig, by their terminal ``orders``."""

    def __init__(
        self, gui: Any, helm: Helm, command: Callable[..., None], orders: list[dict[str, Any]]
    ) -> None:
        for number, one in enumerate(orders):
            _Hands(gui, helm, command, one, _FIRST + 10 * number, keys=number == 0)


class _Hands:
    """Manual control of one pilot."""

    def __init__(
        self,
        gui: Any,
        helm: Helm,
        command: Callable[..., None],
        one: dict[str, Any],
        number: int,
        *,
        keys: bool,
    ) -> None:
        self._helm, self._command, self._one, self._number = helm, command, one, number
        self._acting: list[int] = []
        with gui.add_folder(f"Steer {one['component']}", expand_by_default=False):
            self._on = gui.add_checkbox("by hand", False, hint="W A S D, Q E, R F")
            self._sliders = {a: gui.add_slider(a, -1.0, 1.0, 0.05, 0.0) for a in one["axes"]}
            neutral = gui.add_button("Neutral (X)")
        self._on.on_update(self._switched)
        neutral.on_click(self._neutral)
        for slider in self._sliders.values():
            slider.on_update(self._moved)
        if keys:
            for key, axis, step in _KEYS:
                self._key(gui, key, axis, step)
            gui.add_command("neutral", hotkey="X").on_trigger(self._neutral)

    def _key(self, gui: Any, key: Any, axis: str, step: float) -> None:
        if axis not in self._sliders:
            return

        def pressed(event: Any) -> None:
            slider = self._sliders[axis]
            slider.value = min(max(slider.value + step, -1.0), 1.0)
            self._steer(event)

        gui.add_command(f"{axis} {step:+g}", hotkey=key).on_trigger(pressed)

    def _switched(self, event: Any) -> None:
        if event.client is None:
            return
        if not self._helm.may(event):
            self._on.value = not self._on.value
            return
        if self._on.value:
            self._write("mode", "manual")
            self._write("armed", True)
            self._send_manual()
        else:
            self._let_go()

    def _let_go(self) -> None:
        """Give back what somebody else orders; mode and arming are again as the rig began."""
        for slider in self._sliders.values():
            slider.value = 0.0
        if "manual" not in self._one["fed"]:
            self._send_manual()
        for member, value in self._one["before"].items():
            if member not in self._one["fed"]:
                self._write(member, value)
        for number in self._acting:
            self._command("clear", number)
        self._acting.clear()

    def _moved(self, event: Any) -> None:
        if event.client is not None:
            self._steer(event)

    def _steer(self, event: Any) -> None:
        if self._on.value and self._helm.may(event):
            self._send_manual()

    def _neutral(self, event: Any) -> None:
        for slider in self._sliders.values():
            slider.value = 0.0
        self._steer(event)

    def _send_manual(self) -> None:
        self._write("manual", [float(slider.value) for slider in self._sliders.values()])

    def _write(self, member: str, value: Any) -> None:
        """Set an order; one that something else feeds is replaced until the helm is let go."""
        key = f"{self._one['component']}.{self._one['ports'][member]}"
        if member not in self._one["fed"]:
            self._command("set", key, value)
            return
        for number in [n for n in self._acting if n % 10 == _MEMBERS.index(member)]:
            self._command("clear", number)
            self._acting.remove(number)
        number = self._number + _MEMBERS.index(member)
        self._number += 100
        self._command("fault", number, {"what": "fixed", "where": key, "value": value})
        self._acting.append(number)


_MEMBERS = ("mode", "armed", "manual")
