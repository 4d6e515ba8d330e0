/* Stream: everything that text comes from; what waits does so in simulated time. */
#ifndef Stream_h
#define Stream_h

#include "Print.h"

class Stream : public Print {
public:
    virtual int16_t available() = 0;
    virtual int16_t read() = 0;
    virtual int16_t peek() = 0;
    void setTimeout(uint32_t ms) { timeout_ = ms; }
    uint32_t getTimeout() const { return timeout_; }
    size_t readBytes(char *to, size_t size);
    size_t readBytes(uint8_t *to, size_t size) { return readBytes((char *)to, size); }
    size_t readBytesUntil(char end, char *to, size_t size);
    size_t readBytesUntil(char end, uint8_t *to, size_t size) { return readBytesUntil(end, (char *)to, size); }
    String readString();
    String readStringUntil(char end);
    int32_t parseInt();
    float parseFloat();
    bool find(const char *what);

protected:
    int timedRead();
    int timedPeek();
    int peekNumber(bool dot);
    uint32_t timeout_ = 1000;
};

#endif
