"""Recordings of CAN buses: candump's text, logs of python-can, gateways' and canboat's text."""

from __future__ import annotations

import base64
import binascii
import io
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

from seatrial.errors import InputError
from seatrial.trial.logs.reading_progress import open_text
from seatrial.trial.records.run_folder import ends_with_newline

from .frame import FD_LENGTHS, Frame

VECTOR = b"LOGG"
_BINARY = (".blf", ".asc", ".trc", ".mf4")
"""Files that python-can reads, by their names; .blf by its content, too."""
_ERROR_FRAME = 0x20000000
_BYTE_ORDER_MARK = "\xef\xbb\xbf"
"""At the beginning of a text in UTF-8 that Windows has written, as Latin-1."""
_LOOKED_AT = 40
"""Lines at the beginning of a text, of which one has to be a frame."""
_HEAD = 8192
"""Bytes at the beginning of a file that say of which tool it is."""
_GLOBAL = 255
_FAST_PROPRIETARY = range(0x1FF00, 0x20000)
_BROADCAST = 0xF0
"""PDU format from which on an identifier has no destination (ISO 11783-3)."""


_ALL_WHOLE = ("# format=FAST", "Sequence #", "!PDGY", "$PCDIN", "A0", "A1", "A2")
"""Beginnings of lines of texts in which every line is a whole message."""


class Recorded(NamedTuple):
    """A frame of a recording: number of its line or entry, time, s, or None, bus, and frame."""

    row: int
    time: float | None
    bus: str
    frame: Frame


class _Parsed(NamedTuple):
    """A line: time, bus, identifier or header of a message, and data."""

    time: float | None
    bus: str
    identifier: int
    data: bytes
    extended: bool = True
    remote: int | None = None
    """Bytes that a remote frame requests."""
    fd: int | None = None
    """Flags of a frame of CAN FD: 1 bit rate switch, 2 error state."""
    is_message: bool = False
    """Whether it is a whole message, that may be longer than a frame."""


_CANDUMP = re.compile(
    r"\s*(?:\((?P<time>[\d.:\- ]+)\)\s+)?(?P<bus>[A-Za-z]\w*)\s+(?:[TR]X?\s+(?:[-BE]\s+)*)?"
    r"(?P<id>[0-9A-Fa-f]{3}(?:[0-9A-Fa-f]{5})?)"
    r"(?:#(?P<remote>R\d?)|##(?P<flags>[0-9A-Fa-f])(?P<fd>(?:[0-9A-Fa-f]{2})*)"
    r"|#(?P<data>(?:[0-9A-Fa-f]{2}\.?){0,8})|\s+\[\d+\]\s*(?P<spaced>(?:[0-9A-Fa-f]{2}(?:\s+|$)){0,64})"
    r"(?P<request>remote request)?)"
)
_ANGSTROM = re.compile(
    r"\s*<0x(?P<id>[0-9A-Fa-f]{1,8})>\s+\[(?P<size>\d)\](?P<data>(?:\s+[0-9A-Fa-f]{2}){0,8})\s*$"
)
_YACHT_DEVICES = re.compile(
    r"\s*(?P<time>\d\d:\d\d:\d\d\.\d+)\s+(?P<way>[RT])\s+(?P<id>[0-9A-Fa-f]{8})"
    r"(?P<data>(?:\s+[0-9A-Fa-f]{2}){0,8})\s*$"
)
_CANBOAT = re.compile(
    r"\s*(?P<time>[\dTZ:.\-+ ]+),(?P<priority>\d),(?P<pgn>\d+),(?P<source>\d+),(?P<to>\d+),"
    r"(?P<size>\d+)(?P<data>(?:,[0-9A-Fa-f]{2})+),?\s*$"
)
_ANALYZER = re.compile(
    r"(?P<time>\d{4}-[\dTZ:.\-+]+) +(?P<priority>\d) +(?P<source>\d+) +(?P<to>\d+) +(?P<pgn>\d+) :"
    r"(?P<data>(?: [0-9A-Fa-f]{2})+)\s*$"
)
_ACTISENSE = re.compile(
    r"\s*A(?P<time>\d{6}\.\d+)\s+(?P<source>[0-9A-Fa-f]{2})(?P<to>[0-9A-Fa-f]{2})"
    r"(?P<priority>[0-9A-Fa-f])\s+(?P<pgn>[0-9A-Fa-f]{4,5})\s+(?P<data>(?:[0-9A-Fa-f]{2})+)\s*$"
)
_IKONVERT = re.compile(
    r"!PDGY,(?P<pgn>\d{5,6}),(?P<priority>\d),(?P<source>\d+),(?P<to>\d+),(?P<time>[\d.]+),"
    r"(?P<data>[A-Za-z0-9+/=]+)"
)
_PCDIN = re.compile(
    r"\$PCDIN,(?P<pgn>[0-9A-Fa-f]{5,6}),(?P<time>[0-9A-Fa-f]{8}),(?P<source>[0-9A-Fa-f]{2}),"
    r"(?P<data>(?:[0-9A-Fa-f]{2})+)(?:\*[0-9A-Fa-f]{2})?"
)
_GARMIN = re.compile(
    r"\d+,(?:\d+(?:_\d+){5}_)?(?P<ticks>\d+),(?P<pgn>\d+),.*?,(?P<source>\d+),(?P<to>\d+),"
    r"(?P<priority>\d),[01],(?P<size>\d+),0x(?P<data>(?:[0-9A-Fa-f]{2})+)\s*$"
)


def is_recording(path: Path, head: bytes) -> bool:
    """Return whether a file is one of `recorded_frames`, by its first bytes and its name."""
    if head.startswith(VECTOR) or _is_of_python_can(path):
        return not path.is_dir()
    return _has_frame(head)


def _has_frame(head: bytes) -> bool:
    text = head.decode("latin-1").removeprefix(_BYTE_ORDER_MARK)
    lines = text.splitlines()[:_LOOKED_AT]
    return any(_parsed(line) is not None for line in lines)


def recorded_frames(
    path: Path, skipped: Counter[str], is_fast: Callable[[int], bool] | None = None
) -> Iterator[Recorded]:
    """Yield the frames of a recording, in the order of the file.

    Read are ``candump`` and ``candump -L``, -ta, -tz, with frames of CAN FD and remote ones; .blf,
    .asc, .trc and .mf4 by python-can; and, of NMEA 2000 networks, the text of Yacht Devices'
    gateways, canboat's, Actisense's N2K ASCII, $PCDIN, Digital Yacht's !PDGY and Garmin's CSV.
    Messages that are longer than a frame become fast packets again, with those that are shorter
    but of a PGN that goes as fast packets: those that ``is_fast`` says, of which one in the file is
    longer, and proprietary ones. Times are as the file has them, s; past midnight they go on.

    Lines that are no frame, and error frames, are counted in ``skipped``. Raises InputError for a
    file that cannot be read.
    """
    with path.open("rb") as file:
        is_vector = file.read(len(VECTOR)) == VECTOR
    if is_vector or _is_of_python_can(path):
        yield from _by_python_can(path, skipped, is_vector=is_vector)
    else:
        yield from _of_text(path, skipped, is_fast or (lambda _: False))


def _is_of_python_can(path: Path) -> bool:
    """Return whether a file is called like one of python-can's, and is no text of other tools."""
    if path.suffix.lower() not in _BINARY or path.is_dir():
        return False
    with path.open("rb") as file:
        return not _has_frame(file.read(_HEAD))


def _by_python_can(path: Path, skipped: Counter[str], *, is_vector: bool) -> Iterator[Recorded]:
    import can

    from .messages import frame_of

    try:
        reader = can.BLFReader(str(path)) if is_vector else _text_reader(path, skipped)
        if is_vector and path.stat().st_size < _said_size(path):
            skipped["part of the file is cut off at its end"] += 1
        with reader:
            for row, entry in enumerate(reader, 1):
                # python-can takes a frame of CAN FD without data in .asc for a remote one.
                entry.is_remote_frame = entry.is_remote_frame and not entry.is_fd
                frame = frame_of(entry)
                if frame is None:
                    skipped["error frames are skipped"] += 1
                else:
                    bus = "" if entry.channel is None else str(entry.channel)
                    yield Recorded(row, float(entry.timestamp), bus, frame)
    except Exception as error:  # whatever python-can makes of bytes that are no log
        raise InputError(f"{path}: no log that python-can reads: {error}") from None


def _text_reader(path: Path, skipped: Counter[str]) -> Any:
    """Return python-can's reader of a file; of a text, without a last line that is cut."""
    import can

    texts = {".asc": can.ASCReader, ".trc": can.TRCReader}
    reader = texts.get(path.suffix.lower())
    if reader is None or ends_with_newline(path):
        return can.LogReader(str(path))
    text = path.read_text("utf-8", errors="ignore")
    skipped["line is cut at the end of the file"] += 1
    return reader(io.StringIO(text[: text.rfind("\n") + 1]))


def _said_size(path: Path) -> int:
    """Return the size, bytes, that the header of a .blf says; 0 of one that was not closed."""
    with path.open("rb") as file:
        return int.from_bytes(file.read(24)[16:], "little")


def _of_text(
    path: Path, skipped: Counter[str], is_fast: Callable[[int], bool]
) -> Iterator[Recorded]:
    whole = _whole_messages(path)
    sequences: dict[int, int] = defaultdict(int)
    day, before = 0.0, None
    with open_text(path, "latin-1") as file:
        for row, line in enumerate(file, 1):
            line = line.removeprefix(_BYTE_ORDER_MARK) if row == 1 else line
            if not line.strip() or line.lstrip().startswith(("#", "//")):
                continue
            found = _parsed(line)
            if found is None:
                skipped["lines that are no frame are skipped"] += 1
                continue
            if found.identifier & _ERROR_FRAME:
                skipped["error frames are skipped"] += 1
                continue
            time = found.time
            if time is not None and before is not None and time < before - 43200.0 and time < 86400:
                day += 86400.0
            before = time
            moment = None if time is None else time + day
            try:
                frames = _frames(found, whole, is_fast, sequences)
            except InputError:
                skipped["frames that there cannot be are skipped"] += 1
                continue
            for frame in frames:
                yield Recorded(row, moment, found.bus, frame)


def _whole_messages(path: Path) -> frozenset[int] | None:
    """Return the PGNs of a text that are longer than a frame in it; None if it has frames alone."""
    found, is_whole = set(), False
    with path.open(encoding="latin-1") as file:
        for line in file:
            is_whole |= line.startswith(_ALL_WHOLE)
            parsed = _parsed(line) if "," in line or line[:1] in "A12" else None
            if parsed is not None and parsed.is_message and len(parsed.data) > 8:
                found.add(pgn_of(parsed.identifier))
    return frozenset(found) if found or is_whole else None


def _frames(
    found: _Parsed,
    whole: frozenset[int] | None,
    is_fast: Callable[[int], bool],
    sequences: dict[int, int],
) -> list[Frame]:
    if found.remote is not None:
        return [Frame(found.identifier, b"", found.extended, remote=True, requested=found.remote)]
    if found.fd is not None:
        size = next((size for size in FD_LENGTHS if size >= len(found.data)), len(found.data))
        data, switch, error = found.data.ljust(size, b"\0"), bool(found.fd & 1), bool(found.fd & 2)
        return [Frame(found.identifier, data, found.extended, fd=True, bit_rate_switch=switch,
                      error_state=error)]  # fmt: skip
    pgn = pgn_of(found.identifier)
    fast = whole is not None and (pgn in whole or pgn in _FAST_PROPRIETARY or is_fast(pgn))
    if not (found.is_message and fast) and len(found.data) <= 8:
        return [Frame(found.identifier, found.data, found.extended)]
    return _fast_packet(found, sequences)


def _fast_packet(found: _Parsed, sequences: dict[int, int]) -> list[Frame]:
    """Return the frames of a message: 6 bytes in the first, 7 in each other (NMEA 2000, 3.3)."""
    if len(found.data) > 223:
        raise InputError(f"{len(found.data)} bytes, a fast packet has up to 223")
    sequence = sequences[found.identifier]
    sequences[found.identifier] = (sequence + 1) % 8
    content = bytes([len(found.data)]) + found.data
    parts = [content[place : place + 7] for place in range(0, len(content), 7)]
    return [
        Frame(found.identifier, (bytes([sequence << 5 | n]) + part).ljust(8, b"\xff"), True)
        for n, part in enumerate(parts)
    ]


def pgn_of(identifier: int) -> int:
    """Return the parameter group number of an identifier of 29 bits (ISO 11783-3)."""
    pgn = identifier >> 8 & 0x3FFFF
    return pgn if pgn >> 8 & 0xFF >= _BROADCAST else pgn & 0x3FF00


def _identifier(found: Mapping[str, str], base: int = 10) -> int:
    pgn, source = int(found["pgn"], base), int(found["source"], base)
    to = int(found.get("to") or str(_GLOBAL), base) if "to" in found else _GLOBAL
    low = pgn & 0xFF if pgn >> 8 & 0xFF >= _BROADCAST else to
    priority = int(found.get("priority") or "6")
    return (priority & 7) << 26 | (pgn & 0x3FF00) << 8 | low << 8 | source


def _parsed(line: str) -> _Parsed | None:
    """Return what a line of a text is, None for one that is no frame."""
    for pattern, read in _LINES:
        match = pattern.match(line)
        if match is not None:
            try:
                return read(match)
            except (ValueError, binascii.Error):
                return None
    return None


def _candump(match: re.Match[str]) -> _Parsed | None:
    identifier = int(match["id"], 16)
    extended = len(match["id"]) == 8
    time = None if match["time"] is None else _moment(match["time"])
    parsed = _Parsed(time, match["bus"], identifier, b"", extended)
    if match["remote"] or match["request"]:
        return parsed._replace(remote=int((match["remote"] or "R")[1:] or 0))
    if match["flags"]:
        return parsed._replace(data=bytes.fromhex(match["fd"]), fd=int(match["flags"], 16))
    data = bytes.fromhex((match["data"] or match["spaced"] or "").replace(".", ""))
    return parsed._replace(data=data, fd=0 if len(data) > 8 else None)


def _angstrom(match: re.Match[str]) -> _Parsed:
    data = bytes.fromhex(match["data"])
    return _Parsed(None, "", int(match["id"], 16), data, len(match["id"]) > 3)


def _yacht_devices(match: re.Match[str]) -> _Parsed:
    return _Parsed(_moment(match["time"]), "", int(match["id"], 16), bytes.fromhex(match["data"]))


def _canboat(match: re.Match[str]) -> _Parsed | None:
    data = bytes.fromhex(match["data"].replace(",", ""))
    if len(data) < int(match["size"]):
        return None  # a line that is cut
    return _message(match, data[: int(match["size"])], _moment(match["time"]))


def _analyzer(match: re.Match[str]) -> _Parsed:
    return _message(match, bytes.fromhex(match["data"]), _moment(match["time"]))


def _actisense(match: re.Match[str]) -> _Parsed:
    text = match["time"]
    time = int(text[:2]) * 3600.0 + int(text[2:4]) * 60.0 + float(text[4:])
    return _message(match, bytes.fromhex(match["data"]), time, 16)


def _ikonvert(match: re.Match[str]) -> _Parsed:
    return _message(match, base64.b64decode(match["data"], validate=True), float(match["time"]))


def _garmin(match: re.Match[str]) -> _Parsed | None:
    data = bytes.fromhex(match["data"])
    if len(data) != int(match["size"]):
        return None  # a line that is cut
    # The date before the ticks has whole seconds of another clock.
    return _message(match, data, int(match["ticks"]) / 1000.0)


def _pcdin(match: re.Match[str]) -> _Parsed:
    return _message(match, bytes.fromhex(match["data"]), int(match["time"], 16) / 1024.0, 16)


def _message(match: re.Match[str], data: bytes, time: float, base: int = 10) -> _Parsed:
    identifier = _identifier(match.groupdict(), base)
    return _Parsed(time, "", identifier, data, is_message=True)


def _moment(text: str) -> float:
    """Return a time, s: a number, a time of day, or a date and time of several spellings."""
    text = text.strip()
    try:
        return float(text)
    except ValueError:
        pass
    if re.fullmatch(r"\d{1,2}:\d\d:\d\d(\.\d+)?", text):
        hours, minutes, rest = text.split(":")
        return int(hours) * 3600.0 + int(minutes) * 60.0 + float(rest)
    # canboat of before has a third hyphen in the place of the T.
    iso = re.sub(r"^(\d{4}-\d\d-\d\d)-", r"\1T", text)
    found = datetime.fromisoformat(re.sub(r"(\.\d{6})\d+", r"\1", iso))
    return (found if found.tzinfo else found.replace(tzinfo=UTC)).timestamp()


_LINES: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], _Parsed | None]], ...] = (
    (_CANDUMP, _candump),
    (_YACHT_DEVICES, _yacht_devices),
    (_CANBOAT, _canboat),
    (_ANALYZER, _analyzer),
    (_ACTISENSE, _actisense),
    (_IKONVERT, _ikonvert),
    (_PCDIN, _pcdin),
    (_ANGSTROM, _angstrom),
    (_GARMIN, _garmin),
)
