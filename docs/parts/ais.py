"""AIS: ports of the transponder and of the VHF channel."""

from __future__ import annotations

from functools import partial

from parts import part
from parts.can import ports
from seatrial_kits.nmea.ais.transponder import AisTransponder
from seatrial_kits.nmea.ais.vhf_channel import VhfChannel

part("ais-transponder-ports")(partial(ports, AisTransponder))
part("vhf-channel-ports")(partial(ports, VhfChannel))
