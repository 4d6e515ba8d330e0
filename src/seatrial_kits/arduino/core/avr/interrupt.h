/* The interrupt flag; interrupts of their own (ISR) are the emulator's. */
#ifndef INTERRUPT_H
#define INTERRUPT_H
void interrupts();
void noInterrupts();
#define sei interrupts
#define cli noInterrupts
/* Where a condition left one for the compiler to find. */
#define ISR(vector, ...) static_assert(false, #vector ": interrupt routines of the hardware need the back end simavr"); void vector()
#define SIGNAL ISR
#endif
