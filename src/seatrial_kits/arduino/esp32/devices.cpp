/* What hangs on the board: Serial, SoftwareSerial, Bluetooth, Wire, SPI, EEPROM. Costs as in api.cpp. */
#include "Arduino.h"
#ifdef BOARD_ESP32
#include "BluetoothSerial.h"
#endif
#include "EEPROM.h"
#include "SPI.h"
#include "SoftwareSerial.h"
#include "Wire.h"
#include "machine.h"

extern "C" int part_link_begin(uint8_t address, int reading);
extern "C" int part_link_write(uint8_t data);
extern "C" uint8_t part_link_read();
extern "C" uint8_t part_link_transfer(uint8_t data);

using machine::charge;

/* ------------------------------------------------------------------ Serial */

HardwareSerial Serial(0), Serial1(1);
#ifndef BOARD_ESP32C3
HardwareSerial Serial2(2);
#endif

/* The line that is wired to a pin, or the UART's own if none of its pins is named in the profile. */
static int line_at(int number, int found, bool placed) { return found >= 0 ? found : placed ? -1 : number; }

void HardwareSerial::begin(unsigned long baud, uint32_t, int8_t rx, int8_t tx, bool, unsigned long, uint8_t)
{
    charge(800);
    const int8_t usual[][2] = {{RX, TX}, {9, 10}, {16, 17}, {-1, -1}};
    rx_ = rx >= 0 ? rx : rx_ >= 0 ? rx_ : usual[number_][0];
    tx_ = tx >= 0 ? tx : tx_ >= 0 ? tx_ : usual[number_][1];
    from_ = line_at(number_, machine::line_to(rx_), machine::placed(number_, true));
    to_ = line_at(number_, machine::line_from(tx_), machine::placed(number_, false));
    updateBaudRate(baud);
}

void HardwareSerial::updateBaudRate(unsigned long baud)
{
    baud_ = baud;
    for (int each : {from_, to_ == from_ ? -1 : to_})
        if (each >= 0)
            machine::open_uart((uint8_t)each, baud);
}

void HardwareSerial::end() { if (baud_) { flush(); updateBaudRate(0); } }
int HardwareSerial::available() { charge(12); return from_ >= 0 ? machine::received((uint8_t)from_) : 0; }
int HardwareSerial::read() { charge(12); return from_ >= 0 ? machine::take((uint8_t)from_, false) : -1; }
int HardwareSerial::peek() { charge(12); return from_ >= 0 ? machine::take((uint8_t)from_, true) : -1; }
int HardwareSerial::availableForWrite() { charge(12); return to_ >= 0 ? machine::room((uint8_t)to_) : board::SENT; }
void HardwareSerial::flush() { charge(12); if (to_ >= 0) machine::drain((uint8_t)to_); }

size_t HardwareSerial::read(uint8_t *to, size_t size)
{
    size_t n = 0;
    for (int c; n < size && (c = read()) >= 0;)
        to[n++] = (uint8_t)c;
    return n;
}

size_t HardwareSerial::write(uint8_t data)
{
    charge(12);
    if (to_ >= 0)
        machine::send((uint8_t)to_, data);
    return 1;
}

size_t HardwareSerial::setRxBufferSize(size_t size)
{
    machine::set_ring(number_, (int)size);
    return size;
}

#ifdef BOARD_ESP32
bool BluetoothSerial::begin(const String &, bool, bool)
{
    HardwareSerial::begin((unsigned long)machine::line_rate(board::UARTS - 1));
    tell();
    return true;
}

void BluetoothSerial::tell()
{
    esp_spp_cb_param_t value = {};
    if (opened_ && hasClient())
        opened_(ESP_SPP_SRV_OPEN_EVT, &value);
}
#endif

/* What the core does after each loop(), and, for onReceive, its task of events. */
void serve_serial_events()
{
    if (serialEvent && Serial.available())
        serialEvent();
    if (serialEvent1 && Serial1.available())
        serialEvent1();
    if (Serial.handler() && Serial.available())
        Serial.handler()();
    if (Serial1.handler() && Serial1.available())
        Serial1.handler()();
#ifndef BOARD_ESP32C3
    if (serialEvent2 && Serial2.available())
        serialEvent2();
    if (Serial2.handler() && Serial2.available())
        Serial2.handler()();
#endif
}

/* printf writes to the console, which is UART 0. */
static ssize_t write_console(void *, const char *data, size_t size)
{
    for (size_t each = 0; each < size; each++)
        Serial.write((uint8_t)data[each]);
    return (ssize_t)size;
}

static bool open_console()
{
    cookie_io_functions_t functions = {};
    functions.write = write_console;
    stdout = fopencookie(nullptr, "w", functions);
    setvbuf(stdout, nullptr, _IONBF, 0);
    return true;
}

static bool console = open_console();

/* ------------------------------------------------------------------ Wire and SPI */

TwoWire Wire(0), Wire1(1);

void TwoWire::pass(size_t bytes) { machine::pass_until(machine::now + 160 + (uint64_t)(9.0 * (double)bytes * machine::CLOCK / clock_)); }
void TwoWire::beginTransmission(int address) { charge(12); address_ = (uint8_t)address; out_.clear(); }
int TwoWire::available() { charge(4); return (int)(in_.size() - next_); }
int TwoWire::read() { charge(4); return next_ < in_.size() ? (uint8_t)in_[next_++] : -1; }
int TwoWire::peek() { charge(4); return next_ < in_.size() ? (uint8_t)in_[next_] : -1; }

bool TwoWire::begin(int sda, int scl, uint32_t hertz)
{
    charge(320);
    for (int pin : {sda, scl})
        if (pin >= 0)
            machine::level((uint8_t)pin); /* refuses a pin that there is not */
    if (hertz)
        clock_ = hertz;
    return true;
}

size_t TwoWire::write(uint8_t data)
{
    charge(4);
    if (out_.size() >= I2C_BUFFER_LENGTH)
        return 0;
    out_ += (char)data;
    return 1;
}

uint8_t TwoWire::endTransmission(bool)
{
    pass(1);
    if (!part_link_begin(address_, 0))
        return 2;
    for (char each : out_) {
        pass(1);
        if (!part_link_write((uint8_t)each))
            return 3;
    }
    return 0;
}

size_t TwoWire::requestFrom(int address, int count, int)
{
    in_.clear();
    next_ = 0;
    pass(1);
    if (!part_link_begin((uint8_t)address, 1))
        return 0;
    for (int each = 0; each < count && each < I2C_BUFFER_LENGTH; each++) {
        pass(1);
        in_ += (char)part_link_read();
    }
    return in_.size();
}

SPIClass SPI(VSPI);

uint8_t SPIClass::transfer(uint8_t data)
{
    uint8_t received = part_link_transfer(data);
    charge((uint32_t)(8.0 * machine::CLOCK / clock_) + 4);
    return received;
}

void SPIClass::transferBytes(const uint8_t *data, uint8_t *out, uint32_t size)
{
    for (uint32_t each = 0; each < size; each++) {
        uint8_t received = transfer(data ? data[each] : 0xFF);
        if (out)
            out[each] = received;
    }
}

/* ------------------------------------------------------------------ EEPROM */

EEPROMClass EEPROM;

bool EEPROMClass::begin(size_t size)
{
    charge(1600);
    if (!size || size > 4096)
        return false;
    data_.resize(size);
    for (size_t at = 0; at < size; at++)
        data_[at] = (char)machine::remembered((uint16_t)at);
    return true;
}

bool EEPROMClass::commit()
{
    machine::pass_until(machine::now + 320000); /* a page of flash is erased and written: 20 ms */
    for (size_t at = 0; at < data_.size(); at++)
        machine::remember((uint16_t)at, (uint8_t)data_[at]);
    return !data_.empty();
}

size_t EEPROMClass::move(int at, void *data, size_t size, bool in)
{
    if (at < 0 || (size_t)at + size > data_.size())
        return 0;
    if (in)
        memcpy(&data_[(size_t)at], data, size);
    else
        memcpy(data, &data_[(size_t)at], size);
    return size;
}
