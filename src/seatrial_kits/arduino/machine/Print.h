/* Print: everything that takes text. */
#ifndef Print_h
#define Print_h

#include "WString.h"

#define DEC 10

class Print;
class Printable {
public:
    virtual ~Printable() {}
    virtual size_t printTo(Print &to) const = 0;
};

class Print {
public:
    virtual ~Print() {}
    virtual size_t write(uint8_t data) = 0;
    virtual size_t write(const uint8_t *data, size_t size);
    virtual int availableForWrite() { return 0; }
    virtual void flush() {}
    size_t write(const char *text) { return text ? write((const uint8_t *)text, strlen(text)) : 0; }
    size_t write(const char *data, size_t size) { return write((const uint8_t *)data, size); }

    size_t print(const __FlashStringHelper *text) { return write((const char *)text); }
    size_t print(const String &text) { return write(text.c_str(), text.length()); }
    size_t print(const char *text) { return write(text); }
    size_t print(char c) { return write((uint8_t)c); }
    size_t print(unsigned char v, int base = DEC) { return print((unsigned long)v, base); }
    size_t print(short v, int base = DEC) { return print((long)v, base); }
    size_t print(unsigned short v, int base = DEC) { return print((unsigned long)v, base); }
    size_t print(int v, int base = DEC) { return print((long)v, base); }
    size_t print(unsigned v, int base = DEC) { return print((unsigned long)v, base); }
    size_t print(long v, int base = DEC);
    size_t print(unsigned long v, int base = DEC);
    size_t print(double v, int digits = 2);
    size_t print(const Printable &what) { return what.printTo(*this); }
#ifdef ESP32
    size_t print(long long v, int base = DEC);
    size_t print(unsigned long long v, int base = DEC);
    size_t printf(const char *format, ...) __attribute__((format(printf, 2, 3)));
#endif

    size_t println() { return write("\r\n"); }
    template <typename T> size_t println(const T &what) { size_t n = print(what); return n + println(); }
    template <typename T> size_t println(const T &what, int how) { size_t n = print(what, how); return n + println(); }
    sketch_int getWriteError() { return write_error_; }
    void clearWriteError() { write_error_ = 0; }

protected:
    void setWriteError(int error = 1) { write_error_ = (sketch_int)error; }

private:
    sketch_int write_error_ = 0;
};

#endif
