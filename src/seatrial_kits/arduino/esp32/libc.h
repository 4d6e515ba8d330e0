/* What the board's C library has, and a computer's has not. */
#ifndef SKETCH_LIBC_H
#define SKETCH_LIBC_H
#include <stddef.h>
char *itoa(int value, char *to, int base);
char *ltoa(long value, char *to, int base);
char *utoa(unsigned value, char *to, int base);
char *ultoa(unsigned long value, char *to, int base);
char *lltoa(long long value, char *to, int base);
char *ulltoa(unsigned long long value, char *to, int base);
char *dtostrf(double value, signed char width, unsigned char precision, char *to);
#endif
