/* Updates of the program over the network: a board without a partition for them, which refuses each. */
#ifndef UPDATE_H
#define UPDATE_H

#include <functional>

#include "Arduino.h"

#define UPDATE_SIZE_UNKNOWN 0xFFFFFFFF
#define UPDATE_ERROR_NO_PARTITION 10
#define U_FLASH 0
#define U_SPIFFS 100

class UpdateClass {
public:
    bool begin(size_t = UPDATE_SIZE_UNKNOWN, int = U_FLASH, int = -1, uint8_t = LOW, const char * = nullptr) { return false; }
    size_t write(uint8_t *, size_t) { return 0; }
    size_t writeStream(Stream &) { return 0; }
    bool end(bool = false) { return false; }
    void abort() {}
    bool setMD5(const char *) { return true; }
    bool hasError() { return true; }
    bool isFinished() { return false; }
    bool isRunning() { return false; }
    uint8_t getError() { return UPDATE_ERROR_NO_PARTITION; }
    const char *errorString() { return "Partition Could Not be Found"; }
    void printError(Print &to) { to.println(errorString()); }
    size_t size() { return 0; }
    size_t progress() { return 0; }
    UpdateClass &onProgress(std::function<void(size_t, size_t)>) { return *this; }
};

inline UpdateClass Update;

#endif
