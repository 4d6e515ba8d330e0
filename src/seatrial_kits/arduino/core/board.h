/* An AVR board: a sketch's numbers, and what it has. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

typedef int16_t sketch_int; /* int and double of a sketch */
typedef float sketch_real;
typedef uint32_t sketch_ulong; /* unsigned long */

namespace board {

#ifdef BOARD_MEGA
constexpr int PINS = 70, INTERRUPTS = 6, UARTS = 4;
constexpr char NAME[] = "Mega";
constexpr int INTERRUPT_PIN[INTERRUPTS] = {2, 3, 21, 20, 19, 18};
#else
constexpr int PINS = 20, INTERRUPTS = 2, UARTS = 4; /* three lines are for SoftwareSerial */
constexpr char NAME[] = "Uno";
constexpr int INTERRUPT_PIN[INTERRUPTS] = {2, 3};
#endif
constexpr char MEMORY[] = "8 kB or less";
constexpr int RECEIVED = 64, SENT = 64; /* bytes of a UART's rings */
constexpr int STRETCH = 12;             /* cycles of a stretch of code without jumps */
constexpr int INTERRUPT = 80; /* registers saved and restored, the handler called */
constexpr size_t STACK = 64 << 10;

inline int interrupt_of(int pin)
{
    for (int each = 0; each < INTERRUPTS; each++)
        if (INTERRUPT_PIN[each] == pin)
            return each;
    return -1;
}

} // namespace board

#endif
