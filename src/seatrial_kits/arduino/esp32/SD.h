/* The library SD of Arduino-ESP32: a card in the folder `sd` of the flash, whatever its pins. */
#ifndef SD_H
#define SD_H

#include "FS.h"
#include "SPI.h"

typedef enum { CARD_NONE, CARD_MMC, CARD_SD, CARD_SDHC, CARD_UNKNOWN } sdcard_type_t;

namespace fs {

class SDFS : public FS {
public:
    using FS::FS;
    bool begin(uint8_t = 5, SPIClass & = SPI, uint32_t = 4000000, const char * = "/sd", uint8_t = 5, bool = false) { return FS::begin(); }
    sdcard_type_t cardType() { return CARD_SDHC; }
    uint64_t cardSize() { return 32ull << 20; }
    uint64_t totalBytes() { return cardSize(); }
};

class SDMMCFS : public SDFS {
public:
    using SDFS::SDFS;
    bool setPins(int, int, int, int = -1, int = -1, int = -1) { return true; }
    bool begin(const char * = "/sdcard", bool = false, bool = false, int = 20000, uint8_t = 5) { return FS::begin(); }
};

} // namespace fs

extern fs::SDFS SD;
extern fs::SDMMCFS SD_MMC;

#endif
