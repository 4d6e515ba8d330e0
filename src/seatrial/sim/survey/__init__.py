"""FMUs of others by the hundred: each loads, runs in every way and agrees with FMPy, or why not."""
