/* Stream: everything that text comes from; what waits does so in simulated time. */
#ifndef Stream_h
#define Stream_h

#include "Print.h"

enum LookaheadMode { SKIP_ALL, SKIP_NONE, SKIP_WHITESPACE };
#define NO_IGNORE_CHAR '\x01'

class Stream : public Print {
public:
    virtual sketch_int available() = 0;
    virtual sketch_int read() = 0;
    virtual sketch_int peek() = 0;
    void setTimeout(uint32_t ms) { timeout_ = ms; }
    uint32_t getTimeout() const { return timeout_; }
    size_t readBytes(char *to, size_t size);
    size_t readBytes(uint8_t *to, size_t size) { return readBytes((char *)to, size); }
    size_t readBytesUntil(char end, char *to, size_t size);
    size_t readBytesUntil(char end, uint8_t *to, size_t size) { return readBytesUntil(end, (char *)to, size); }
    String readString();
    String readStringUntil(char end);
    int32_t parseInt(LookaheadMode skip = SKIP_ALL, char ignore = NO_IGNORE_CHAR);
    float parseFloat(LookaheadMode skip = SKIP_ALL, char ignore = NO_IGNORE_CHAR);
    bool find(char what) { return find(&what, 1); }
    bool find(const char *what) { return find(what, strlen(what)); }
    bool find(const char *what, size_t size) { return findUntil(what, size, nullptr, 0); }
    bool findUntil(const char *what, const char *end) { return findUntil(what, strlen(what), end, strlen(end)); }
    bool findUntil(const char *what, size_t size, const char *end, size_t end_size);

protected:
    int timedRead();
    int timedPeek();
    int peekNextDigit(LookaheadMode skip, bool dot);
    int32_t number(LookaheadMode skip, char ignore, bool dot, int &places);
    uint32_t timeout_ = 1000;
};

#endif
