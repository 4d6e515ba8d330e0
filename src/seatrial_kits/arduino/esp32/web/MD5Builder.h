/* MD5 (RFC 1321), by the functions that libraries call. */
#ifndef MD5BUILDER_H
#define MD5BUILDER_H

#include "Arduino.h"

class MD5Builder {
public:
    void begin() { all_.clear(); }
    void add(const uint8_t *data, size_t size) { all_.append((const char *)data, size); }
    void add(const char *text) { all_ += text; }
    void add(const String &text) { all_ += text.c_str(); }
    void calculate();
    void getBytes(uint8_t *to) { memcpy(to, sum_, sizeof sum_); }
    void getChars(char *to);
    String toString() { char text[33]; getChars(text); return text; }

private:
    std::string all_;
    uint8_t sum_[16];
};

#endif
