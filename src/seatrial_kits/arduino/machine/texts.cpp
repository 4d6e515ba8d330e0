/* Texts: String, Print and Stream. Costs in cycles as in api.cpp. */
#include "Arduino.h"
#include "machine.h"

using machine::charge;

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
    return write(strupr(ultoa(v, digits, base < 2 ? 10 : base)));
}

/* In the board's precision. */
size_t Print::print(double value, int digits)
{
    sketch_real v = (sketch_real)value;
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
    sketch_real rounding = 0.5f;
    for (int i = 0; i < digits; i++)
        rounding /= 10.0f;
    v += rounding;
    uint32_t whole = (uint32_t)v;
    sketch_real rest = v - (sketch_real)whole;
    n += print((unsigned long)whole);
    if (digits > 0)
        n += write('.');
    for (; digits > 0; digits--) {
        rest *= 10.0f;
        unsigned digit = (unsigned)rest;
        n += print(digit);
        rest -= (sketch_real)digit;
    }
    return n;
}

#ifdef ESP32
size_t Print::print(long long v, int base)
{
    char digits[68];
    return write(lltoa(v, digits, base));
}

size_t Print::print(unsigned long long v, int base)
{
    char digits[68];
    return write(strupr(ulltoa(v, digits, base)));
}

size_t Print::printf(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    char *text = nullptr;
    int size = vasprintf(&text, format, values);
    va_end(values);
    size_t n = size < 0 ? 0 : write((const uint8_t *)text, (size_t)size);
    free(text);
    return n;
}

String::String(long long v, unsigned char base) { char b[68]; text_ = lltoa(v, b, base); }
String::String(unsigned long long v, unsigned char base) { char b[68]; text_ = ulltoa(v, b, base); }
#endif

int Stream::timedRead()
{
    uint64_t latest = machine::now + timeout_ * 16000ull;
    for (;;) {
        int c = read();
        if (c >= 0 || machine::now >= latest)
            return c;
        machine::wait(latest);
    }
}

int Stream::timedPeek()
{
    uint64_t latest = machine::now + timeout_ * 16000ull;
    for (;;) {
        int c = peek();
        if (c >= 0 || machine::now >= latest)
            return c;
        machine::wait(latest);
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
    for (int c; n < size && (c = timedRead()) >= 0 && c != end;)
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
    for (int c; (c = timedRead()) >= 0 && c != end;)
        text += (char)c;
    return text;
}

/* The first character of a number, unless what must not be skipped comes before it: then -1. */
int Stream::peekNextDigit(LookaheadMode skip, bool dot)
{
    for (;;) {
        int c = timedPeek();
        if (c < 0 || c == '-' || isdigit(c) || (dot && c == '.'))
            return c;
        if (skip == SKIP_NONE || (skip == SKIP_WHITESPACE && !(c && strchr(" \t\r\n", c))))
            return -1;
        read();
    }
}

/* Digits as an integer, and the power of ten that they are to be divided by. */
int32_t Stream::number(LookaheadMode skip, char ignore, bool dot, int &places)
{
    uint32_t value = 0;
    bool negative = false, point = false;
    places = 0;
    int c = peekNextDigit(skip, dot);
    if (c < 0)
        return 0;
    do {
        if (c == '-') {
            negative = true;
        } else if (c == '.') {
            point = true;
        } else if (c != ignore) {
            value = value * 10 + (uint32_t)(c - '0');
            places += point;
        }
        read();
        c = timedPeek();
    } while ((c >= 0 && isdigit(c)) || (dot && !point && c == '.') || c == ignore);
    return (int32_t)(negative ? -value : value);
}

int32_t Stream::parseInt(LookaheadMode skip, char ignore)
{
    int places;
    return number(skip, ignore, false, places);
}

float Stream::parseFloat(LookaheadMode skip, char ignore)
{
    int places;
    float value = (float)number(skip, ignore, true, places), scale = 1.0f;
    for (; places; places--)
        scale *= 0.1f;
    return value * scale;
}

bool Stream::findUntil(const char *what, size_t size, const char *end, size_t end_size)
{
    std::string target(what, size), terminator(end ? end : "", end ? end_size : 0), seen;
    auto ends_with = [&](const std::string &t) { return seen.size() >= t.size() && !seen.compare(seen.size() - t.size(), t.size(), t); };
    if (target.empty())
        return true;
    if (end && terminator.empty())
        return false;
    for (int c; (c = timedRead()) >= 0;) {
        seen += (char)c;
        if (ends_with(target))
            return true;
        if (end && ends_with(terminator))
            return false;
    }
    return false;
}
