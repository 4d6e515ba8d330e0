/* Digests by the chip's hardware: of those it has, SHA-1. */
#ifndef SHA_PARALLEL_ENGINE_H
#define SHA_PARALLEL_ENGINE_H

#include <stddef.h>

typedef enum { SHA1 } esp_sha_type;
void esp_sha(esp_sha_type type, const unsigned char *data, size_t size, unsigned char *to);

#endif
