"""Fuzz one harness for long with Atheris: ``python -m tests.fuzz NAME [options of libFuzzer]``."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

CORPUS = Path(__file__).parent / "corpus"


def main() -> None:
    """Run the harness; new inputs go into the first folder that the options name."""
    import atheris  # the extra "fuzz"

    name, *options = sys.argv[1:]
    with atheris.instrument_imports(include=["seatrial"]):
        harness = import_module(f"tests.fuzz.fuzz_{name}")
    seeds = CORPUS / name
    atheris.Setup([name, *options, *([str(seeds)] if seeds.is_dir() else [])], harness.one)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
