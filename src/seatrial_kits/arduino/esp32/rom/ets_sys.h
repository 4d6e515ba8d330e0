/* Waiting by the functions of the chip's ROM. */
#ifndef ETS_SYS_H
#define ETS_SYS_H

#include <stdint.h>

void delayMicroseconds(uint32_t us);
inline void ets_delay_us(uint32_t us) { delayMicroseconds(us); }

#endif
