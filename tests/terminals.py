"""Connections of a shipped rig, and those that joining its components' terminals gives."""

import tomllib
from pathlib import Path

from seatrial.fmi.index import component_class

RIGS = Path(__file__).parents[1] / "harness" / "rigs"


class Terminals:
    """A rig's connections among components of some layers, as (output, input) by scalar."""

    def __init__(self, rig: str, layers=("control", "links")):
        self.content = tomllib.loads((RIGS / f"{rig}.toml").read_text())
        self.layers = tuple(f"seatrial.{layer}." for layer in layers)
        written = self.content["components"]
        self.classes = {name: component_class(entry["fmu"]) for name, entry in written.items()}

    def connected(self):
        """Return what the rig's file connects, but for tunables."""
        pairs = set()
        for output, written in self.content["connections"].items():
            for entry in written if isinstance(written, list) else [written]:
                end = entry["to"] if isinstance(entry, dict) else entry
                if all(self._among(name.split(".")[0]) for name in (output, end)):
                    pairs |= self._pairs(output, end)
        return {pair for pair in pairs if ".tunable." not in pair[0]}

    def joined(self, text: str):
        """Return what joining terminals gives: "a.orders b.orders; ..." in pairs."""
        pairs = set()
        for entry in text.split(";"):
            found = self._joined(*entry.split())
            assert found, f"{entry}: nothing joins"
            pairs |= found
        return pairs

    def _joined(self, left, right):
        ours, theirs = self._members(left), self._members(right)
        pairs = set()
        for member in ours.keys() & theirs.keys():
            ends = sorted((ours[member], theirs[member]), key=lambda end: end[0] != "output")
            if [kind for kind, _ in ends] == ["output", "input"]:
                pairs |= self._pairs(ends[0][1], ends[1][1])
        return pairs

    def _members(self, name):
        component, terminal = name.split(".")
        cls = self.classes[component]
        ports = cls.terminals[terminal].members
        return {member: (_port(cls, p).kind, f"{component}.{p}") for member, p in ports.items()}

    def _pairs(self, output, end):
        return set(zip(self._scalars(output), self._scalars(end), strict=True))

    def _scalars(self, name):
        component, port = name.split(".", 1)
        cls = self.classes[component]
        names = cls.ports[port].scalar_names if port in cls.ports else [port]
        return [f"{component}.{scalar}" for scalar in names]

    def _among(self, component):
        return self.classes[component].__module__.startswith(self.layers)


def _port(cls, name):
    return cls.ports[name] if name in cls.ports else cls.scalar_by_name[name].port
