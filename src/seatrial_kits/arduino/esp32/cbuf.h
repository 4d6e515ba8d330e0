/* A ring of bytes, as libraries take Arduino-ESP32's. */
#ifndef CBUF_H
#define CBUF_H

#include <stddef.h>
#include <string.h>

#include <algorithm>
#include <string>

class cbuf {
public:
    explicit cbuf(size_t size) : most_(size) {}
    size_t resizeAdd(size_t more) { return most_ += more; }
    size_t resize(size_t size) { return most_ = std::max(size, all_.size()); }
    size_t available() const { return all_.size(); }
    size_t size() const { return most_; }
    size_t room() const { return most_ - all_.size(); }
    bool empty() const { return all_.empty(); }
    bool full() const { return !room(); }
    int peek() const { return all_.empty() ? -1 : (unsigned char)all_[0]; }
    int read() { int c = peek(); remove(1); return c; }
    size_t read(char *to, size_t size) { size = std::min(size, all_.size()); memcpy(to, all_.data(), size); remove(size); return size; }
    size_t write(char c) { return write(&c, 1); }
    size_t write(const char *from, size_t size) { size = std::min(size, room()); all_.append(from, size); return size; }
    void flush() { all_.clear(); }
    size_t remove(size_t size) { all_.erase(0, size); return all_.size(); }

private:
    std::string all_;
    size_t most_;
};

#endif
