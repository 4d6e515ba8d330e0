"""An independent construction of frames on the bus: plain lists of bits, one rule after the other."""

from seatrial_kits.can.frame import FD_LENGTHS, Frame


def number(value: int, count: int) -> list[int]:
    return [int(digit) for digit in format(value, f"0{count}b")] if count else []


def crc15(bits: list[int]) -> int:
    """Bit by bit, as ISO 11898-1 has it: shift, and subtract the polynomial if a bit falls out."""
    register = 0
    for bit in bits:
        falls_out = bit ^ (register >> 14 & 1)
        register = register << 1 & 0x7FFF
        if falls_out:
            register ^= 0x4599
    return register


def stuffed(bits: list[int]) -> list[int]:
    """After five equal bits one of the other value, which is itself counted."""
    sequence: list[int] = []
    run = 0
    for bit in bits:
        run = run + 1 if sequence and sequence[-1] == bit else 1
        sequence.append(bit)
        if run == 5:
            sequence.append(1 - bit)
            run = 1
    return sequence


def identifier(frame: Frame, request: int) -> list[int]:
    """Start of frame to the bit before r0, or FDF."""
    if not frame.extended:
        return [0, *number(frame.identifier, 11), request, 0]
    base, rest = divmod(frame.identifier, 1 << 18)
    return [0, *number(base, 11), 1, 1, *number(rest, 18), request]


def classic(frame: Frame) -> list[int]:
    """Start of frame to the end of end of frame."""
    reserved = [0, 0] if frame.extended else [0]
    dlc = frame.requested if frame.remote else len(frame.data)
    bits = identifier(frame, int(frame.remote)) + reserved + number(dlc, 4)
    for byte in frame.data:
        bits += number(byte, 8)
    bits += number(crc15(bits), 15)
    return stuffed(bits) + [1, 0, 1] + [1] * 7


def fd(frame: Frame) -> tuple[list[int], list[int], list[int]]:
    """Bits up to the resolution of BRS; from ESI to the CRC; and from the CRC delimiter on.

    The CRC itself is left at 0: its stuff bits are at fixed places.
    """
    head = [*identifier(frame, 0), 1, 0, int(frame.bit_rate_switch)]
    rest = [int(frame.error_state), *number(FD_LENGTHS.index(len(frame.data)), 4)]
    for byte in frame.data:
        rest += number(byte, 8)
    arbitration, sequence = len(stuffed(head)), stuffed(head + rest)
    if stuffed((head + rest)[:-1]) != sequence[:-1]:  # a stuff bit after the very last one: the
        sequence = sequence[:-1]  # fixed stuff bit that follows takes its place
    crc = number(0, 4 + (17 if len(frame.data) <= 16 else 21))
    field = []
    for place, bit in enumerate(crc):
        if place % 4 == 0:
            field.append(1 - sequence[-1] if place == 0 else 1 - field[-1])
        field.append(bit)
    return sequence[:arbitration], sequence[arbitration:] + field, [1, 0, 1] + [1] * 7
