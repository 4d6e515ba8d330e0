/* What hangs on the board: Serial, SoftwareSerial, Wire, SPI, Servo, EEPROM. Costs in cycles as in api.cpp. */
#include "Arduino.h"
#include "EEPROM.h"
#include "avr/eeprom.h"
#include "SPI.h"
#include "Servo.h"
#include "SoftwareSerial.h"
#include "Wire.h"
#include "machine.h"
#include "util/atomic.h"

extern "C" int part_link_begin(uint8_t address, int reading);
extern "C" int part_link_write(uint8_t data);
extern "C" uint8_t part_link_read();
extern "C" uint8_t part_link_transfer(uint8_t data);

using machine::charge;

/* ------------------------------------------------------------------ Serial */

HardwareSerial Serial(0);
#ifdef BOARD_MEGA
HardwareSerial Serial1(1), Serial2(2), Serial3(3);
#endif

void HardwareSerial::begin(uint32_t baud, uint8_t) { charge(100); machine::open_uart(number_, baud); }
void HardwareSerial::end() { flush(); machine::open_uart(number_, 0); }
int16_t HardwareSerial::available() { charge(24); return (int16_t)machine::received(number_); }
int16_t HardwareSerial::read() { charge(30); return (int16_t)machine::take(number_, false); }
int16_t HardwareSerial::peek() { charge(24); return (int16_t)machine::take(number_, true); }
int HardwareSerial::availableForWrite() { charge(24); return machine::room(number_); }
void HardwareSerial::flush() { charge(16); machine::drain(number_); }
size_t HardwareSerial::write(uint8_t data) { charge(60); machine::send(number_, data); return 1; }

SoftwareSerial *SoftwareSerial::listener_;

void SoftwareSerial::begin(long baud)
{
    charge(400);
    to_ = machine::line_to(rx_);
    from_ = machine::line_from(tx_);
    byte_us_ = baud > 0 ? (uint32_t)(10000000 / baud) : 0;
    for (int each : {to_, from_ == to_ ? -1 : from_})
        if (each >= 0)
            machine::open_uart((uint8_t)each, (uint32_t)baud);
    listen();
}

bool SoftwareSerial::listen()
{
    if (listener_ == this || !byte_us_)
        return false;
    if (listener_)
        listener_->stopListening();
    listener_ = this;
    receive(true);
    return true;
}

bool SoftwareSerial::stopListening()
{
    if (listener_ != this)
        return false;
    listener_ = nullptr;
    receive(false);
    return true;
}

void SoftwareSerial::receive(bool on) { if (to_ >= 0) machine::listen((uint8_t)to_, on); }
bool SoftwareSerial::overflow() { return to_ >= 0 && machine::overflowed((uint8_t)to_); }
int16_t SoftwareSerial::available() { charge(24); return isListening() && to_ >= 0 ? (int16_t)machine::received((uint8_t)to_) : (int16_t)0; }
int16_t SoftwareSerial::read() { charge(30); return isListening() && to_ >= 0 ? (int16_t)machine::take((uint8_t)to_, false) : (int16_t)-1; }
int16_t SoftwareSerial::peek() { charge(24); return isListening() && to_ >= 0 ? (int16_t)machine::take((uint8_t)to_, true) : (int16_t)-1; }

/* Bit by bit, with interrupts off: what comes meanwhile is not received. */
size_t SoftwareSerial::write(uint8_t data)
{
    if (!byte_us_)
        return 0;
    bool was = interrupts_enabled();
    noInterrupts();
    receive(false);
    if (from_ >= 0) {
        machine::send((uint8_t)from_, data);
        machine::drain((uint8_t)from_);
    } else {
        delayMicroseconds(byte_us_);
    }
    receive(isListening());
    if (was)
        interrupts();
    return 1;
}

TwoWire Wire;

void TwoWire::pass(unsigned bytes) { machine::pass_until(machine::now + 16ull + (uint64_t)(9e0 * bytes * machine::CLOCK / clock_)); }
void TwoWire::beginTransmission(uint8_t address) { charge(20); address_ = address; written_ = 0; }
int16_t TwoWire::available() { charge(12); return (int16_t)(got_ - next_); }
int16_t TwoWire::read() { charge(20); return next_ < got_ ? in_[next_++] : (int16_t)-1; }
int16_t TwoWire::peek() { charge(12); return next_ < got_ ? in_[next_] : (int16_t)-1; }

size_t TwoWire::write(uint8_t data)
{
    charge(20);
    if (written_ >= BUFFER_LENGTH)
        return 0;
    out_[written_++] = data;
    return 1;
}

uint8_t TwoWire::endTransmission(bool)
{
    pass(1);
    if (!part_link_begin(address_, 0))
        return 2;
    for (uint8_t i = 0; i < written_; i++) {
        pass(1);
        if (!part_link_write(out_[i]))
            return 3;
    }
    return 0;
}

uint8_t TwoWire::requestFrom(uint8_t address, uint8_t count, uint8_t)
{
    next_ = got_ = 0;
    pass(1);
    if (!part_link_begin(address, 1))
        return 0;
    for (; got_ < count && got_ < BUFFER_LENGTH; got_++) {
        pass(1);
        in_[got_] = part_link_read();
    }
    return got_;
}

SPIClass SPI;
uint8_t SPIClass::transfer(uint8_t data)
{
    uint8_t received = part_link_transfer(data);
    charge((uint32_t)(8.0 * machine::CLOCK / clock_) + 4);
    return received;
}

/* What the core does after each loop(). */
void serve_serial_events()
{
    if (serialEvent && Serial.available())
        serialEvent();
#ifdef BOARD_MEGA
    if (serialEvent1 && Serial1.available())
        serialEvent1();
    if (serialEvent2 && Serial2.available())
        serialEvent2();
    if (serialEvent3 && Serial3.available())
        serialEvent3();
#endif
}

/* ------------------------------------------------------------------ Servo and EEPROM */

static struct { int pin = -1, least = MIN_PULSE_WIDTH, most = MAX_PULSE_WIDTH, us = DEFAULT_PULSE_WIDTH; } servos[12];

Servo::Servo() { int found = machine::new_servo(); index_ = found < 0 ? INVALID_SERVO : (uint8_t)found; }

uint8_t Servo::attach(int pin, int least, int most)
{
    charge(200);
    if (index_ == INVALID_SERVO)
        return INVALID_SERVO;
    servos[index_] = {pin, least, most, servos[index_].us};
    machine::set_servo(index_, pin, servos[index_].us);
    return index_;
}

void Servo::detach() { charge(50); if (attached()) { servos[index_].pin = -1; machine::set_servo(index_, -1, servos[index_].us); } }
bool Servo::attached() { return index_ != INVALID_SERVO && servos[index_].pin >= 0; }
int16_t Servo::readMicroseconds() { return (int16_t)(index_ == INVALID_SERVO ? 0 : servos[index_].us); }
int16_t Servo::read() { return (int16_t)map(readMicroseconds() + 1, servos[index_].least, servos[index_].most, 0, 180); }

void Servo::write(int value)
{
    if (index_ == INVALID_SERVO)
        return;
    if (value < MIN_PULSE_WIDTH)
        value = (int)map(constrain(value, 0, 180), 0, 180, servos[index_].least, servos[index_].most);
    writeMicroseconds(value);
}

void Servo::writeMicroseconds(int us)
{
    charge(120);
    if (index_ == INVALID_SERVO)
        return;
    servos[index_].us = constrain(us, servos[index_].least, servos[index_].most);
    machine::set_servo(index_, servos[index_].pin, servos[index_].us);
}

EEPROMClass EEPROM;

/* A write goes on for 3.4 ms by itself; whatever comes next waits for it. */
static uint64_t memory_ready;

bool eeprom_ready() { charge(2); return machine::now >= memory_ready; }

static uint8_t memory_read(uintptr_t at)
{
    machine::pass_until(memory_ready);
    charge(12);
    return at < EEPROM_SIZE ? machine::remembered((uint16_t)at) : 0xFF;
}

static void memory_write(uintptr_t at, uint8_t value)
{
    machine::pass_until(memory_ready);
    charge(20);
    memory_ready = machine::now + 54400;
    if (at < EEPROM_SIZE)
        machine::remember((uint16_t)at, value);
}

uint8_t EEPROMClass::read(int at) { return memory_read((uintptr_t)at); }
void EEPROMClass::write(int at, uint8_t value) { memory_write((uintptr_t)at, value); }

/* Variables of EEMEM are in a section of their own; where they are in it is their address. */
extern "C" __attribute__((weak)) char __start_sketch_eemem[], __stop_sketch_eemem[];

static uintptr_t place_in_memory(const void *at)
{
    char *place = (char *)at;
    return place >= __start_sketch_eemem && place < __stop_sketch_eemem ? (uintptr_t)(place - __start_sketch_eemem) : (uintptr_t)at;
}

void eeprom_read_block(void *to, const void *from, size_t count)
{
    for (size_t i = 0; i < count; i++)
        ((uint8_t *)to)[i] = memory_read(place_in_memory(from) + i);
}

void eeprom_write_block(const void *from, void *to, size_t count)
{
    for (size_t i = 0; i < count; i++)
        memory_write(place_in_memory(to) + i, ((const uint8_t *)from)[i]);
}

void eeprom_update_block(const void *from, void *to, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (memory_read(place_in_memory(to) + i) != ((const uint8_t *)from)[i])
            memory_write(place_in_memory(to) + i, ((const uint8_t *)from)[i]);
}
