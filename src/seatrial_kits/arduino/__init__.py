"""Arduino boards in the loop: sketches compiled for the computer, real firmware, real boards.

`sketch` reads a sketch, `dialect` gives it a board's widths of numbers, `unsupported` lists what
cannot be, `build` compiles it to a program that `board` steps over pipes; `component` puts its
pins on ports. `core` is the Arduino API in simulated time, ``avr`` the emulated board.
"""
