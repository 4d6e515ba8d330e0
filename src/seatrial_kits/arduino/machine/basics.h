/* What the API has alike on every board: pulses and bytes at pins, characters, C strings. */
#ifndef BASICS_H
#define BASICS_H

#include <ctype.h>
#include <stddef.h>
#include <stdint.h>

#include "board.h"

sketch_ulong pulseIn(uint8_t pin, uint8_t level, sketch_ulong timeout = 1000000); /* us */
sketch_ulong pulseInLong(uint8_t pin, uint8_t level, sketch_ulong timeout = 1000000);
void shiftOut(uint8_t data, uint8_t clock, uint8_t order, uint8_t value);
uint8_t shiftIn(uint8_t data, uint8_t clock, uint8_t order);

inline bool isDigit(int c) { return isdigit(c); }
inline bool isAlpha(int c) { return isalpha(c); }
inline bool isAlphaNumeric(int c) { return isalnum(c); }
inline bool isSpace(int c) { return isspace(c); }
inline bool isWhitespace(int c) { return c == ' ' || c == '\t'; }
inline bool isUpperCase(int c) { return isupper(c); }
inline bool isLowerCase(int c) { return islower(c); }
inline bool isHexadecimalDigit(int c) { return isxdigit(c); }
inline bool isPunct(int c) { return ispunct(c); }
inline bool isPrintable(int c) { return isprint(c); }
inline bool isControl(int c) { return iscntrl(c); }
inline bool isGraph(int c) { return isgraph(c); }
inline bool isAscii(int c) { return c >= 0 && c < 128; }
inline sketch_int toAscii(int c) { return (sketch_int)(c & 0x7F); }
inline sketch_int toLowerCase(int c) { return (sketch_int)tolower(c); }
inline sketch_int toUpperCase(int c) { return (sketch_int)toupper(c); }
inline uint16_t makeWord(uint16_t w) { return w; }
inline uint16_t makeWord(uint8_t high, uint8_t low) { return (uint16_t)(high << 8 | low); }

char *strupr(char *text);
char *strlwr(char *text);
size_t sketch_strlcpy(char *to, const char *from, size_t size); /* newer computers' C libraries have them, too */
size_t sketch_strlcat(char *to, const char *from, size_t size);
#define strlcpy sketch_strlcpy
#define strlcat sketch_strlcat

#endif
