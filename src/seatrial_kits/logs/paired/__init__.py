"""Signals of a run and channels of a log at common times, and what is left between them."""
