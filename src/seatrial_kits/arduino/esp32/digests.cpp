/* What libraries for the web compute: MD5 and base64. */
#include "MD5Builder.h"
#include "libb64/cencode.h"

/* RFC 1321, section 3: four rounds of 16 operations on blocks of 64 bytes. */
void MD5Builder::calculate()
{
    const int shifts[4][4] = {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};
    uint32_t state[4] = {0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476};
    uint64_t bits = 8ull * all_.size();
    std::string text = all_ + '\x80';
    text.resize((text.size() + 8 + 63) / 64 * 64 - 8);
    text.append((const char *)&bits, 8);
    for (size_t block = 0; block < text.size(); block += 64) {
        uint32_t x[16], a = state[0], b = state[1], c = state[2], d = state[3];
        memcpy(x, text.data() + block, 64);
        for (int i = 0; i < 64; i++) {
            int round = i / 16;
            uint32_t f = round == 0 ? (b & c) | (~b & d) : round == 1 ? (b & d) | (c & ~d) : round == 2 ? b ^ c ^ d : c ^ (b | ~d);
            int k = round == 0 ? i : round == 1 ? 5 * i + 1 : round == 2 ? 3 * i + 5 : 7 * i;
            uint32_t sum = a + f + x[k & 15] + (uint32_t)(4294967296.0 * fabs(sin(i + 1.0)));
            int shift = shifts[round][i & 3];
            a = d, d = c, c = b;
            b += sum << shift | sum >> (32 - shift);
        }
        state[0] += a, state[1] += b, state[2] += c, state[3] += d;
    }
    memcpy(sum_, state, sizeof sum_);
}

void MD5Builder::getChars(char *to)
{
    for (int each = 0; each < 16; each++)
        sprintf(to + 2 * each, "%02x", sum_[each]);
}

int base64_encode_chars(const char *data, int size, char *to)
{
    const char *digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *at = to;
    for (int i = 0; i < size; i += 3) {
        uint32_t three = (uint8_t)data[i] << 16 | (i + 1 < size ? (uint8_t)data[i + 1] << 8 : 0) | (i + 2 < size ? (uint8_t)data[i + 2] : 0);
        for (int digit = 0; digit < 4; digit++)
            *at++ = i + digit > size ? '=' : digits[three >> (18 - 6 * digit) & 63];
    }
    *at = 0;
    return (int)(at - to);
}

int base64_encode_blockend(char *to, base64_encodestate *state) { return base64_encode_chars(state->all.data(), (int)state->all.size(), to); }
