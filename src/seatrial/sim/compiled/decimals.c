/* Rows of numbers as text, as Python's `repr` writes them: the fewest digits that read back exactly,
   of those the nearest ([Giulietti2020] of docs/bibliography.md).

   With v = c 2^q and k so that 10^k <= 2^q < 10^(k+1), at most one multiple of 10^(k+1) and at
   least one of 10^k read back as v. Products with powers of ten keep all that comparisons need:
   two bits behind the point, and in the last of these whether anything is behind it. */

#include <stdint.h>
#include <string.h>

#if !defined(EXPORT)
#define EXPORT __attribute__((visibility("default")))
#endif

#define LEAST_POWER (-292)

typedef struct {
    uint64_t high, low; /* 10^i, upwards rounded, with the first bit set */
} Power;

typedef struct {
    uint64_t digits;
    int exponent; /* of ten */
} Decimal;

static int64_t floor_log2_of_power(int64_t i) { return i * 1741647 >> 19; }

/* Return n 10^i / 2^128, scaled as `Power` is; the last bit is set where that is no whole number. */
static uint64_t scaled(Power power, uint64_t n)
{
    unsigned __int128 low = (unsigned __int128)power.low * n;
    unsigned __int128 sum = (unsigned __int128)power.high * n + (uint64_t)(low >> 64);
    return (uint64_t)(sum >> 64) | ((uint64_t)sum > 1);
}

/* Return the decimal of a number that is finite and greater than zero. */
static Decimal shortest(uint64_t bits, const Power *powers)
{
    uint64_t fraction = bits & ((UINT64_C(1) << 52) - 1), biased = bits >> 52;
    uint64_t c = biased ? fraction | UINT64_C(1) << 52 : fraction;
    int64_t q = (biased ? (int64_t)biased : 1) - 1075;
    int is_odd = c & 1; /* a bound that is halfway to the next number reads back as the even one */
    int is_near = fraction == 0 && biased > 1; /* the number below is half as far as that above */
    int64_t k = (q * 1262611 - (is_near ? 524031 : 0)) >> 22;
    int64_t h = q + floor_log2_of_power(-k) + 1;
    Power power = powers[-k - LEAST_POWER];
    uint64_t lower = scaled(power, (4 * c - 2 + is_near) << h) + is_odd;
    uint64_t value = scaled(power, (4 * c) << h);
    uint64_t upper = scaled(power, (4 * c + 2) << h) - is_odd;
    uint64_t s = value / 4, tenth = s / 10;
    if (tenth) {
        int below = lower <= 40 * tenth, above = 40 * tenth + 40 <= upper;
        if (below != above)
            return (Decimal){tenth + above, (int)k + 1};
    }
    int below = lower <= 4 * s, above = 4 * s + 4 <= upper;
    int is_up = below != above ? above : value > 4 * s + 2 || (value == 4 * s + 2 && (s & 1));
    return (Decimal){s + is_up, (int)k};
}

static char *with(char *out, const char *text)
{
    size_t length = strlen(text);
    memcpy(out, text, length);
    return out + length;
}

/* Eight digits at once are 32 bits, which are faster to divide. */
static char *with_digits(char *out, uint64_t digits)
{
    int count = 1;
    if (digits >= 100000000) {
        out = with_digits(out, digits / 100000000);
        count = 8;
    }
    uint32_t last = (uint32_t)(digits % 100000000);
    if (count == 1)
        for (uint32_t rest = last; rest >= 10; rest /= 10)
            count++;
    for (int i = count; i--; last /= 10)
        out[i] = (char)('0' + last % 10);
    return out + count;
}

static char *with_exponent(char *out, int exponent)
{
    out = with(out, exponent < 0 ? "e-" : "e+");
    unsigned size = (unsigned)(exponent < 0 ? -exponent : exponent);
    return with_digits(size < 10 ? with(out, "0") : out, size);
}

static char *with_number(char *out, double number, const Power *powers)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    if (number != number)
        return with(out, "nan");
    if (bits >> 63)
        *out++ = '-';
    bits &= ~(UINT64_C(1) << 63);
    if (bits == 0)
        return with(out, "0.0");
    if (bits == UINT64_C(0x7ff) << 52)
        return with(out, "inf");
    Decimal decimal = shortest(bits, powers);
    while (decimal.digits % 10 == 0) {
        decimal.digits /= 10;
        decimal.exponent++;
    }
    char digits[20];
    int count = (int)(with_digits(digits, decimal.digits) - digits);
    int before = count + decimal.exponent; /* digits before the point */
    if (before <= -4 || before > 16) {
        *out++ = digits[0];
        if (count > 1) {
            *out++ = '.';
            memcpy(out, digits + 1, (size_t)count - 1);
            out += count - 1;
        }
        return with_exponent(out, before - 1);
    }
    if (before <= 0) {
        out = with(out, "0.");
        for (; before < 0; before++)
            *out++ = '0';
        memcpy(out, digits, (size_t)count);
        return out + count;
    }
    for (int i = 0; i < before; i++)
        *out++ = i < count ? digits[i] : '0';
    *out++ = '.';
    if (before >= count)
        return with(out, "0");
    memcpy(out, digits + before, (size_t)(count - before));
    return out + count - before;
}

static char *with_whole(char *out, int64_t number)
{
    if (number < 0)
        *out++ = '-';
    return with_digits(out, number < 0 ? 0 - (uint64_t)number : (uint64_t)number);
}

/* Write rows, separated by commas, each with a line feed at its end; `ends` has where that is. A
   number takes up to 25 bytes with what follows it. Columns of `whole` have whole numbers. */
EXPORT void rows_as_text(const double *table, int64_t rows, int64_t columns, const uint8_t *whole,
                         const Power *powers, char *out, int64_t *ends)
{
    char *begun = out;
    for (int64_t row = 0; row < rows; row++) {
        for (int64_t column = 0; column < columns; column++) {
            double number = *table++;
            out = whole[column] ? with_whole(out, (int64_t)number)
                                : with_number(out, number, powers);
            *out++ = column + 1 < columns ? ',' : '\n';
        }
        ends[row] = out - begun;
    }
}
