"""The example that ends the help of each command; kits have theirs in their manifests."""

from __future__ import annotations

from ..kits import kits

_CORE = {
    "compare": "seatrial compare runs/landing runs/quick",
    "convergence": "seatrial convergence hydrone-open-landing",
    "describe": "seatrial describe sil --vehicle otter --autopilot mavlink",
    "docs": "seatrial docs otter",
    "doctor": "seatrial doctor",
    "fmu": "seatrial fmu build marine-craft --parameters hydrone",
    "fmu build": "seatrial fmu build marine-craft --parameters hydrone -o fmus",
    "fmu check": "seatrial fmu check marine-craft.fmu",
    "fmu describe": "seatrial fmu describe imu",
    "fmu list": "seatrial fmu list",
    "fmu survey": "seatrial fmu survey folder-of-fmus",
    "list": "seatrial list otter",
    "log": "seatrial log boat.tlog",
    "move-vehicle": "seatrial move-vehicle my-boat",
    "new": "seatrial new vehicle my-boat",
    "new ardupilot": "seatrial new ardupilot my-boat",
    "new ros2-package": "seatrial new ros2-package my_boat",
    "new sketch-of": "seatrial new sketch-of my-boat",
    "new trials": "seatrial new trials my-boat",
    "new vehicle": "seatrial new vehicle my-boat --like auv",
    "profile": "seatrial profile describe gloria",
    "profile check": "seatrial profile check gloria",
    "profile describe": "seatrial profile describe gloria",
    "report": "seatrial report runs/landing",
    "run": "seatrial run hydrone-landing --set drone.pad=transversal -o runs/landing",
}


def examples() -> dict[str, str]:
    """Return an example by command, its group first."""
    of_kits = {name: text for kit in kits().found for name, text in kit.examples.items()}
    return {**_CORE, **of_kits}
