/* Texts: printf, numbers as digits, String, Print and Stream. Costs in cycles as in api.cpp. */
#include "Arduino.h"
#include "machine.h"

using machine::charge;

#undef sprintf
#undef snprintf
#undef vsnprintf

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

char *dtostrf(double value, signed char width, unsigned char precision, char *to)
{
    charge(1500);
    sprintf(to, "%*.*f", width, precision, (double)(float)value);
    return to;
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

/* ------------------------------------------------------------------ texts */

String::String(long v, unsigned char base) { char b[68]; ltoa(v, b, base); text_ = b; }
String::String(unsigned long v, unsigned char base) { char b[68]; ultoa(v, b, base); text_ = b; }
String::String(double v, unsigned char decimals) { char b[80]; dtostrf(v, (signed char)(decimals + 2), decimals, b); text_ = b; }
bool String::equalsIgnoreCase(const String &other) const { return strcasecmp(c_str(), other.c_str()) == 0; }

String String::substring(unsigned from, unsigned to) const
{
    if (from > to) {
        unsigned other = from;
        from = to;
        to = other;
    }
    return from < length() ? String(text_.substr(from, to - from)) : String();
}

void String::replace(const String &from, const String &to)
{
    for (size_t at = 0; from.length() && (at = text_.find(from.text_, at)) != std::string::npos; at += to.length())
        text_.replace(at, from.length(), to.text_);
}

void String::trim()
{
    size_t first = text_.find_first_not_of(" \t\r\n\f\v"), last = text_.find_last_not_of(" \t\r\n\f\v");
    text_ = first == std::string::npos ? "" : text_.substr(first, last - first + 1);
}

void String::toCharArray(char *to, unsigned size, unsigned from) const
{
    if (!size)
        return;
    std::string part = from < text_.size() ? text_.substr(from, size - 1) : "";
    memcpy(to, part.c_str(), part.size() + 1);
}

/* ------------------------------------------------------------------ Print and Stream */

size_t Print::write(const uint8_t *data, size_t size)
{
    for (size_t i = 0; i < size; i++)
        write(data[i]);
    return size;
}

size_t Print::print(long v, int base)
{
    if (base == 0)
        return write((uint8_t)v);
    if (base == 10 && v < 0)
        return write('-') + print((unsigned long)(uint32_t)-v, 10);
    return print((unsigned long)(uint32_t)v, base);
}

size_t Print::print(unsigned long v, int base)
{
    if (base == 0)
        return write((uint8_t)v);
    char digits[68];
    based((uint32_t)v, false, digits, base < 2 ? 10 : base);
    for (char *c = digits; *c; c++)
        *c = (char)toupper(*c);
    charge(300);
    return write(digits);
}

/* In single precision, as the board does it. */
size_t Print::print(double value, int digits)
{
    float v = (float)value;
    if (isnan(v))
        return write("nan");
    if (isinf(v))
        return write("inf");
    if (v > 4294967040.0f || v < -4294967040.0f)
        return write("ovf");
    charge(1500);
    size_t n = 0;
    if (v < 0.0f) {
        n += write('-');
        v = -v;
    }
    float rounding = 0.5f;
    for (int i = 0; i < digits; i++)
        rounding /= 10.0f;
    v += rounding;
    uint32_t whole = (uint32_t)v;
    float rest = v - (float)whole;
    n += print((unsigned long)whole);
    if (digits > 0)
        n += write('.');
    for (; digits > 0; digits--) {
        rest *= 10.0f;
        unsigned digit = (unsigned)rest;
        n += print(digit);
        rest -= (float)digit;
    }
    return n;
}

int Stream::timedRead()
{
    uint64_t latest = machine::now + timeout_ * 16000ull;
    for (;;) {
        int c = read();
        if (c >= 0 || machine::now >= latest)
            return c;
        machine::pass_until(latest, true);
    }
}

int Stream::timedPeek()
{
    uint64_t latest = machine::now + timeout_ * 16000ull;
    for (;;) {
        int c = peek();
        if (c >= 0 || machine::now >= latest)
            return c;
        machine::pass_until(latest, true);
    }
}

size_t Stream::readBytes(char *to, size_t size)
{
    size_t n = 0;
    for (int c; n < size && (c = timedRead()) >= 0;)
        to[n++] = (char)c;
    return n;
}

size_t Stream::readBytesUntil(char end, char *to, size_t size)
{
    size_t n = 0;
    for (int c; n < size && (c = timedRead()) >= 0 && (char)c != end;)
        to[n++] = (char)c;
    return n;
}

String Stream::readString()
{
    String text;
    for (int c; (c = timedRead()) >= 0;)
        text += (char)c;
    return text;
}

String Stream::readStringUntil(char end)
{
    String text;
    for (int c; (c = timedRead()) >= 0 && (char)c != end;)
        text += (char)c;
    return text;
}

int Stream::peekNumber(bool dot)
{
    for (;;) {
        int c = timedPeek();
        if (c < 0 || c == '-' || isdigit(c) || (dot && c == '.'))
            return c;
        read();
    }
}

int32_t Stream::parseInt() { return (int32_t)parseFloat(); }

float Stream::parseFloat()
{
    std::string digits;
    int c = peekNumber(true);
    if (c < 0)
        return 0.0f;
    do {
        digits += (char)read();
        c = timedPeek();
    } while (isdigit(c) || c == '.');
    return (float)atof(digits.c_str());
}

bool Stream::find(const char *what)
{
    size_t matched = 0;
    while (what[matched]) {
        int c = timedRead();
        if (c < 0)
            return false;
        matched = c == what[matched] ? matched + 1 : (c == what[0]);
    }
    return true;
}
