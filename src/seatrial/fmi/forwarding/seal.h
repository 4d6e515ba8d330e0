/* What serialised states begin with: which FMU they are of, their size, and a hash of their bytes. */

#ifndef SEAL_H
#define SEAL_H

#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef struct {
    uint64_t fmu, size, content;
} Seal;

/* FNV-1a of 64 bits: http://www.isthe.com/chongo/tech/comp/fnv/ */
static inline uint64_t seal_hash(const void *bytes, size_t size) {
    const unsigned char *const each = (const unsigned char *)bytes;
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < size; i++) hash = (hash ^ each[i]) * 0x100000001b3u;
    return hash;
}

/* Which FMU it is, by its GUID. */
static inline uint64_t seal_fmu(const char *guid) { return seal_hash(guid, strlen(guid)); }

/* Seal `size` bytes, which follow the seal. */
static inline void seal_up(void *sealed, uint64_t fmu, size_t size) {
    const Seal seal = {fmu, size, seal_hash((char *)sealed + sizeof seal, size)};
    memcpy(sealed, &seal, sizeof seal);
}

/* Whether `size` bytes with their seal are what was sealed by this FMU; if not, write why. */
static inline int seal_holds(const void *sealed, size_t size, uint64_t fmu, char *why, size_t capacity) {
    Seal seal = {0, 0, 0};
    if (size < sizeof seal) {
        snprintf(why, capacity, "%zu bytes are no state", size);
        return 0;
    }
    memcpy(&seal, sealed, sizeof seal);
    const size_t rest = size - sizeof seal;
    if (seal.fmu != fmu)
        snprintf(why, capacity, "the %zu bytes are no state of this FMU", size);
    else if (seal.size != rest)
        snprintf(why, capacity, "the state has %zu bytes, found %zu", (size_t)seal.size + sizeof seal,
                 size);
    else if (seal.content != seal_hash((const char *)sealed + sizeof seal, rest))
        snprintf(why, capacity, "the bytes are not those that were saved: their hash differs");
    else
        return 1;
    return 0;
}

#endif
