"""Processor time of commands beside that of ``import numpy``: ``python -m benchmarks.start``.

Each command runs in a process of its own, in turn, for some rounds; user and system time are
counted together. Ratios are those of one round; the median and the range are shown. ``--write``
puts the table into docs/performance.md. The first round fills the caches and is left out.
"""

from __future__ import annotations

import argparse
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile

from .pages import write_measured

YARDSTICK = "import numpy"
_SEATRIAL = "from seatrial.cli import main; main()"
_TRIAL = ("run", "hydrone-landing", "--set", "stop=0.1 s")
COMMANDS = {
    YARDSTICK: (YARDSTICK,),
    "seatrial --help": (_SEATRIAL, "--help"),
    "seatrial --version": (_SEATRIAL, "--version"),
    "seatrial list": (_SEATRIAL, "list"),
    "a trial of 0.1 s, with its report": (_SEATRIAL, *_TRIAL),
    "the same, --engine direct": (_SEATRIAL, *_TRIAL, "--engine", "direct"),
}


def processor_time(command: tuple[str, ...], folder: str) -> float:
    """Return the processor time of a Python program with arguments, s."""
    # Bytecode is kept, as on any machine where nobody has turned that off.
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [sys.executable, "-c", *command],
        cwd=folder,
        env={**environment, "SEATRIAL_CACHE": f"{folder}/cache"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode not in (0, 1):  # 1: a criterion does not hold in 0.1 s
        raise SystemExit(done.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def measure(rounds: int) -> dict[str, list[float]]:
    """Return the processor times of every command, one per round."""
    found: dict[str, list[float]] = {name: [] for name in COMMANDS}
    with tempfile.TemporaryDirectory(prefix="seatrial-") as folder:
        for number in range(-1, rounds):
            for name, command in COMMANDS.items():
                taken = processor_time(command, folder)
                if number >= 0:
                    found[name].append(taken)
    return found


def table(found: dict[str, list[float]]) -> str:
    """Return the table in Markdown."""
    rows = [f"| command | processor time, s | ratio to `{YARDSTICK}` |", "| --- | --- | --- |"]
    for name, times in found.items():
        ratios = [a / b for a, b in zip(times, found[YARDSTICK], strict=True)]
        ratio = f"{statistics.median(ratios):.1f} ({min(ratios):.1f} to {max(ratios):.1f})"
        shown = f"`{name}`" if name.startswith(("seatrial", "import")) else name
        rows.append(f"| {shown} | {statistics.median(times):.2f} | {ratio} |")
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument(
        "--write", action="store_true", help="put the table into docs/performance.md"
    )
    arguments = parser.parse_args()
    text = f"Python {platform.python_version()}, {arguments.rounds} rounds.\n\n"
    text += table(measure(arguments.rounds))
    print(text)
    if arguments.write:
        write_measured("performance.md", text, "measured at the start")


if __name__ == "__main__":
    main()
