/* The watchdog: a board whose sketch stops feeding it starts again. */
#ifndef WDT_H
#define WDT_H
#include <stdint.h>
enum { WDTO_15MS, WDTO_30MS, WDTO_60MS, WDTO_120MS, WDTO_250MS, WDTO_500MS, WDTO_1S, WDTO_2S, WDTO_4S, WDTO_8S };
extern uint8_t &sketch_reset_flags;
#define MCUSR sketch_reset_flags
enum { PORF, EXTRF, BORF, WDRF };
void wdt_enable(uint8_t timeout);
void wdt_disable();
void wdt_reset();
#endif
