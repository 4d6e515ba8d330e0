"""Address claiming of ISO 11783-5, as NMEA 2000 has it: one node's side of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .codec import Encoder, Fields, Message

HIGHEST = 251
"""Addresses are 0 to 251; 252 and 253 are reserved, 254 is null, 255 global."""
WAIT_NS = 250_000_000
"""For so long a claim must stand before the address is used."""
LONGEST_DELAY_NS = 153_000_000
"""Longest random delay before a claim at power-up, and before 'cannot claim'."""
_FAR_NS = 1 << 62


class AddressClaim:
    """State machine with simulated time; ``memory`` is a dict of plain data, the caller's.

    After `start` it waits for a random time, up to 153 ms, since nodes that are switched on
    together must not send the same identifier at once, and claims ``preferred``. Once a claim has
    stood for 250 ms the address may be used (`address`).

    Another node's claim of the same address: the lower NAME keeps it. If that is ours, the claim
    is repeated. If not, a node that is ``arbitrary`` claims the next address, upwards and round,
    that no message came from, and is without one for another 250 ms. One that is not, or finds
    none free, sends 'cannot claim' after a random delay (a claim from 254), and stays silent.

    A request for claims is answered with the claim, or 'cannot claim' after a delay. A claim with
    our own NAME is not contested, and counted in ``twins``: two nodes have one identity.

    ``delay(k)`` is the k-th random number, from 0 to 1. `take` returns what is to be sent:
    (time in ns, source) of each claim. Not here: commanded addresses (PGN 65240).
    """

    def __init__(
        self,
        memory: dict[str, Any],
        name: int,
        preferred: int,
        arbitrary: bool,
        delay: Callable[[int], float],
    ) -> None:
        self._memory = memory
        self._name, self._preferred, self._arbitrary = name, preferred, arbitrary
        self._delay = delay
        memory.setdefault("state", "off")
        memory.setdefault("held", preferred)
        memory.setdefault("due", None)
        memory.setdefault("draws", 0)
        memory.setdefault("taken", [])
        memory.setdefault("claims", [])
        memory.setdefault("contests", 0)
        memory.setdefault("twins", 0)
        memory.setdefault("since", 0)

    @property
    def state(self) -> str:
        """``off``, ``delay``, ``claiming``, ``claimed``, ``refusing`` (delay), ``without``."""
        return str(self._memory["state"])

    @property
    def address(self) -> int | None:
        """The address that may be used, if there is one."""
        return self._memory["held"] if self.state == "claimed" else None

    @property
    def since_ns(self) -> int:
        """Since when the address may be used."""
        return int(self._memory["since"])

    @property
    def changes_ns(self) -> int:
        """Time of its next own action, far ahead if there is none."""
        due: int | None = self._memory["due"]
        return _FAR_NS if due is None else due

    @property
    def contests(self) -> int:
        """Claims of other nodes of an address of ours."""
        return int(self._memory["contests"])

    @property
    def twins(self) -> int:
        """Claims of other nodes with our own NAME."""
        return int(self._memory["twins"])

    def start(self, now_ns: int) -> None:
        """Begin, as at power-up."""
        self._wait("delay", now_ns + self._random_ns())

    def receive_claim(self, now_ns: int, source: int, name: int) -> None:
        """Take in another node's claim of ``source`` (254: it cannot claim)."""
        if name == self._name:
            self._memory["twins"] += 1
            return
        self.receive_source(source)
        if source != self._memory["held"] or self.state in ("off", "refusing", "without"):
            return
        if self.state == "delay":  # not sent yet, so no other node can be made to move
            if name < self._name:
                self._choose()
            return
        self._memory["contests"] += 1
        if self._name < name:
            self._claim(now_ns)
            return
        if self._choose():
            self._claim(now_ns)
            self._wait("claiming", now_ns + WAIT_NS)
        else:
            self._wait("refusing", now_ns + self._random_ns())

    def receive_source(self, source: int) -> None:
        """Take in that a node sends from an address."""
        if source <= HIGHEST and source not in self._memory["taken"]:
            self._memory["taken"].append(source)

    def receive_request(self, now_ns: int) -> None:
        """Take in a request for claims."""
        if self.state in ("claiming", "claimed"):
            self._claim(now_ns)
        elif self.state == "without":
            self._wait("refusing", now_ns + self._random_ns())

    def tick(self, until_ns: int) -> None:
        """Do what is due before ``until_ns``."""
        while self._memory["due"] is not None and self._memory["due"] < until_ns:
            due, self._memory["due"] = self._memory["due"], None
            if self.state == "delay":
                self._begin(due)
            elif self.state == "claiming":
                self._memory["state"], self._memory["since"] = "claimed", due
            elif self.state == "refusing":
                self._memory["claims"].append([due, 254])
                self._memory["state"] = "without"

    def take(self) -> list[tuple[int, int]]:
        """Return, once, (time in ns, source) of the claims to send."""
        found = [(when, source) for when, source in self._memory["claims"]]
        self._memory["claims"] = []
        return found

    # ------------------------------------------------------------------ inside

    def _begin(self, now_ns: int) -> None:
        if self._memory["held"] is None:
            self._wait("refusing", now_ns + self._random_ns())
            return
        self._claim(now_ns)
        self._wait("claiming", now_ns + WAIT_NS)

    def _choose(self) -> bool:
        """Hold the next free address; return whether there is one."""
        held, taken = self._memory["held"], self._memory["taken"]
        self._memory["held"] = None
        if self._arbitrary and held is not None:
            for step in range(1, HIGHEST + 1):
                other = (held + step) % (HIGHEST + 1)
                if other not in taken:
                    self._memory["held"] = other
                    break
        return self._memory["held"] is not None

    def _claim(self, now_ns: int) -> None:
        self._memory["claims"].append([now_ns, self._memory["held"]])

    def _wait(self, state: str, until_ns: int) -> None:
        self._memory["state"], self._memory["due"] = state, until_ns

    def _random_ns(self) -> int:
        self._memory["draws"] += 1
        return round(self._delay(self._memory["draws"] - 1) * LONGEST_DELAY_NS)


UNIQUE_NUMBERS = 1 << 21
"""The NAME has 21 bits for a unique number."""
_MARINE = 4
"""Industry group of NMEA 2000."""
_VERSION = 2.1
"""Of NMEA 2000, as product information has it."""
_LONGEST_TEXT = 32


@dataclass(frozen=True)
class Identity:
    """NAME and product of a node. ``uid`` gives the unique number: its remainder of 2^21."""

    uid: int
    manufacturer_code: int
    device_function: int
    device_class: int
    device_instance: int
    system_instance: int
    arbitrary_address: bool
    product_code: int
    model: str
    software_version: str
    model_version: str
    load_equivalency: int
    description: str

    def claim(self) -> Fields:
        """Fields of the address claim, 60928."""
        return {
            "uniqueNumber": self.uid % UNIQUE_NUMBERS,
            "manufacturerCode": self.manufacturer_code,
            "deviceInstanceLower": self.device_instance % 8,
            "deviceInstanceUpper": self.device_instance // 8,
            "deviceFunction": self.device_function,
            "spare": 0,
            "deviceClass": self.device_class,
            "systemInstance": self.system_instance,
            "industryGroup": _MARINE,
            "arbitraryAddressCapable": int(self.arbitrary_address),
        }

    def name(self) -> int:
        """Return the NAME: the claim's eight bytes, the lowest first. The lower wins."""
        return name_of(self.claim())

    def product(self) -> Fields:
        """Fields of the product information, 126996; texts are cut at 32 characters."""
        return {
            "nmea2000Version": _VERSION,
            "productCode": self.product_code,
            "modelId": self.model[:_LONGEST_TEXT],
            "softwareVersionCode": self.software_version[:_LONGEST_TEXT],
            "modelVersion": self.model_version[:_LONGEST_TEXT],
            "modelSerialCode": str(self.uid)[:_LONGEST_TEXT],
            "certificationLevel": 0,
            "loadEquivalency": self.load_equivalency,
        }

    def configuration(self) -> Fields:
        """Fields of the configuration information, 126998."""
        return {
            "installationDescription1": self.description,
            "installationDescription2": "",
            "manufacturerInformation": "simulated",
        }


def name_of(claim: Fields) -> int:
    """Return the NAME that a claim's fields are."""
    (frame,) = Encoder({}).encode(Message(60928, claim))
    return int.from_bytes(frame.data, "little")
