"""Sets and faults of a live page as events and faults of a trial file."""

from __future__ import annotations

import json
from typing import Any

from seatrial.trial.files.trial import Trial


class ByHand:
    """Sets, faults and their ends, at the times at which the run took them."""

    def __init__(self, trial: Trial) -> None:
        self._trial = trial
        self._events: list[tuple[float, str, Any]] = []
        self._faults: dict[int, dict[str, Any]] = {}

    def __bool__(self) -> bool:
        return bool(self._events or self._faults)

    def add(self, time: float, what: str, key: Any, written: Any) -> None:
        """Note what the run says that it has done."""
        if what == "set":
            self._events.append((time, key, written))
        elif what == "fault":
            self._faults[key] = {**written, "at": f"{time!r} s"}
        elif what == "clear":
            begun = float(self._faults[key]["at"].split()[0])
            lasts = round(time - begun, 9)
            if lasts > 0.0:
                self._faults[key]["for"] = f"{lasts!r} s"
            else:
                del self._faults[key]

    def text(self) -> str:
        """Return the trial's own file, with what was done after it.

        Settings of the command line are not in files: a comment says which to give again.
        """
        path = self._trial.read_from.path
        lines = [f"# {path.name} and what was done by hand; names of files are relative to it."]
        again = [f"--set {key}={_toml(value)}" for key, value, _ in self._trial.overrides]
        if again:
            lines.append(f"# Run with: {' '.join(again)}")
        own = self._trial.read_from.path.read_text("utf-8") if _is_trial(self._trial) else ""
        lines.append(own.rstrip() or _of_rig(self._trial))
        for time, key, written in self._events:
            values = f"{{ {_toml(key)} = {_toml(written)} }}"
            lines += ["", "[[events]]", f'at  = "{time!r} s"', f"set = {values}"]
        for fault in self._faults.values():
            lines += ["", "[[faults]]", *(f"{k} = {_toml(v)}" for k, v in fault.items())]
        return "\n".join(lines) + "\n"


def _is_trial(trial: Trial) -> bool:
    return trial.read_from.path != trial.rig.read_from.path


def _of_rig(trial: Trial) -> str:
    lines = [f"rig = {_toml(trial.file.rig)}", f"stop = {_toml(trial.file.stop)}"]
    if trial.file.choices:
        chosen = ", ".join(f"{key} = {_toml(value)}" for key, value in trial.file.choices.items())
        lines.append(f"choices = {{ {chosen} }}")
    if trial.file.record.every is not None:
        lines += ["", "[record]", f"every = {_toml(trial.file.record.every)}"]
    return "\n".join(lines)


def _toml(value: Any) -> str:
    """Return a number, text, truth value or list of them as TOML."""
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value)
