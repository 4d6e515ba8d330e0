/* avr-libc's functions where a computer's have other widths, or are not there. */
#ifndef AVR_LIBC_H
#define AVR_LIBC_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int sketch_snprintf(char *to, size_t size, const char *format, ...);
int sketch_sprintf(char *to, const char *format, ...);
int sketch_vsnprintf(char *to, size_t size, const char *format, va_list values);
int sketch_sscanf(const char *text, const char *format, ...);
#define snprintf sketch_snprintf
#define sprintf sketch_sprintf
#define vsnprintf sketch_vsnprintf
#define vsprintf(to, format, values) sketch_vsnprintf(to, 4096, format, values)
#define sscanf sketch_sscanf
int sketch_printf(const char *format, ...); /* to where fdevopen() says, else nowhere */
FILE *fdevopen(int (*put)(char c, FILE *to), int (*get)(FILE *from));
#define printf(...) sketch_printf(__VA_ARGS__)
#define printf_P(...) sketch_printf(__VA_ARGS__)
#define snprintf_P sketch_snprintf
#define sprintf_P sketch_sprintf
#define vsnprintf_P sketch_vsnprintf
#define sscanf_P sketch_sscanf

char *dtostrf(double value, signed char width, unsigned char precision, char *to);
char *dtostre(double value, char *to, unsigned char precision, unsigned char flags);
#define DTOSTR_ALWAYS_SIGN 0x01
#define DTOSTR_PLUS_SIGN 0x02
#define DTOSTR_UPPERCASE 0x04
char *itoa(int value, char *to, int base);
char *ltoa(long value, char *to, int base);
char *utoa(unsigned value, char *to, int base);
char *ultoa(unsigned long value, char *to, int base);

#define strlcpy_P sketch_strlcpy
#define strlcat_P sketch_strlcat
char *strrev(char *text);

typedef int16_t (*sketch_comparison)(const void *, const void *);
void sketch_qsort(void *base, size_t count, size_t size, sketch_comparison with);
void *sketch_bsearch(const void *key, const void *base, size_t count, size_t size, sketch_comparison with);
#define qsort sketch_qsort
#define bsearch sketch_bsearch

int16_t sketch_rand();
void sketch_srand(uint16_t seed);
#define rand sketch_rand
#define srand sketch_srand
#undef RAND_MAX
#define RAND_MAX 0x7FFF

inline float frexp(float x, int16_t *exponent)
{
    int wide;
    float mantissa = __builtin_frexpf(x, &wide);
    *exponent = (int16_t)wide;
    return mantissa;
}
template <typename T> inline float square(T x) { return (float)x * (float)x; }

/* Arguments come as int or double where the sketch's type is narrower. */
template <typename T> struct Passed { typedef T type; };
template <> struct Passed<bool> { typedef int type; };
template <> struct Passed<char> { typedef int type; };
template <> struct Passed<signed char> { typedef int type; };
template <> struct Passed<unsigned char> { typedef int type; };
template <> struct Passed<short> { typedef int type; };
template <> struct Passed<unsigned short> { typedef int type; };
template <> struct Passed<float> { typedef double type; };
#undef va_arg
#define va_arg(list, type_) ((type_)__builtin_va_arg(list, Passed<type_>::type))

#endif
