/* What libraries for the web compute: MD5, SHA-1 and base64. */
#include "MD5Builder.h"
#include "sha/sha_parallel_engine.h"
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

/* FIPS 180-4, section 6.1. */
void esp_sha(esp_sha_type, const unsigned char *data, size_t size, unsigned char *to)
{
    auto turned = [](uint32_t x, int by) { return x << by | x >> (32 - by); };
    uint32_t state[5] = {0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476, 0xc3d2e1f0};
    std::string text((const char *)data, size);
    text += '\x80';
    text.resize((text.size() + 8 + 63) / 64 * 64 - 8);
    for (int byte = 7; byte >= 0; byte--)
        text += (char)(8ull * size >> 8 * byte);
    for (size_t block = 0; block < text.size(); block += 64) {
        uint32_t w[80], a = state[0], b = state[1], c = state[2], d = state[3], e = state[4];
        for (int t = 0; t < 80; t++) {
            const uint8_t *at = (const uint8_t *)text.data() + block + 4 * (t & 15);
            w[t] = t < 16 ? (uint32_t)(at[0] << 24 | at[1] << 16 | at[2] << 8 | at[3]) : turned(w[t - 3] ^ w[t - 8] ^ w[t - 14] ^ w[t - 16], 1);
            uint32_t f = t < 20 ? (b & c) | (~b & d) : t >= 40 && t < 60 ? (b & c) | (b & d) | (c & d) : b ^ c ^ d;
            const uint32_t k[] = {0x5a827999, 0x6ed9eba1, 0x8f1bbcdc, 0xca62c1d6};
            uint32_t next = turned(a, 5) + f + e + k[t / 20] + w[t];
            e = d, d = c, c = turned(b, 30), b = a, a = next;
        }
        state[0] += a, state[1] += b, state[2] += c, state[3] += d, state[4] += e;
    }
    for (int byte = 0; byte < 20; byte++)
        to[byte] = (unsigned char)(state[byte / 4] >> (24 - 8 * (byte % 4)));
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
