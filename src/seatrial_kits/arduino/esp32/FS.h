/* File systems in the flash: folders of the computer. */
#ifndef FS_H
#define FS_H

#include <memory>

#include "Arduino.h"

#define FILE_READ "r"
#define FILE_WRITE "w"
#define FILE_APPEND "a"

namespace fs {

enum SeekMode { SeekSet, SeekCur, SeekEnd };

class File : public Stream {
public:
    File() {}
    size_t write(uint8_t data) override { return write(&data, 1); }
    size_t write(const uint8_t *data, size_t size) override;
    using Print::write;
    int available() override;
    int read() override;
    int peek() override;
    void flush() override;
    size_t read(uint8_t *to, size_t size);
    bool seek(uint32_t to, SeekMode mode = SeekSet);
    size_t position() const;
    size_t size() const;
    time_t getLastWrite() const { return 0; } /* the calendar is not set */
    void close() { open_.reset(); }
    operator bool() const { return open_ != nullptr; }
    const char *name() const;
    const char *path() const;
    bool isDirectory() const;
    File openNextFile(const char *mode = FILE_READ);
    void rewindDirectory();

private:
    friend class FS;
    struct Open;
    std::shared_ptr<Open> open_;
};

class FS {
public:
    explicit FS(const char *name) : name_(name) {}
    bool begin(bool format = false, const char * = "", uint8_t = 10, const char * = "");
    void end() {}
    bool format();
    size_t totalBytes() { return 1441792; }
    size_t usedBytes();
    File open(const char *path, const char *mode = FILE_READ, bool create = false);
    File open(const String &path, const char *mode = FILE_READ, bool create = false) { return open(path.c_str(), mode, create); }
    bool exists(const char *path);
    bool exists(const String &path) { return exists(path.c_str()); }
    bool remove(const char *path);
    bool remove(const String &path) { return remove(path.c_str()); }
    bool rename(const char *from, const char *to);
    bool rename(const String &from, const String &to) { return rename(from.c_str(), to.c_str()); }
    bool mkdir(const char *path);
    bool mkdir(const String &path) { return mkdir(path.c_str()); }
    bool rmdir(const char *path) { return remove(path); }
    bool rmdir(const String &path) { return remove(path); }

private:
    std::string place(const char *path) const;
    const char *name_;
};

} // namespace fs

using fs::File;
using fs::FS;
using fs::SeekCur;
using fs::SeekEnd;
using fs::SeekSet;

#endif
