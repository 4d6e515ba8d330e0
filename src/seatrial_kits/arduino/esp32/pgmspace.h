/* Flash is memory like any other. */
#ifndef PGMSPACE_H
#define PGMSPACE_H
#include <stdint.h>
#include <stdio.h>
#include <string.h>
typedef void prog_void;
typedef char prog_char;
typedef uint8_t prog_uint8_t;
typedef uint16_t prog_uint16_t;
typedef uint32_t prog_uint32_t;
#define PROGMEM
#define PGM_P const char *
#define PGM_VOID_P const void *
#define PSTR(text) (text)
#define FPSTR(text) (reinterpret_cast<const __FlashStringHelper *>(text))
#define SIZE_IRRELEVANT 0x7fffffff
#define pgm_read_byte(at) (*(const unsigned char *)(at))
#define pgm_read_word(at) (*(const unsigned short *)(at))
#define pgm_read_dword(at) (*(const unsigned long *)(at))
#define pgm_read_float(at) (*(const float *)(at))
#define pgm_read_ptr(at) (*(void *const *)(at))
#define pgm_read_byte_near pgm_read_byte
#define pgm_read_word_near pgm_read_word
#define pgm_read_dword_near pgm_read_dword
#define pgm_read_float_near pgm_read_float
#define memcpy_P memcpy
#define memcmp_P memcmp
#define memccpy_P memccpy
#define memmem_P memmem
#define strcpy_P strcpy
#define strncpy_P strncpy
#define strcat_P strcat
#define strncat_P strncat
#define strcmp_P strcmp
#define strncmp_P strncmp
#define strcasecmp_P strcasecmp
#define strncasecmp_P strncasecmp
#define strlen_P strlen
#define strnlen_P strnlen
#define strstr_P strstr
#define strchr_P strchr
#define printf_P printf
#define sprintf_P sprintf
#define snprintf_P snprintf
#define vsnprintf_P vsnprintf
#endif
