/* Random numbers: Philox 4x64 of 10 rounds (Salmon et al., SC11), normals by the ziggurat of
   Marsaglia and Tsang (2000) in NumPy's arrangement, so that its numbers come out. */

#include <math.h>

#include "runtime.h"
#include "ziggurat.h"

#define TAIL 3.6541528853610087963519472518
#define ONE_OVER_TAIL 0.27366123732975827203338247596

__extension__ typedef unsigned __int128 Wide;

static void block(const uint64_t counter[4], const uint64_t key[2], uint64_t drawn[4]) {
    uint64_t a = counter[0], b = counter[1], c = counter[2], d = counter[3], k = key[0], l = key[1];
    for (int round = 0; round < 10; round++) {
        const Wide first = (Wide)a * 0xD2E7470EE14C6C93u, second = (Wide)c * 0xCA5A826395121157u;
        a = (uint64_t)(second >> 64) ^ b ^ k;
        b = (uint64_t)second;
        c = (uint64_t)(first >> 64) ^ d ^ l;
        d = (uint64_t)first;
        k += 0x9E3779B97F4A7C15u;
        l += 0xBB67AE8584CAA73Bu;
    }
    drawn[0] = a, drawn[1] = b, drawn[2] = c, drawn[3] = d;
}

void begin_draws(Instance *self, Philox *draws, double seed, uint64_t kind, long long stream,
                 long long index) {
    if (fmod(seed, 1.0) != 0.0)
        fail(self, "seed is %s, a whole number is needed", shown(self, seed));
    *draws = (Philox){{0, 0, (uint64_t)stream, (uint64_t)index}, {(uint64_t)seed, kind}, {0}, 4, 0, 0};
}

static uint64_t next(Philox *draws) {
    if (draws->used == 4) {
        draws->counter[0]++;
        block(draws->counter, draws->key, draws->drawn);
        draws->used = 0;
    }
    return draws->drawn[draws->used++];
}

/* A whole number below `count`, all equally likely: Lemire's method on halves of 64 bits. */
static uint32_t below(Philox *draws, uint32_t count) {
    for (;;) {
        const uint32_t bits = draws->has_half ? draws->half : (uint32_t)(draws->half = next(draws));
        draws->half >>= 32;
        draws->has_half = !draws->has_half;
        const uint64_t product = (uint64_t)bits * count;
        if ((uint32_t)product >= (0u - count) % count) return (uint32_t)(product >> 32);
    }
}

long long drawn_integer(Philox *draws, long long low, long long high) {
    return low + (high - low > 1 ? below(draws, (uint32_t)(high - low)) : 0);
}

double drawn_random(Philox *draws) { return (double)(next(draws) >> 11) * 0x1p-53; }

static double tail(Philox *draws, int negative) {
    for (;;) {
        const double x = -ONE_OVER_TAIL * log1p(-drawn_random(draws));
        const double y = -log1p(-drawn_random(draws));
        if (y + y > x * x) return negative ? -(TAIL + x) : TAIL + x;
    }
}

double drawn_standard_normal(Philox *draws) {
    for (;;) {
        const uint64_t bits = next(draws), far = bits >> 9 & 0x000FFFFFFFFFFFFFu;
        const unsigned layer = bits & 0xFFu;
        const double size = (double)far * LAYERS[layer].width;
        const double x = bits >> 8 & 1u ? -size : size;
        if (far < LAYERS[layer].certain) return x;
        if (layer == 0) return tail(draws, (int)(far >> 8 & 1u));
        const double above = LAYERS[layer - 1].density, here = LAYERS[layer].density;
        if ((above - here) * drawn_random(draws) + here < exp(-0.5 * x * x)) return x;
    }
}
