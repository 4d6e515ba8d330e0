/* What avr-libc has otherwise than a computer's C library, or alone: an int has 16 bits, a long 32. */
#include "Arduino.h"
#include "machine.h"

using machine::charge;

/* ------------------------------------------------------------------ printf and scanf */

#undef sprintf
#undef snprintf
#undef vsnprintf
#undef qsort
#undef bsearch

int sketch_vsnprintf(char *to, size_t size, const char *format, va_list values)
{
    std::string out;
    char piece[128];
    for (; *format; format++) {
        if (*format != '%') {
            out += *format;
            continue;
        }
        std::string conversion = "%";
        int length = 0;
        for (format++; *format && strchr("-+ #0123456789.*lh", *format); format++) {
            if (*format == 'l' || *format == 'h')
                length += *format == 'l';
            else if (*format == '*')
                conversion += std::to_string(va_arg(values, int));
            else
                conversion += *format;
        }
        if (!*format)
            break;
        conversion += *format == 'S' ? 's' : *format;
        const char *form = conversion.c_str();
        *piece = 0;
        if (*format == 'd' || *format == 'i') {
            int v = va_arg(values, int);
            snprintf(piece, sizeof piece, form, length ? v : (int16_t)v);
        } else if (strchr("uxXo", *format)) {
            unsigned v = va_arg(values, unsigned);
            snprintf(piece, sizeof piece, form, length ? v : (uint16_t)v);
        } else if (*format == 'c') {
            snprintf(piece, sizeof piece, form, va_arg(values, int));
        } else if (*format == 's' || *format == 'S') {
            const char *text = va_arg(values, const char *);
            std::string whole(strlen(text) + 512, 0);
            snprintf(&whole[0], whole.size(), form, text);
            out += whole.c_str();
        } else if (strchr("feEgG", *format)) {
            (void)va_arg(values, double);
            /* avr-libc's printf has no floating point unless it is linked in */
            conversion = conversion.substr(0, conversion.find('.'));
            if (isalpha(conversion.back()))
                conversion.pop_back();
            snprintf(piece, sizeof piece, (conversion + "s").c_str(), "?");
        } else if (*format == '%') {
            strcpy(piece, "%");
        }
        out += piece;
    }
    charge((uint32_t)(200 + 20 * out.size()));
    if (size) {
        size_t n = out.size() < size - 1 ? out.size() : size - 1;
        memcpy(to, out.data(), n);
        to[n] = 0;
    }
    return (int)out.size();
}

static int (*put_on_stdout)(char c, FILE *to);

FILE *fdevopen(int (*put)(char c, FILE *to), int (*)(FILE *))
{
    put_on_stdout = put;
    return stdout;
}

int sketch_printf(const char *format, ...)
{
    char text[1024];
    va_list values;
    va_start(values, format);
    int size = sketch_vsnprintf(text, sizeof text, format, values);
    va_end(values);
    for (char *c = text; put_on_stdout && *c; c++)
        put_on_stdout(*c, stdout);
    return put_on_stdout ? size : -1;
}

int sketch_snprintf(char *to, size_t size, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    int n = sketch_vsnprintf(to, size, format, values);
    va_end(values);
    return n;
}

int sketch_sprintf(char *to, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    int n = sketch_vsnprintf(to, 4096, format, values);
    va_end(values);
    return n;
}

/* The format with the widths of the computer's types; it ends before a floating point conversion,
   which avr-libc's scanf does not have unless it is linked in. */
static std::string widened(const char *format)
{
    std::string out;
    while (*format) {
        if (*format != '%' || format[1] == '%') {
            out.append(format, *format == '%' ? 2 : 1);
            format += *format == '%' ? 2 : 1;
            continue;
        }
        std::string conversion(1, *format++);
        bool shorter = true;
        for (; *format && strchr("*0123456789lh", *format); format++) {
            shorter = shorter && *format != 'l' && *format != 'h';
            if (*format != 'l')
                conversion += *format;
        }
        if (!*format || strchr("feEgG", *format))
            break;
        if (shorter && strchr("diuoxXn", *format))
            conversion += 'h';
        out += conversion + *format++;
        if (out.back() == '[')
            for (bool first = true; *format && (first || *format != ']'); first = first && *format == '^')
                out += *format++;
    }
    return out;
}

int sketch_sscanf(const char *text, const char *format, ...)
{
    charge((uint32_t)(200 + 20 * strlen(text)));
    va_list values;
    va_start(values, format);
    int n = vsscanf(text, widened(format).c_str(), values);
    va_end(values);
    return n;
}

/* ------------------------------------------------------------------ numbers as digits */

/* A value's first digits, at most eight, rounded half up; it is 0.DIGITS times ten to the `power`.
   `from_point` is whether `count` are wanted after the point, or in all. */
static std::string digits_of(double value, int count, bool from_point, int &power)
{
    char exact[80];
    snprintf(exact, sizeof exact, "%.60e", fabs(value));
    std::string all = exact[0] + std::string(exact + 2, 60);
    power = atoi(strchr(exact, 'e') + 1) + 1;
    int kept = from_point ? count + power : count;
    if (kept < 0)
        return "";
    kept = kept > 8 ? 8 : kept;
    bool up = all[(size_t)kept] >= '5';
    std::string digits = "0" + all.substr(0, (size_t)kept);
    for (size_t at = digits.size(); up; digits[at] = up ? '0' : (char)(digits[at] + 1))
        up = digits[--at] == '9';
    if (digits[0] == '0')
        return digits.substr(1);
    power++;
    return digits;
}

static char *padded(std::string text, int width, char *to)
{
    size_t least = (size_t)abs(width);
    if (text.size() < least)
        text.insert(width < 0 ? text.size() : 0, least - text.size(), ' ');
    return strcpy(to, text.c_str());
}

char *dtostrf(double value, signed char width, unsigned char precision, char *to)
{
    charge(1500);
    std::string sign = signbit(value) ? "-" : "";
    if (!isfinite(value))
        return padded(isnan(value) ? "NAN" : sign + "INF", width, to);
    int power;
    std::string digits = digits_of(value, precision, true, power);
    int places = (int)digits.size() - power; /* of them after the point; less than none: zeros before it */
    if (places < 0)
        digits.append((size_t)-places, '0'), places = 0;
    if ((int)digits.size() <= places)
        digits.insert(0, (size_t)places + 1 - digits.size(), '0');
    std::string text = sign + digits.substr(0, digits.size() - (size_t)places);
    digits = digits.substr(digits.size() - (size_t)places);
    digits.resize(precision, '0');
    return padded(precision ? text + "." + digits : text, width, to);
}

static char *based(uint64_t value, bool negative, char *to, int base)
{
    char digits[68], *at = digits + sizeof digits;
    *--at = 0;
    do
        *--at = "0123456789abcdefghijklmnopqrstuvwxyz"[value % (unsigned)base];
    while (value /= (unsigned)base);
    if (negative)
        *--at = '-';
    return strcpy(to, at);
}

char *ultoa(unsigned long value, char *to, int base) { charge(300); return based((uint32_t)value, false, to, base); }
char *utoa(unsigned value, char *to, int base) { charge(200); return based((uint16_t)value, false, to, base); }

char *ltoa(long value, char *to, int base)
{
    bool negative = base == 10 && value < 0;
    charge(300);
    return based(negative ? (uint32_t)-value : (uint32_t)value, negative, to, base);
}

char *itoa(int value, char *to, int base)
{
    bool negative = base == 10 && value < 0;
    charge(200);
    return based(negative ? (uint16_t)-value : (uint16_t)value, negative, to, base);
}

char *dtostre(double value, char *to, unsigned char precision, unsigned char flags)
{
    charge(1500);
    int power;
    std::string digits = digits_of(value, (precision > 7 ? 7 : precision) + 1, false, power);
    std::string text = signbit(value) ? "-" : flags & DTOSTR_PLUS_SIGN ? "+" : flags & DTOSTR_ALWAYS_SIGN ? " " : "";
    text += digits[0];
    if (precision)
        text += "." + digits.substr(1, precision > 7 ? 7 : precision);
    char exponent[8];
    sprintf(exponent, "%c%+03d", flags & DTOSTR_UPPERCASE ? 'E' : 'e', value == 0.0 ? 0 : power - 1);
    return strcpy(to, (text + exponent).c_str());
}

/* ------------------------------------------------------------------ strings */

char *strrev(char *text)
{
    for (char *a = text, *b = text + strlen(text); a < b;) {
        char c = *a;
        *a++ = *--b;
        *b = c;
    }
    return text;
}

/* ------------------------------------------------------------------ search and chance */

static sketch_comparison compare_with;
static int compare(const void *a, const void *b) { return compare_with(a, b); }

void sketch_qsort(void *base, size_t count, size_t size, sketch_comparison with)
{
    compare_with = with;
    qsort(base, count, size, compare);
}

void *sketch_bsearch(const void *key, const void *base, size_t count, size_t size, sketch_comparison with)
{
    compare_with = with;
    return bsearch(key, base, count, size, compare);
}

/* Park and Miller's minimal standard. */
static uint32_t next_of(uint32_t &state)
{
    int32_t x = (int32_t)(state ? state : 123459876);
    x = 16807 * (x % 127773) - 2836 * (x / 127773);
    if (x < 0)
        x += 0x7fffffff;
    return state = (uint32_t)x;
}

static uint32_t random_state = 1, rand_state = 1;

int16_t sketch_rand() { charge(600); return (int16_t)(next_of(rand_state) % 32768); }
void sketch_srand(uint16_t seed) { rand_state = seed; }
int32_t random() { charge(600); return (int32_t)(next_of(random_state) % 0x80000000u); }
int32_t random(int32_t most) { return most ? random() % most : 0; }
int32_t random(int32_t least, int32_t most) { return least >= most ? least : least + random(most - least); }
void randomSeed(uint32_t seed) { if (seed) random_state = seed; }
