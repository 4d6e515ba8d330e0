"""Libraries of FMUs in Python, in C: they check every call before pythonfmu's library gets it."""
