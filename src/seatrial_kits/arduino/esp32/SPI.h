/* SPI, as its master, at any pins; where no part is selected, it reads 0xFF. */
#ifndef _SPI_H_INCLUDED
#define _SPI_H_INCLUDED

#include "Arduino.h"

#define SPI_MODE0 0
#define SPI_MODE1 1
#define SPI_MODE2 2
#define SPI_MODE3 3
#define SPI_LSBFIRST 0
#define SPI_MSBFIRST 1
#define SPI_HAS_TRANSACTION
#define FSPI 0
#define HSPI 2
#define VSPI 3
#define SPI_CLOCK_DIV2 0x00101001
#define SPI_CLOCK_DIV4 0x00241001
#define SPI_CLOCK_DIV8 0x004c1001
#define SPI_CLOCK_DIV16 0x009c1001

struct SPISettings {
    SPISettings(uint32_t hertz = 1000000, uint8_t = MSBFIRST, uint8_t = SPI_MODE0) : _clock(hertz) {}
    uint32_t _clock;
};

class SPIClass {
public:
    explicit SPIClass(uint8_t = VSPI) {}
    void begin(int8_t = -1, int8_t = -1, int8_t = -1, int8_t = -1) {}
    void end() {}
    void setHwCs(bool) {}
    void beginTransaction(SPISettings settings) { clock_ = settings._clock; }
    void endTransaction() {}
    void setFrequency(uint32_t hertz) { clock_ = hertz; }
    void setClockDivider(uint32_t) {}
    void setBitOrder(uint8_t) {}
    void setDataMode(uint8_t) {}
    uint8_t transfer(uint8_t data);
    uint16_t transfer16(uint16_t data) { uint16_t high = transfer((uint8_t)(data >> 8)); return (uint16_t)(high << 8 | transfer((uint8_t)data)); }
    uint32_t transfer32(uint32_t data) { uint32_t high = transfer16((uint16_t)(data >> 16)); return high << 16 | transfer16((uint16_t)data); }
    void transfer(void *data, uint32_t size) { transferBytes((uint8_t *)data, (uint8_t *)data, size); }
    void transferBytes(const uint8_t *data, uint8_t *out, uint32_t size);
    void write(uint8_t data) { transfer(data); }
    void write16(uint16_t data) { transfer16(data); }
    void write32(uint32_t data) { transfer32(data); }
    void writeBytes(const uint8_t *data, uint32_t size) { transferBytes(data, nullptr, size); }

private:
    uint32_t clock_ = 1000000;
};

extern SPIClass SPI;

#endif
