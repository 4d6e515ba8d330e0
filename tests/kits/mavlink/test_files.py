"""Files and logs on board, as stations list, open and read them."""

import struct

import pytest
from pymavlink.dialects.v20 import all as mavlink
from pymavlink.mavftp import MAVFTP
from pymavlink.mavftp_op import FTP_OP

from .bench import OTHER_STATION, STATION, Bench

TERMINATE, RESET, LIST, OPEN, READ, WRITE, BURST = 1, 2, 3, 4, 5, 7, 15
ACK, NAK = 128, 129
INVALID_SESSION, END_OF_FILE, UNKNOWN_COMMAND, NOT_FOUND = 4, 6, 7, 10
HEADER = struct.Struct("<HBBBBBxI")


def ask(bench, opcode, data=b"", *, session=0, size=None, offset=0, sequence=65535):
    """Send a request; return (opcode, session, offset, burst complete, data) of each answer."""
    size = len(data) if size is None else size
    payload = FTP_OP(sequence, session, opcode, size, 0, 0, offset, data).pack().ljust(251, b"\0")
    bench.transport.take("FILE_TRANSFER_PROTOCOL")
    bench.receive(mavlink.MAVLink_file_transfer_protocol_message(0, 7, 1, list(payload)))
    found = []
    for number, m in enumerate(bench.transport.take("FILE_TRANSFER_PROTOCOL", STATION.link)):
        assert (m.target_system, m.target_component) == (STATION.system, STATION.component)
        raw = bytes(m.payload)
        sequence_, session_, answer, length, asked, last, at = HEADER.unpack_from(raw)
        assert sequence_ == (sequence + 1 + number) % 65536
        assert asked == opcode
        found.append((answer, session_, at, bool(last), raw[12 : 12 + length]))
    return found


def opened(bench, path, session=129):
    ((answer, given, _, _, size),) = ask(bench, OPEN, path, session=session)
    assert (answer, given) == (ACK, session)  # MAVProxy waits for its own number
    return session, struct.unpack("<I", size)[0]


def burst(bench, session):
    """Read a file by bursts, as ground stations do."""
    content = b""
    while True:
        answers = ask(bench, BURST, session=session, size=239, offset=len(content))
        if answers[0][0] == NAK:
            assert answers[0][4] == bytes([END_OF_FILE])
            return content
        assert [last for *_, last, _ in answers] == [*[False] * (len(answers) - 1), True]
        for _, _, at, _, data in answers:
            assert at == len(content)
            content += data


@pytest.mark.parametrize("submerged", [False, True])
def test_the_file_of_parameters_is_what_the_list_has(submerged):
    bench = Bench(submerged=submerged)
    session, size = opened(bench, b"@PARAM/param.pck")
    content = burst(bench, session)
    assert len(content) == size
    found = {name.decode(): value for name, value, _ in MAVFTP.ftp_param_decode(content).params}
    listed = {name: bench.parameters[name] for name in bench.parameters.names}
    assert found == pytest.approx(listed, rel=1e-6)


def test_defaults_are_given_where_they_differ():
    bench = Bench(waypoint_radius=2.0)
    assert bench.parameters.put("WP_RADIUS", 7.5) is None
    session, _ = opened(bench, b"@PARAM/param.pck?withdefaults=1")
    decoded = MAVFTP.ftp_param_decode(burst(bench, session))
    values = {name: value for name, value, _ in decoded.params}
    assert values[b"WP_RADIUS"] == 7.5
    assert {name: value for name, value, _ in decoded.defaults}[b"WP_RADIUS"] == 2.0


def test_folders_are_listed():
    bench = Bench()
    ((_, _, _, _, root),) = ask(bench, LIST, b"/")
    assert root == b"D@PARAM\0"
    ((_, _, _, _, inside),) = ask(bench, LIST, b"@PARAM")
    assert inside.startswith(b"Fparam.pck\t")
    assert ask(bench, LIST, b"@PARAM", offset=1) == [(NAK, 0, 1, False, bytes([END_OF_FILE]))]
    assert ask(bench, LIST, b"/nowhere") == [(NAK, 0, 0, False, bytes([NOT_FOUND]))]


def test_single_reads_and_the_end_of_a_session():
    bench = Bench()
    session, size = opened(bench, b"/@PARAM/param.pck")
    ((_, _, _, _, head),) = ask(bench, READ, session=session, size=6)
    assert struct.unpack("<HHH", head)[0] == 0x671B
    ((_, _, at, _, tail),) = ask(bench, READ, session=session, size=239, offset=size - 3)
    assert (at, len(tail)) == (size - 3, 3)
    assert ask(bench, TERMINATE, session=session)[0][0] == ACK
    refused = (NAK, session, 0, False, bytes([NOT_FOUND]))
    assert ask(bench, READ, session=session, size=6) == [refused]


def test_sessions_are_few_and_all_closed_by_a_reset():
    bench = Bench()
    for session in range(30):
        opened(bench, b"@PARAM/param.pck", session)
    is_open = [ask(bench, READ, session=n, size=6)[0][0] == ACK for n in range(30)]
    assert is_open == [False] * 22 + [True] * 8
    ask(bench, RESET)
    assert ask(bench, READ, session=29, size=6)[0][0] == NAK


@pytest.mark.parametrize("opcode", [6, WRITE, 8, 9, 14, 77])
def test_what_is_not_reading_is_refused(opcode):
    expected = [(NAK, 0, 0, False, bytes([UNKNOWN_COMMAND]))]
    assert ask(Bench(autopilot="px4"), opcode, b"@PARAM/param.pck") == expected


def test_a_file_that_there_is_not():
    assert ask(Bench(), OPEN, b"@SYS/x")[0][4] == bytes([NOT_FOUND])


# ---------------------------------------------------------------------- logs


@pytest.fixture
def logged(tmp_path):
    """A bench with a log of some 20 kB, which grows."""
    path = tmp_path / "boat.tlog"
    path.write_bytes(bytes(range(251)) * 80)
    return path, Bench(log=lambda: path)


def entry_of(bench):
    bench.transport.take()
    bench.receive(mavlink.MAVLink_log_request_list_message(7, 1, 0, 0xFFFF))
    (entry,) = bench.transport.take("LOG_ENTRY", STATION.link)
    return entry


def test_the_log_is_downloaded_as_it_was_when_it_was_listed(logged):
    path, bench = logged
    entry, before = entry_of(bench), path.read_bytes()
    assert (entry.id, entry.num_logs, entry.last_log_num) == (1, 1, 1)
    assert (entry.size, entry.time_utc) == (len(before), 10**9)
    path.write_bytes(before + b"more" * 1000)
    bench.receive(mavlink.MAVLink_log_request_data_message(7, 1, 1, 0, 0xFFFFFFFF))
    bench.wait(2.0)
    blocks = bench.transport.take("LOG_DATA", STATION.link)
    assert [m.ofs for m in blocks] == list(range(0, len(before) + 1, 90))
    assert b"".join(bytes(m.data[: m.count]) for m in blocks) == before
    assert blocks[-1].count < 90  # the last one


def test_what_was_lost_is_read_again(logged):
    path, bench = logged
    entry_of(bench)
    bench.receive(mavlink.MAVLink_log_request_data_message(7, 1, 1, 180, 270))
    bench.wait(1.0)
    blocks = bench.transport.take("LOG_DATA", STATION.link)
    assert b"".join(bytes(m.data[: m.count]) for m in blocks) == path.read_bytes()[180:450]


def test_a_download_is_stopped(logged):
    _, bench = logged
    bench.receive(mavlink.MAVLink_log_request_data_message(7, 1, 1, 0, 0xFFFFFFFF))
    bench.receive(mavlink.MAVLink_log_request_end_message(7, 1))
    bench.transport.take()
    bench.wait(0.1)
    assert not bench.transport.take("LOG_DATA")


def test_a_log_is_not_erased_and_others_are_not_there(logged):
    path, bench = logged
    bench.receive(mavlink.MAVLink_log_erase_message(7, 1))
    bench.receive(mavlink.MAVLink_log_request_data_message(7, 1, 5, 0, 90), OTHER_STATION)
    texts = bench.texts()
    assert "There is no log 5" in texts
    assert any("not erased" in text for text in texts)
    assert path.exists()


def test_without_a_log_the_list_is_empty():
    entry = entry_of(Bench())
    assert (entry.num_logs, entry.size) == (0, 0)
