"""``python -m seatrial``: the command line."""

from .cli import main

main()
