"""Identity of a node: its 64-bit NAME (ISO 11783-5) and its product."""

from __future__ import annotations

from dataclasses import dataclass

from .codec import Encoder, Fields, Message

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
