"""Code shared by simulated and emulated boards, in C."""

DATA_FILES = (
    "link.h",
    "parts.h",
    "rates.h",
    "waves.h",
)
