/* Base64 (RFC 4648), by the functions that libraries call; a block is encoded at its end. */
#ifndef CENCODE_H
#define CENCODE_H

#include <string>

typedef struct {
    std::string all;
} base64_encodestate;

#define base64_encode_expected_len(n) ((((4 * (n)) / 3 + 3) & ~3))
inline void base64_init_encodestate(base64_encodestate *state) { state->all.clear(); }
inline int base64_encode_block(const char *data, int size, char *, base64_encodestate *state) { state->all.append(data, (size_t)size); return 0; }
int base64_encode_blockend(char *to, base64_encodestate *state);
int base64_encode_chars(const char *data, int size, char *to);

#endif
