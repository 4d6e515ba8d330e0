"""A sketch written by a test, on a board that the test steps."""

import os
from pathlib import Path

import pytest

from seatrial.links.text import decode, encode
from seatrial_kits.arduino.component import Arduino
from seatrial_kits.arduino.toolchain import missing

STEP = 0.02


def need(backend: str) -> None:
    """Skip without the tools; where they have to be (CI says so), fail."""
    if packages := missing(backend):
        text = f"not installed: {' '.join(packages)}"
        if os.environ.get("SEATRIAL_NEED_TOOLCHAIN") == "1":
            pytest.fail(text)
        pytest.skip(text)


def write_sketch(folder: Path, source: str, name: str = "one", **others: str) -> Path:
    """Write a sketch and its other files; return its folder."""
    place = folder / name
    place.mkdir(exist_ok=True)
    (place / f"{name}.ino").write_text(source, "utf-8")
    for other, text in others.items():
        file = place / other.replace("__", "/").replace("_dot_", ".")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, "utf-8")
    return place


class Bench:
    """A board at the start of its run."""

    def __init__(
        self,
        sketch: Path | str,
        backend: str = "host",
        board: type[Arduino] = Arduino,
        **values: object,
    ) -> None:
        need(backend)
        self.one = board("mega")
        for name, value in {"backend": backend, "sketch": str(sketch), **values}.items():
            self.one.set(name, value)
        self.one.initialise()
        self.one.begin()
        self.now = 0
        self.sent = [b""] * 4
        self.stamps: list[tuple[int, int, bytes]] = []
        self._seen = [0] * 4
        self._number = [0] * 4

    def __enter__(self) -> "Bench":
        return self

    def __exit__(self, *_: object) -> None:
        self.one.close()

    def receive(self, uart: int, data: bytes) -> None:
        """Let bytes arrive at a UART with the next step."""
        self._number[uart] += 1
        self.one.set(f"rx.uart{uart}", encode(self._number[uart], [(self.now, data)]))

    def run(self, seconds: float) -> bytes:
        """Run on; return what UART 0 sent meanwhile."""
        before = len(self.sent[0])
        for _ in range(round(seconds / STEP)):
            self.one.advance(self.now / 1e9, STEP)
            self.now += round(STEP * 1e9)
            for uart, text in enumerate(self.one.get("tx")):
                number, chunks = decode(text)
                if number != self._seen[uart]:
                    self._seen[uart] = number
                    self.sent[uart] += b"".join(data for _, data in chunks)
                    self.stamps += [(uart, when, data) for when, data in chunks]
        return self.sent[0][before:]
