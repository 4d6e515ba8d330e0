"""What simulated and emulated boards have in common, in C."""

DATA_FILES = (
    "link.h",
    "parts.h",
    "waves.h",
)
