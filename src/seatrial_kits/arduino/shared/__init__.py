"""Code shared by simulated and emulated boards, in C."""

DATA_FILES = ("drives.h", "link.h", "parts.h", "rates.h", "waves.h")
