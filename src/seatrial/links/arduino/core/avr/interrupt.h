/* The interrupt flag; interrupts of their own (ISR) are the emulator's. */
#ifndef INTERRUPT_H
#define INTERRUPT_H
void interrupts();
void noInterrupts();
#define sei interrupts
#define cli noInterrupts
#endif
