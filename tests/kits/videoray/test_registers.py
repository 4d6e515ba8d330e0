"""The memory map: scalings round-trip, and what may be written."""

import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray import registers as csr

from .bench import PACKETS, exchange, frames, make_node, request

# VideoRay's map, its columns "read only" and "non-volatile", and what the device itself measures.
READ_ONLY = [
    0x13,
    *range(0x5F, 0x62),
    *range(0x64, 0xA0),
    *range(0xB4, 0xCA),
    0xE3,
    0xE4,
    *range(0xEB, 0xEE),
]
STORED = [*range(0x14, 0x36), *range(0x46, 0x5A), *range(0x88, 0x8A), *range(0x8C, 0x90)]


def test_registers_do_not_overlap_and_lie_below_the_special_ones():
    places = [a for r in csr.REGISTERS for a in range(r.address, r.address + r.size)]
    assert len(set(places)) == len(places)
    assert max(places) == csr.TOP - 1


def test_raw_numbers_round_trip_through_value_and_memory():
    memory = csr.factory_memory()
    for register in csr.REGISTERS:
        low, high = register.lowest, register.highest
        for raw in {low, high, 0, 1, *range(low, high, (high - low) // 97 + 1)}:
            csr.put(memory, register.name, raw)
            assert register.raw_in(memory) == raw, register.name
            assert register.clipped(csr.value(memory, register.name)) == raw, register.name


def test_what_does_not_fit_is_refused():
    for register in csr.REGISTERS:
        for raw in (register.lowest - 1, register.highest + 1):
            with pytest.raises(InputError, match=register.name):
                register.bytes_of(raw)


def test_captured_configuration_is_that_of_a_new_vehicle():
    captured = frames(PACKETS[5])[0].payload[1:]
    assert csr.factory_memory()[:0x5A] == captured[:0x5A]


def test_each_byte_is_written_or_not_as_the_map_says():
    for place in range(csr.TOP):
        node = make_node()
        before = bytes(node.memory)
        new = bytes((before[place] ^ 0x55,))
        expected = before[place : place + 1] if place in READ_ONLY else new
        if place in (csr.COMMIT, csr.COMMIT + 1):
            expected = b"\0"
        where = f"0x{place:02X}"
        assert exchange(node, flags=0x81, address=place, payload=new) == expected, where
        others = [a for a in range(csr.TOP) if a != place]
        assert [node.memory[a] for a in others] == [before[a] for a in others], where


@pytest.mark.parametrize("commits", [False, True])
def test_what_outlives_a_reboot(commits):
    node = make_node(commits=commits)
    factory = bytes(node.memory)
    everything = bytes(byte ^ 0x55 for byte in factory[:0xEE])
    node.handle(request(payload=everything))
    changed = bytes(node.memory)
    if commits:
        other = make_node(commits=True)
        other.handle(request(payload=everything))
        other.reboot()
        assert other.memory == factory  # without a commit
        node.handle(request(address=csr.COMMIT, payload=b"\1\0"))
    node.reboot()
    kept = {a for a in range(csr.TOP) if node.memory[a] == changed[a] != factory[a]}
    lost = {a for a in range(csr.TOP) if node.memory[a] == factory[a] != changed[a]}
    assert kept == set(csr.STORED) - set(READ_ONLY)
    assert {a for a in STORED if a not in READ_ONLY} <= kept
    assert kept | lost == {a for a in range(csr.TOP) if changed[a] != factory[a]}
    assert set(range(0x0F)) <= lost


def test_settings_are_read_in_their_units():
    assert csr.read_settings("auto_depth_p -0.02; max_current 33") == {
        "auto_depth_p": -200,
        "max_current": 3300,
    }


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("auto_dept_p 1", "did you mean 'auto_depth_p'"),
        ("heading 3", "unknown stored register"),
        ("auto_depth_p much", "a number is needed, found 'much'"),
        ("auto_depth_p nan", "a number is needed"),
        ("auto_depth_p 4", "40000 is not from -32768 to 32767"),
    ],
)
def test_settings_that_cannot_be_are_refused(text, message):
    with pytest.raises(InputError, match=message):
        csr.read_settings(text)
