/* Blocks without interrupts. */
#ifndef ATOMIC_H
#define ATOMIC_H
#include "../avr/interrupt.h"
bool interrupts_enabled();
struct AtomicBlock {
    AtomicBlock() : was(interrupts_enabled()), once(true) { noInterrupts(); }
    ~AtomicBlock() { if (was) interrupts(); }
    bool was, once;
};
#define ATOMIC_RESTORESTATE 0
#define ATOMIC_FORCEON 0
#define ATOMIC_BLOCK(mode) for (AtomicBlock atomic; atomic.once; atomic.once = false)
#endif
