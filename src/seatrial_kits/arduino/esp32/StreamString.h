/* A text that is written and read as a stream. */
#ifndef STREAMSTRING_H
#define STREAMSTRING_H

#include "Stream.h"
#include "WString.h"

class StreamString : public Stream, public String {
public:
    size_t write(const uint8_t *data, size_t size) override
    {
        for (size_t each = 0; each < size; each++)
            concat((char)data[each]);
        return size;
    }
    size_t write(uint8_t data) override { return write(&data, 1); }
    using Print::write;
    int available() override { return (int)length(); }
    int read() override
    {
        int first = peek();
        if (first >= 0)
            remove(0, 1);
        return first;
    }
    int peek() override { return length() ? (uint8_t)charAt(0) : -1; }
};

#endif
