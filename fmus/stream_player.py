"""stream-player: plays a recorded serial stream."""

from seatrial.fmi.slave import Slave
from seatrial.links.videoray.player import StreamPlayer


class StreamPlayerFmu(Slave):
    """FMU of `StreamPlayer`."""

    component_class = StreamPlayer

    def __init__(self, **kwargs):  # pythonfmu needs a method defined in this very file
        super().__init__(**kwargs)
