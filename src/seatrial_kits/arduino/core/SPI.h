/* SPI, as its master; where no part is selected, it reads 0xFF. */
#ifndef SPI_h
#define SPI_h

#include "Arduino.h"

#pragma pack(push)
#pragma pack()

#define SPI_MODE0 0x00
#define SPI_MODE1 0x04
#define SPI_MODE2 0x08
#define SPI_MODE3 0x0C
#define SPI_HAS_TRANSACTION 1
#define SPI_CLOCK_DIV2 2
#define SPI_CLOCK_DIV4 4
#define SPI_CLOCK_DIV8 8
#define SPI_CLOCK_DIV16 16
#define SPI_CLOCK_DIV32 32
#define SPI_CLOCK_DIV64 64
#define SPI_CLOCK_DIV128 128

struct SPISettings {
    SPISettings(uint32_t hertz = 4000000, uint8_t order = MSBFIRST, uint8_t mode = SPI_MODE0)
        : clock(hertz) { (void)order; (void)mode; }
    uint32_t clock;
};

class SPIClass {
public:
    void begin() {}
    void end() {}
    void beginTransaction(SPISettings settings) { clock_ = settings.clock; }
    void endTransaction() {}
    void usingInterrupt(uint8_t) {}
    void notUsingInterrupt(uint8_t) {}
    void setClockDivider(uint8_t divider) { clock_ = F_CPU / divider; }
    void setBitOrder(uint8_t) {}
    void setDataMode(uint8_t) {}
    uint8_t transfer(uint8_t data);
    uint16_t transfer16(uint16_t data) { uint16_t high = transfer((uint8_t)(data >> 8)); return (uint16_t)(high << 8 | transfer((uint8_t)data)); }
    void transfer(void *data, size_t size) { for (size_t i = 0; i < size; i++) ((uint8_t *)data)[i] = transfer(((uint8_t *)data)[i]); }

private:
    uint32_t clock_ = 4000000;
};

extern SPIClass SPI;

#pragma pack(pop)

#endif
