/* The interrupt flag; interrupts of their own (ISR) are the emulator's. */
#ifndef INTERRUPT_H
#define INTERRUPT_H
void interrupts();
void noInterrupts();
#include <stdint.h>
/* The status register, of which the flag that enables interrupts is there. */
struct SketchStatus {
    operator uint8_t() const;
    SketchStatus &operator=(uint8_t status);
    SketchStatus &operator|=(uint8_t status) { return *this = (uint8_t)(*this | status); }
    SketchStatus &operator&=(uint8_t status) { return *this = (uint8_t)(*this & status); }
};
extern SketchStatus sketch_status;
#define SREG sketch_status
#define SREG_I 7
#define sei interrupts
#define cli noInterrupts
/* Where a condition left one for the compiler to find. */
#define ISR(vector, ...) static_assert(false, #vector ": interrupt routines of the hardware need the back end simavr"); void vector()
#define SIGNAL ISR
#endif
