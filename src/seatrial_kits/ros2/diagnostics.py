"""State of the link as diagnostic_msgs/DiagnosticArray, for rqt's robot monitor."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from .faults import NONE
from .ports import Ros2Ports
from .topics import Names

_OK, _WARN, _ERROR = 0, 1, 2
_SAID = {
    "holds": "holds until now",
    "broken": "broken",
    "open": "not met yet",
    "met": "met",
    "missed": "not met in time",
    "later": "evaluated at the end",
}
"""Words for how a criterion stands."""
_FAILED = ("broken", "missed")


def diagnostics(
    link: Ros2Ports, names: Names, now_ns: int, acting: Mapping[str, str], over: str
) -> Mapping[str, Any]:
    """Return what commands the vehicle ``over`` a transport, what was refused, faults, criteria."""
    vehicle = names.namespace.removeprefix("/")
    failed = {unit: fault for unit, fault in acting.items() if fault != NONE}
    counted = {
        "source": link.source,
        "refused": link.refused,
        "late": link.late,
        "transport": over,
    }
    spoilt = link.refused or link.late
    return {
        "header": {"stamp": now_ns},
        "status": [
            _status(
                f"{vehicle}: commands",
                "commands were refused or late" if spoilt else f"commanded by {link.source}",
                _WARN if spoilt else _OK,
                counted,
            ),
            _status(
                f"{vehicle}: faults",
                f"{len(failed)} injected" if failed else "none",
                _WARN if failed else _OK,
                failed,
            ),
            *_criteria(json.loads(link.verdicts or "{}")),
        ],
    }


def _criteria(verdicts: Mapping[str, str]) -> list[Mapping[str, Any]]:
    return [
        _status(f"trial: {name}", _SAID[state], _ERROR if state in _FAILED else _OK, {})
        for name, state in verdicts.items()
    ]


def _status(name: str, said: str, level: int, values: Mapping[str, Any]) -> Mapping[str, Any]:
    pairs = [{"key": key, "value": str(value)} for key, value in values.items()]
    return {
        "name": name,
        "message": said,
        "level": level,
        "hardware_id": "seatrial",
        "values": pairs,
    }
