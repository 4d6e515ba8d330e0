"""The page's server: loopback alone, and nothing without its token."""

from __future__ import annotations

import http.client
import socket
from collections.abc import Iterator

import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from seatrial.errors import InputError
from seatrial.live.server import PageServer


@pytest.fixture(scope="module")
def server() -> Iterator[PageServer]:
    server = PageServer()
    yield server
    server.stop()


def _status(server: PageServer, path: str) -> int:
    connection = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=10)
    connection.request("GET", path)
    try:
        return connection.getresponse().status
    finally:
        connection.close()


def test_the_page_needs_its_token(server: PageServer) -> None:
    token = server.token
    assert len(token) >= 20
    assert _status(server, f"/{token}/") == 200
    wrong = ["/", "/index.html", f"/{token[:-1]}/", f"/{token}x/", f"/?{token}", f"//{token}/"]
    assert {path: _status(server, path) for path in wrong} == dict.fromkeys(wrong, 403)
    assert _status(server, f"/{token}/../../server.py") == 404


def test_the_socket_needs_it_too(server: PageServer) -> None:
    protocol = [f"viser-v{viser.__version__}"]
    place = f"ws://127.0.0.1:{server.get_port()}"
    for path in ("/", "", "/wrong"):
        with pytest.raises(InvalidStatus) as error:
            connect(f"{place}{path}", subprotocols=protocol, origin="http://evil.example")
        assert error.value.response.status_code == 403
    with connect(f"{place}/{server.token}", subprotocols=protocol) as opened:
        assert opened.recv(timeout=10)


def test_it_listens_on_loopback_alone(server: PageServer) -> None:
    port = f"{server.get_port():04X}"
    listening = set()
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        with open(table) as rows:
            for row in list(rows)[1:]:
                _, local, _, state, *_ = row.split()
                address, _, at = local.partition(":")
                if at == port and state == "0A":
                    listening.add(address)
    assert listening == {"0100007F"}


def test_nobody_gets_a_way_in_from_outside(server: PageServer) -> None:
    assert server.request_share_url() is None
    assert server._share_tunnel is None


def test_a_port_that_is_taken() -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        with pytest.raises(InputError, match=f"port {other.getsockname()[1]}"):
            PageServer(other.getsockname()[1])


def test_viser_says_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    PageServer().stop()
    assert capfd.readouterr() == ("", "")
