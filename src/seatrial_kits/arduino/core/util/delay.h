/* Waiting. */
#ifndef DELAY_H
#define DELAY_H
#include "../Arduino.h"
inline void _delay_us(double us) { delayMicroseconds((unsigned)us); }
inline void _delay_ms(double ms) { _delay_us(ms * 1000.0); }
#endif
