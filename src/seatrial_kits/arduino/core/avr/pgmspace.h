/* Flash is memory like any other here. */
#ifndef PGMSPACE_H
#define PGMSPACE_H
#include <stdint.h>
#include <string.h>
#define PROGMEM
#define PGM_P const char *
#define PSTR(text) (text)
#define pgm_read_byte(at) (*(const uint8_t *)(at))
/* A table of addresses is read by words on the board; an address is longer here. */
template <typename T> uintptr_t sketch_flash_word(T *const *at) { return (uintptr_t)*at; }
template <typename T> uintptr_t sketch_flash_word(T **at) { return (uintptr_t)*at; }
inline uint16_t sketch_flash_word(const volatile void *at) { return *(const uint16_t *)at; }
inline uint16_t sketch_flash_word(uintptr_t at) { return *(const uint16_t *)at; }
#define pgm_read_word(at) sketch_flash_word(at)
#define pgm_read_dword(at) (*(const uint32_t *)(at))
#define pgm_read_float(at) (*(const float *)(at))
#define pgm_read_ptr(at) (*(const void *const *)(at))
#define pgm_read_byte_near pgm_read_byte
#define pgm_read_word_near pgm_read_word
#define pgm_read_dword_near pgm_read_dword
#define pgm_read_float_near pgm_read_float
#define memcpy_P memcpy
#define memcmp_P memcmp
#define strcpy_P strcpy
#define strncpy_P strncpy
#define strcat_P strcat
#define strcmp_P strcmp
#define strncmp_P strncmp
#define strcasecmp_P strcasecmp
#define strlen_P strlen
#define strstr_P strstr
#define strchr_P strchr
#define strrchr_P strrchr
#define strncasecmp_P strncasecmp
#define strncat_P strncat
#define strnlen_P strnlen
#define memchr_P memchr
#endif
