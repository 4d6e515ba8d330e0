/* Bytes with the times at which they were sent, as text and packed.

   Text, of a String: SEQUENCE;TIME:BASE64;TIME:BASE64;...
   Packed, of a Binary, least byte first: sequence (8 bytes), then of each chunk its time in ns (8),
   its length (4) and its bytes. Nothing was ever sent: both are empty. */

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "front.h"

#define HEAD 8
#define CHUNK_HEAD 12
#define LONGEST_NUMBER 20 /* digits of 2^64 */

static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

static void put(unsigned char *to, uint64_t number, int size) {
    for (int i = 0; i < size; i++) to[i] = (unsigned char)(number >> 8 * i);
}

static uint64_t got(const unsigned char *from, int size) {
    uint64_t number = 0;
    for (int i = 0; i < size; i++) number |= (uint64_t)from[i] << 8 * i;
    return number;
}

/* Read a decimal number without sign; return what follows it, NULL if there is none. */
static const char *number_in(const char *text, uint64_t *number) {
    const char *const start = text;
    for (*number = 0; '0' <= *text && *text <= '9'; text++) {
        const uint64_t digit = (uint64_t)(*text - '0');
        if (*number > (UINT64_MAX - digit) / 10) return NULL;
        *number = *number * 10 + digit;
    }
    return text == start ? NULL : text;
}

/* Read base64 up to a semicolon; return what follows it, NULL for what is none. */
static const char *base64_in(const char *text, unsigned char *to, size_t *size) {
    const size_t length = strcspn(text, ";");
    *size = 0;
    if (length % 4) return NULL;
    for (size_t i = 0; i < length; i += 4) {
        uint32_t four = 0;
        int pads = 0;
        for (int k = 0; k < 4; k++) {
            const char c = text[i + (size_t)k];
            const char *const digit = strchr(digits, c);
            if (c == '=' && i + 4 == length && k >= 2) pads++;
            else if (!digit || pads) return NULL;
            four = four << 6 | (c == '=' ? 0 : (uint32_t)(digit - digits));
        }
        for (int k = 0; k < 3 - pads; k++) to[(*size)++] = (unsigned char)(four >> (16 - 8 * k));
    }
    return text + length;
}

long long chunks_from_text(const char *text, unsigned char *to) {
    unsigned char *next = to + HEAD;
    uint64_t number;
    if (!*text) return 0;
    text = number_in(text, &number);
    put(to, number, HEAD);
    while (text && *text == ';') {
        size_t size = 0;
        text = number_in(text + 1, &number);
        if (!text || *text != ':') return -1;
        text = base64_in(text + 1, next + CHUNK_HEAD, &size);
        put(next, number, 8);
        put(next + 8, size, 4);
        next += CHUNK_HEAD + size;
    }
    return text && !*text ? next - to : -1;
}

static char *with_base64(char *to, const unsigned char *bytes, size_t size) {
    for (size_t i = 0; i < size; i += 3) {
        const size_t rest = size - i;
        const uint32_t three = (uint32_t)bytes[i] << 16 |
                               (rest > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) |
                               (rest > 2 ? (uint32_t)bytes[i + 2] : 0);
        for (size_t k = 0; k < 4; k++) *to++ = k <= rest ? digits[three >> (18 - 6 * k) & 63] : '=';
    }
    return to;
}

static char *with_number(char *to, uint64_t number) {
    return to + snprintf(to, LONGEST_NUMBER + 2, "%llu", (unsigned long long)number);
}

long long chunks_to_text(const unsigned char *bytes, size_t size, char *to) {
    const char *const start = to;
    *to = '\0';
    if (size == 0) return 0;
    if (size < HEAD) return -1;
    to = with_number(to, got(bytes, HEAD));
    for (size_t place = HEAD; place < size;) {
        if (size - place < CHUNK_HEAD) return -1;
        const uint64_t time = got(bytes + place, 8), length = got(bytes + place + 8, 4);
        place += CHUNK_HEAD;
        if (size - place < length) return -1;
        *to++ = ';';
        to = with_number(to, time);
        *to++ = ':';
        to = with_base64(to, bytes + place, length);
        place += length;
    }
    *to = '\0';
    return to - start;
}
