"""NMEA 0183 over sockets and lines, with a peer of pynmea2, sockets and pyserial."""

import contextlib
import socket
import sys
import time
from collections.abc import Callable, Iterator

import pynmea2
import pytest
import serial

from seatrial.errors import InputError

from .bench import DEG, VALID, Bench

WAIT_S = 60.0


def until(bench: Bench, done: Callable[[], bool]) -> None:
    """Run on until something is so; its peers live on the wall clock."""
    deadline = time.monotonic() + WAIT_S
    while not done():
        assert time.monotonic() < deadline
        bench.run(0.05)
        time.sleep(0.001)


@contextlib.contextmanager
def talking(links: str, **values: object) -> Iterator[Bench]:
    with Bench(links=links, sentences="GPRMC 0.1; HEHDT 0.1", **values) as bench:
        bench.set(**VALID)
        yield bench


def commanded(bench: Bench) -> bool:
    return bench.one.get("target_valid") and bench.one.get("target_heading") == pytest.approx(
        90.0 * DEG
    )


COMMAND = f"{pynmea2.HSC('II', 'HSC', ('90.0', 'T', '', 'M'))}\r\n".encode()


def test_datagrams_are_sentences():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        peer.bind(("127.0.0.1", 0))
        peer.settimeout(WAIT_S)
        with talking(f"udpout:127.0.0.1:{peer.getsockname()[1]}") as bench:
            bench.run(0.05)
            data, address = peer.recvfrom(2000)
            assert pynmea2.parse(data.decode()).is_valid
            assert pynmea2.parse(peer.recv(2000).decode()).heading == 350
            peer.sendto(COMMAND.rstrip(), address)  # without an end of line, as some do
            until(bench, lambda: commanded(bench))


def test_clients_of_a_server_receive_and_are_received():
    with talking("tcpin:127.0.0.1:0") as bench:
        where = bench.one.get("reached_at").removeprefix("tcp:").split(":")
        peers = [socket.create_connection((where[0], int(where[1])), WAIT_S) for _ in range(2)]
        try:
            files = [peer.makefile("rb") for peer in peers]
            until(bench, lambda: len(bench.one._endpoints[0].channels()) == 2)
            bench.run(0.1)
            for file in files:
                assert pynmea2.parse(file.readline().decode(), check=True).sentence_type == "RMC"
                file.close()
            for byte in COMMAND:  # a byte at a time; the other client's do not get in between
                peers[0].sendall(bytes([byte]))
                peers[1].sendall(b"$GPX")
            until(bench, lambda: commanded(bench))
        finally:
            for peer in peers:
                peer.close()


def test_a_client_connects():
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(WAIT_S)
        with talking(f"tcpout:127.0.0.1:{server.getsockname()[1]}") as bench:
            bench.run(0.05)
            peer, _ = server.accept()
            with peer, peer.makefile("rb") as file:
                until(bench, lambda: len(bench.one._endpoints[0].channels()) == 1)
                bench.run(0.1)
                assert pynmea2.parse(file.readline().decode(), check=True).sentence_type == "RMC"
                peer.sendall(COMMAND)
                until(bench, lambda: commanded(bench))


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals")
def test_a_serial_line(tmp_path):
    with (
        talking(f"pty:{tmp_path / 'nmea'}") as bench,
        serial.Serial(str(tmp_path / "nmea"), 4800, timeout=WAIT_S) as port,
    ):
        bench.run(0.1)
        while b"RMC" not in (line := port.readline()):
            assert line
        assert pynmea2.parse(line.decode(), check=True).is_valid
        port.write(COMMAND)
        until(bench, lambda: commanded(bench))


def test_two_components_by_their_ports():
    """A plotter's commands are text to a board or a simulated topside as they are to a socket."""
    boat = Bench(sentences="GPRMC 1")
    plotter = Bench(sentences="HEHDT 0.5")
    plotter.set(**VALID)
    for _ in range(40):
        boat.one.set("rx", plotter.one.get("tx"))
        plotter.run(0.05)
        boat.run(0.05)
    assert boat.one.get("sentences_received") == 4
    assert boat.one.get("lines_refused") == 0


def test_a_port_that_is_taken_is_reported():
    with socket.create_server(("127.0.0.1", 0)) as server:
        url = f"tcpin:127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(InputError, match=r"nmea: links: cannot open the link"):
            Bench(links=url)
