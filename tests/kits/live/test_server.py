"""The page's server: loopback alone, nothing without its token, and no traceback for junk."""

from __future__ import annotations

import re
import socket
import time
from collections.abc import Iterator
from typing import Any

import msgspec
import pytest
import viser
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from seatrial.errors import InputError
from seatrial_kits.live.server import PageServer

PROTOCOL = [f"viser-v{viser.__version__}"]


@pytest.fixture
def server(capfd: pytest.CaptureFixture[str]) -> Iterator[PageServer]:
    """Yield a server; none says a word."""
    server = PageServer()
    yield server
    server.stop()
    assert capfd.readouterr() == ("", "")


def _sent(server: PageServer, path: bytes | str, *headers: str, host: str = "127.0.0.1") -> str:
    """Send a request as its bytes are, and return the answer's head."""
    line = path.encode() if isinstance(path, str) else path
    rest = "\r\n".join(("", f"Host: {host}:{server.get_port()}", *headers, "", ""))
    with socket.create_connection(("127.0.0.1", server.get_port()), timeout=30) as sock:
        sock.sendall(b"GET " + line + b" HTTP/1.1" + rest.encode())
        answer = b""
        while b"\r\n\r\n" not in answer and (data := sock.recv(65536)):
            answer += data
    return answer.partition(b"\r\n\r\n")[0].decode("latin-1")


def _status(server: PageServer, path: bytes | str, *headers: str, host: str = "127.0.0.1") -> int:
    return int(_sent(server, path, *headers, host=host).split()[1])


def _cookie(server: PageServer) -> str:
    return f"Cookie: other=1; seatrial-{server.get_port()}={server.token}"


def _opened(server: PageServer, **how: Any) -> Any:
    return connect(
        f"ws://127.0.0.1:{server.get_port()}/{server.token}", subprotocols=PROTOCOL, **how
    )


def test_the_token_leaves_the_address_with_the_first_load(server: PageServer) -> None:
    assert len(server.token) >= 20
    head = _sent(server, f"/{server.token}/")
    assert head.startswith("HTTP/1.1 303 ")
    assert "\r\nLocation: /\r\n" in head
    found = re.search(r"\r\nSet-Cookie: (\S+); (.*)\r\n", head)
    assert found is not None
    assert found[1] == f"seatrial-{server.get_port()}={server.token}"
    assert {"HttpOnly", "SameSite=Strict"} <= {*found[2].split("; ")}
    page = _sent(server, "/", f"Cookie: {found[1]}")
    assert page.startswith("HTTP/1.1 200 ")
    assert "Referrer-Policy: no-referrer" in page


def test_nothing_is_answered_without_it(server: PageServer) -> None:
    token = server.token
    wrong = ["/", "/index.html", f"/{token[:-1]}/", f"/{token}x/", f"/?{token}", f"//{token}/"]
    assert {path: _status(server, path) for path in wrong} == dict.fromkeys(wrong, 403)
    assert _status(server, "/", f"Cookie: seatrial-{server.get_port()}={token[:-1]}") == 403
    assert server.gate.refused == {"requests": len(wrong) + 1}


@pytest.mark.parametrize(
    "path",
    [
        "/é".encode(), "/é".encode("latin-1"), b"/%C3%A9", b"/%ff", b"/%00", b"/" + b"a" * 1000,
        b"/../../server.py", b"/%2e%2e/%2e%2e/server.py", b"/absent",
    ],
)  # fmt: skip
def test_what_is_not_there_is_404(server: PageServer, path: bytes) -> None:
    assert _status(server, path, _cookie(server)) == 404
    assert _status(server, path) in (403, 404)


def test_names_that_are_not_ascii_are_404_for_anybody(server: PageServer) -> None:
    for path in ("/é".encode(), b"/%C3%A9", b"/\xff"):
        assert _status(server, path) == 404


def test_another_host_s_name_for_this_machine_is_refused(server: PageServer) -> None:
    """DNS rebinding: a browser sends the name that somebody else's DNS gave 127.0.0.1."""
    for host in ("evil.example", "127.0.0.1.evil.example", "localhost.evil.example", "[::2]", ""):
        assert _status(server, "/", _cookie(server), host=host) == 403, host
        assert _status(server, f"/{server.token}/", host=host) == 403, host
    for host in ("localhost", "[::1]"):  # a port that is forwarded by SSH
        assert _status(server, "/", _cookie(server), host=host) == 200, host
    assert _status(server, "/", _cookie(server), "Host: 127.0.0.1") == 403  # two of them


def test_another_site_s_page_is_refused(server: PageServer) -> None:
    port = server.get_port()
    for origin in (
        "http://evil.example",
        "null",
        "http://127.0.0.1:1",
        f"https://127.0.0.1:{port}",
    ):
        assert _status(server, "/", _cookie(server), f"Origin: {origin}") == 403, origin
        with pytest.raises(InvalidStatus) as error:
            _opened(server, origin=origin)
        assert error.value.response.status_code == 403
    with _opened(server, origin=f"http://127.0.0.1:{port}") as opened:
        assert opened.recv(timeout=30)


def test_the_socket_needs_the_token_too(server: PageServer) -> None:
    place = f"ws://127.0.0.1:{server.get_port()}"
    for path in ("/", "", "/wrong"):
        with pytest.raises(InvalidStatus) as error:
            connect(f"{place}{path}", subprotocols=PROTOCOL)
        assert error.value.response.status_code == 403
    cookie = {"Cookie": _cookie(server).removeprefix("Cookie: ")}
    with connect(f"{place}/", subprotocols=PROTOCOL, additional_headers=cookie) as opened:
        assert opened.recv(timeout=30)


def _camera(**changes: Any) -> dict[str, Any]:
    return {
        "type": "ViewerCameraMessage", "wxyz": [1.0, 0.0, 0.0, 0.0], "position": [1, 2.0, 3.0],
        "fov": 1.0, "near": 0.1, "far": 1e3, "image_height": 400, "image_width": 600,
        "look_at": [0.0, 0.0, 0.0], "up_direction": [0.0, 0.0, 1.0], **changes,
    }  # fmt: skip


def _update(uuid: str, **updates: Any) -> dict[str, Any]:
    return {"type": "GuiUpdateMessage", "uuid": uuid, "updates": updates}


def test_junk_on_the_socket_is_counted_and_a_viewer_goes_on(server: PageServer) -> None:
    """Text, no MessagePack, messages of none of the page's kinds, values that no widget has."""
    gui, seen = server.gui, []
    slider = gui.add_slider("s", 0.0, 1.0, 0.1, 0.5)
    menu = gui.add_dropdown("m", ("a", "b"))
    number, switch = gui.add_number("n", 1), gui.add_checkbox("c", False)
    slider.on_update(lambda event: seen.append(slider.value))
    nan = float("nan")
    junk: list[Any] = [
        {}, [], None, 1, {"type": "x"}, {"type": []}, {"type": "GuiUpdateMessage"},
        {"type": "ShareUrlRequest"}, {"type": "FileTransferStartUpload"},
        _camera(fov=nan), _camera(wxyz=[1.0]), _camera(position=["a", 0, 0]), _camera(more=1),
        _update("u", label="x"), _update(slider._impl.uuid, value=nan), {**_update("u"), "uuid": []},
        _update(slider._impl.uuid, value=2.0), _update(slider._impl.uuid, value="x"),
        _update(slider._impl.uuid, update_cb=[1]), _update(menu._impl.uuid, value="absent"),
        _update(menu._impl.uuid, value=["a"]), _update(number._impl.uuid, value=float("inf")),
        _update(switch._impl.uuid, value="yes"), _update(slider._impl.uuid, value=True),
    ]  # fmt: skip
    raw = [msgspec.msgpack.encode(one) for one in junk]
    raw += [b"", b"\xff" * 9, b"\x91" * 50_000 + b"\xc0", b"\xc4\xff", b"\0" * 200_000]
    with _opened(server) as viewer:
        for one in (*raw, "text"):
            viewer.send(one)
        viewer.send(msgspec.msgpack.encode(_camera()))
        viewer.send(msgspec.msgpack.encode(_update(slider._impl.uuid, value=0.75)))
        until = time.monotonic() + 60
        while not seen and time.monotonic() < until:
            time.sleep(0.02)
    assert seen == [0.75]
    assert (menu.value, number.value, switch.value) == ("a", 1, False)
    assert server.gate.refused == {"messages": len(raw) + 1}


@pytest.mark.slow
def test_a_viewer_who_sends_only_junk_is_sent_away(server: PageServer) -> None:
    with _opened(server) as viewer, pytest.raises(ConnectionClosed) as error:
        for _ in range(150):
            viewer.send(b"junk")
        while True:
            viewer.recv(timeout=30)
    assert error.value.rcvd is not None
    assert error.value.rcvd.code == 1008
    with _opened(server) as other:
        assert other.recv(timeout=30)


def test_bytes_that_are_no_request_are_counted(server: PageServer) -> None:
    for junk in (b"junk\r\n\r\n", b"POST / HTTP/1.1\r\n\r\n", b"\r\n\r\n", b"GET / HTTP/9\r\n\r\n"):
        with socket.create_connection(("127.0.0.1", server.get_port()), timeout=30) as sock:
            sock.sendall(junk)
            while sock.recv(65536):
                pass
    until = time.monotonic() + 30.0  # the last one may be counted after it is closed
    while server.gate.refused["connections"] < 4 and time.monotonic() < until:
        time.sleep(0.01)
    assert server.gate.refused == {"connections": 4}


def test_frames_that_are_none_are_counted(server: PageServer) -> None:
    with _opened(server) as viewer:
        viewer.recv(timeout=30)
        viewer.socket.sendall(b"\xff\xff\xff\xff")
        with pytest.raises(ConnectionClosed):
            while True:
                viewer.recv(timeout=30)
    assert _status(server, "/", _cookie(server)) == 200


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
