"""The node's rules: ids, writes, reads, special registers, reboot."""

import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray import registers as csr
from seatrial_kits.videoray.frame import Frame
from seatrial_kits.videoray.identity import make_identity
from seatrial_kits.videoray.replies import FIELDS

from .bench import BOARDS, exchange, make_node, request

SERIAL = b"J14461".ljust(16, b"\0")
BLOCK = bytes(range(15))


# ------------------------------------------------------------------ ids


@pytest.mark.parametrize("node_id", [1, 0x81, 0xFF])
def test_own_id_group_and_all_are_written(node_id):
    node = make_node()
    node.handle(request(node=node_id, payload=BLOCK))
    assert node.memory[:15] == BLOCK
    assert node.requests == 1


@pytest.mark.parametrize("node_id", [0, 2, 0x7F, 0x41, 0x80, 0x82, 0xC1, 0xFE])
def test_others_are_not(node_id):
    node = make_node()
    before = bytes(node.memory)
    assert node.handle(request(node=node_id, flags=1, payload=BLOCK)) is None
    assert node.memory == before
    assert node.requests == 0


@pytest.mark.parametrize("node_id", [0x81, 0xFF])
@pytest.mark.parametrize("flags", [0, 1, 5, 0x80, 0x84])
def test_groups_and_all_are_never_answered(node_id, flags):
    assert make_node().handle(request(node=node_id, flags=flags)) is None


def test_responses_of_others_are_not_requests():
    node = make_node()
    assert node.handle(Frame(True, 1, 1, 0, BLOCK)) is None
    assert node.memory == csr.factory_memory()


@pytest.mark.parametrize("node_id", [0x40, 0x41, 0x42, 0x7F, 0xC5])
def test_ids_with_the_relay_bit_are_passed_on_whole(node_id):
    node = make_node()
    asked = request(node=node_id, flags=3, address=7, payload=b"abc")
    assert node.handle(asked) is None
    assert node.relayed == [asked]


@pytest.mark.parametrize("node_id", [1, 2, 0x81, 0xFF])
def test_others_are_not_passed_on(node_id):
    node = make_node()
    node.handle(request(node=node_id, flags=1))
    assert node.relayed == []


def test_a_node_with_the_relay_bit_in_its_own_id_answers():
    node = make_node()
    node.handle(request(address=csr.NODE_ID, payload=b"\x45"))
    assert node.handle(request(node=0x45, flags=1)).id == 0x45
    assert node.relayed == []


# ------------------------------------------------------------------ answers


@pytest.mark.parametrize("number", range(1, 6))
def test_device_specific_replies(number):
    node = make_node()
    for place in range(0x66, 0xE5):
        node.memory[place] = place
    answer = node.handle(request(flags=number, address=0x30))
    assert (answer.flags, answer.address) == (number, 0)
    expected = b"".join(
        bytes(range(r.address, r.address + r.size)) if r.name != "total_power" else b"\x64"
        for r in (csr.BY_NAME[name] for name in FIELDS[number])
    )
    assert answer.payload == b"\1" + expected
    assert len(answer.payload) == {1: 9, 2: 9, 3: 11, 4: 13, 5: 34}[number]


@pytest.mark.parametrize("number", [6, 7, 0x40, 0x7F])
def test_replies_that_nobody_defined_are_not_given(number):
    assert make_node().handle(request(flags=number)) is None


def test_no_reply_is_wanted_with_flags_0():
    node = make_node()
    assert node.handle(request(payload=BLOCK)) is None
    assert node.memory[:15] == BLOCK


@pytest.mark.parametrize("address", [0, 1, 0x59, 0x66, 0xEF])
def test_a_dump_ends_at_ef(address):
    node = make_node()
    answer = node.handle(request(flags=0x80, address=address))
    assert (answer.flags, answer.address) == (0x80, address)
    assert answer.payload == b"\1" + bytes(node.memory[address:])
    assert len(answer.payload) == 1 + 0xF0 - address


@pytest.mark.parametrize("count", [1, 2, 15, 127])
@pytest.mark.parametrize("address", [0, 0x66])
def test_a_read_of_n_bytes(count, address):
    node = make_node()
    answer = node.handle(request(flags=0x80 | count, address=address))
    assert (answer.flags, answer.address) == (0x80, address)
    assert answer.payload == b"\1" + bytes(node.memory[address : address + count])


def test_the_reply_comes_after_the_write():
    assert exchange(make_node(), flags=0x8F, payload=BLOCK) == BLOCK
    config = bytes.fromhex("0a00")
    assert exchange(make_node(), flags=0x82, address=0x14, payload=config) == config


def test_the_read_begins_where_the_write_did():
    """One address serves both."""
    assert exchange(make_node(), flags=0x82, address=6, payload=b"\x32\x0a") == b"\x32\x0a"


def test_a_write_across_the_end_of_the_memory_stops_there():
    node = make_node()
    node.handle(request(address=0xEA, payload=bytes([9] * 40)))
    assert node.memory[0xEA] == 9
    assert (node.node_id, node.group_id) == (1, 1)


def test_a_read_across_the_end_of_the_memory_has_the_special_registers():
    found = exchange(make_node(), flags=0x80 | 18, address=0xEE)
    assert found[0xF5 - 0xEE : 0xF7 - 0xEE] == (292).to_bytes(2, "little")
    assert found[0xF8 - 0xEE : 0xFB - 0xEE] == b"\2\6\6"
    assert found[0xFB - 0xEE : 0xFD - 0xEE] == b"\1\1"
    assert len(found) == 0x100 - 0xEE


# ------------------------------------------------------------------ special registers


@pytest.mark.parametrize(
    ("address", "expected"),
    [
        (csr.CONFIG_SIZE, b"\x24\x01"),
        (csr.FIRMWARE_VERSION, b"\2\6\6"),
        (csr.NODE_ID, b"\1"),
        (csr.GROUP_ID, b"\1"),
        (csr.SERIAL_NUMBER, SERIAL),
        (csr.UTILITY, b"\0\0"),
        (csr.CUSTOM_COMMAND + 1, b""),
    ],
)
def test_whole_special_registers(address, expected):
    assert exchange(make_node(), flags=0x80, address=address) == expected


def test_the_configuration_has_293_bytes_with_the_type_of_device():
    answer = make_node().handle(request(flags=0x80, address=csr.CONFIG))
    assert len(answer.payload) == 293
    assert exchange(make_node(), flags=0x85, address=csr.CONFIG) == answer.payload[1:6]


@pytest.mark.parametrize("new", [2, 0x45, 0x7F])
def test_a_new_node_id_holds_from_the_answer_on_and_outlives_a_reboot(new):
    node = make_node()
    answer = node.handle(request(flags=1, address=csr.NODE_ID, payload=bytes([new])))
    assert answer.id == new
    node.reboot()
    assert node.handle(request(node=1, flags=1)) is None
    assert node.handle(request(node=new, flags=1)).id == new


@pytest.mark.parametrize("wrong", [0, 0x80, 0xFF])
def test_node_ids_that_cannot_be_are_refused(wrong):
    node = make_node()
    node.handle(request(address=csr.NODE_ID, payload=bytes([wrong])))
    assert node.node_id == 1


def test_a_new_group():
    node = make_node()
    node.handle(request(address=csr.GROUP_ID, payload=b"\x05"))
    node.handle(request(node=0x81, payload=b"\x01"))
    assert node.memory[0] == 0
    node.handle(request(node=0x85, payload=b"\x01"))
    assert node.memory[0] == 1


@pytest.mark.parametrize("wrong", [0, 0x7F, 0x80, 0xFF])
def test_groups_that_cannot_be_are_refused(wrong):
    node = make_node()
    node.handle(request(address=csr.GROUP_ID, payload=bytes([wrong])))
    assert node.group_id == 1


def test_both_ids_after_each_other():
    node = make_node()
    node.handle(request(address=csr.NODE_ID, payload=b"\x09\x03"))
    assert (node.node_id, node.group_id) == (9, 3)


@pytest.mark.parametrize(("serial", "new"), [(SERIAL, 7), (b"J14462".ljust(16, b"\0"), 1)])
def test_a_node_id_by_serial_number_to_all(serial, new):
    node = make_node()
    node.handle(request(node=0xFF, address=csr.SERIAL_NUMBER, payload=serial + b"\7"))
    assert node.node_id == new


@pytest.mark.parametrize(
    ("writes", "reboots"),
    [
        ([(0xFE, "dead")], True),
        ([(0xFE, "de"), (0xFF, "ad")], True),
        ([(0xFF, "ad"), (0xFE, "de")], True),
        ([(0xFE, "adde")], False),
        ([(0xFE, "de")], False),
        ([(0xFF, "ad")], False),
        ([(0xFE, "deaf")], False),
    ],
)
def test_the_utility_register_reboots(writes, reboots):
    node = make_node()
    for address, data in writes:
        node.handle(request(address=address, payload=bytes.fromhex(data)))
    assert node.wants_reboot is reboots


def test_after_a_reboot_the_commands_are_gone():
    node = make_node()
    node.handle(request(payload=BLOCK))
    node.handle(request(address=0x14, payload=b"\x11\x01"))
    node.handle(request(address=csr.UTILITY, payload=b"\xde\xad"))
    node.reboot()
    assert node.memory[:15] == csr.factory_memory()[:15]
    assert node.memory[0x14:0x16] == b"\x11\x01"
    assert not node.wants_reboot


# ------------------------------------------------------------------ custom commands


@pytest.mark.parametrize(("command", "direction"), [(3, 1), (2, -1), (0, 0)])
def test_the_manipulator_takes_its_commands_and_answers_nothing(command, direction):
    node = make_node()
    node.manipulator = 5
    payload = b"\x35\x49\0\0\0\0" + bytes([command, 0])
    asked = request(node=0x42, address=0xF0, payload=payload)
    assert node.handle(asked) is None
    assert node.manipulator == direction
    assert node.relayed == [asked]


@pytest.mark.parametrize(
    "fields",
    [
        {"node": 0x42, "payload": b"\x35\x49\0\0\0\0\7\0"},
        {"node": 0x42, "payload": b"\x35\x48\0\0\0\0\3\0"},
        {"node": 0x42, "payload": b"\x35\x49\0\0\0\0\3"},
        {"node": 0x42, "payload": b""},
        {"node": 1, "payload": b"\x35\x49\0\0\0\0\3\0"},
    ],
)
def test_what_is_no_command_of_the_manipulator_moves_nothing(fields):
    node = make_node()
    node.handle(request(address=0xF0, **fields))
    assert node.manipulator == 0


@pytest.mark.parametrize("flags", [1, 0x80])
def test_custom_commands_to_the_vehicle_are_taken_and_not_answered(flags):
    node = make_node()
    before = bytes(node.memory)
    assert node.handle(request(flags=flags, address=0xF0, payload=b"\1\2\3")) is None
    assert node.memory == before


# ------------------------------------------------------------------ identity


@pytest.mark.parametrize(
    ("serial", "boards", "firmware", "message"),
    [
        ("J" * 17, BOARDS, "2.6.6", "serial_number.*up to 16"),
        ("é", BOARDS, "2.6.6", "serial_number"),
        ("J1", "a b", "2.6.6", "8 names are needed"),
        ("J1", "a b c d e f g " + "h" * 33, "2.6.6", "boards.*up to 32"),
        ("J1", BOARDS, "2.6", "a version such as 2.6.6"),
        ("J1", BOARDS, "2.6.256", "a version such as 2.6.6"),
    ],
)
def test_identities_that_cannot_be_are_refused(serial, boards, firmware, message):
    with pytest.raises(InputError, match=message):
        make_identity(serial, boards, firmware)
