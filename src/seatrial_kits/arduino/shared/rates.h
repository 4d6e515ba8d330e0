/* Rates of UARTs and of their lines, baud. */
#ifndef SEATRIAL_RATES_H
#define SEATRIAL_RATES_H

#include <math.h>

#define OTHER_RATE_S 2.0 /* a UART may be open at a rate that is not its line's for so long: programs try several */

/* Whether bytes get through: half a bit is lost over ten. A rate of 0 is none. */
static inline int rates_match(double uart, double line)
{
    return uart <= 0.0 || line <= 0.0 || fabs(uart / line - 1.0) <= 0.04;
}

#endif
