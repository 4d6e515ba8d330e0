/* The API's functions in terms of the machine; costs in cycles are those of the AVR core, roughly. */
#include "Arduino.h"
#include "EEPROM.h"
#include "SPI.h"
#include "Servo.h"
#include "Wire.h"
#include "avr/wdt.h"
#include "machine.h"
#include "util/atomic.h"

extern "C" int part_link_begin(uint8_t address, int reading);
extern "C" int part_link_write(uint8_t data);
extern "C" uint8_t part_link_read();

using machine::charge;

/* ------------------------------------------------------------------ time */

uint32_t micros() { charge(50); return (uint32_t)(machine::now / 64 * 4); }
uint32_t millis() { charge(30); return (uint32_t)(machine::now / 16000); }
void delay(uint32_t ms) { machine::pass_until(machine::now + ms * 16000ull); }
void delayMicroseconds(unsigned us) { machine::pass_until(machine::now + us * 16ull); }
void yield() { charge(8); }

/* ------------------------------------------------------------------ pins */

void pinMode(uint8_t pin, uint8_t mode)
{
    charge(60);
    if (mode == INPUT_PULLUP)
        machine::drive(pin, true);
}

void digitalWrite(uint8_t pin, uint8_t level) { charge(70); machine::drive(pin, level != LOW); }
int16_t digitalRead(uint8_t pin) { charge(60); return machine::level(pin); }
void analogReference(uint8_t) { charge(10); }

int16_t analogRead(uint8_t pin)
{
    charge(1792);
    double count = machine::volts((uint8_t)(pin >= A0 ? pin - A0 : pin)) / 5.0 * 1024.0;
    return (int16_t)(count < 0.0 ? 0.0 : count > 1023.0 ? 1023.0 : count);
}

void analogWrite(uint8_t pin, int value)
{
#ifdef BOARD_MEGA
    bool able = (pin >= 2 && pin <= 13) || (pin >= 44 && pin <= 46);
#else
    bool able = pin == 3 || pin == 5 || pin == 6 || (pin >= 9 && pin <= 11);
#endif
    charge(100);
    if (value <= 0 || value >= 255 || !able)
        machine::drive(pin, value >= (able ? 255 : 128));
    else
        machine::modulate(pin, value);
}

uint32_t pulseIn(uint8_t pin, uint8_t level, uint32_t timeout)
{
    uint64_t latest = machine::now + timeout * 16ull;
    auto wait = [&](bool until) {
        while (machine::level(pin) != until && machine::now < latest)
            machine::pass_until(latest, true);
    };
    wait(!level);
    wait(level);
    uint64_t begin = machine::now;
    wait(!level);
    return machine::now >= latest ? 0 : (uint32_t)((machine::now - begin) / 16);
}

uint32_t pulseInLong(uint8_t pin, uint8_t level, uint32_t timeout) { return pulseIn(pin, level, timeout); }

void shiftOut(uint8_t data, uint8_t clock, uint8_t order, uint8_t value)
{
    for (int i = 0; i < 8; i++) {
        digitalWrite(data, value >> (order == LSBFIRST ? i : 7 - i) & 1);
        digitalWrite(clock, HIGH);
        digitalWrite(clock, LOW);
    }
}

uint8_t shiftIn(uint8_t data, uint8_t clock, uint8_t order)
{
    uint8_t value = 0;
    for (int i = 0; i < 8; i++) {
        digitalWrite(clock, HIGH);
        value |= (uint8_t)(digitalRead(data) << (order == LSBFIRST ? i : 7 - i));
        digitalWrite(clock, LOW);
    }
    return value;
}

/* ------------------------------------------------------------------ interrupts */

int16_t digitalPinToInterrupt(int pin)
{
#ifdef BOARD_MEGA
    const int found[] = {2, 3, 21, 20, 19, 18};
#else
    const int found[] = {2, 3};
#endif
    for (int i = 0; i < (int)(sizeof found / sizeof *found); i++)
        if (found[i] == pin)
            return (int16_t)i;
    return NOT_AN_INTERRUPT;
}

void attachInterrupt(uint8_t number, void (*handler)(), int mode) { charge(40); machine::on_edge(number, handler, mode); }
void detachInterrupt(uint8_t number) { charge(40); machine::on_edge(number, nullptr, 0); }
void interrupts() { machine::enable(true); charge(1); }
void noInterrupts() { machine::enable(false); charge(1); }
bool interrupts_enabled() { return machine::enabled(); }

void wdt_enable(uint8_t timeout) { machine::watchdog((uint64_t)(240000ull << timeout)); }
void wdt_disable() { machine::watchdog(0); }
void wdt_reset() { charge(1); machine::feed(); }

/* ------------------------------------------------------------------ numbers */

int32_t map(int32_t x, int32_t in_min, int32_t in_max, int32_t out_min, int32_t out_max)
{
    int32_t span = in_max - in_min;
    int32_t product = (int32_t)((uint32_t)(x - in_min) * (uint32_t)(out_max - out_min));
    return span ? product / span + out_min : -1;
}

/* Park and Miller's minimal standard, as avr-libc's. */
static uint32_t random_state = 1;

static int32_t next_random()
{
    int32_t x = (int32_t)(random_state ? random_state : 123459876);
    x = 16807 * (x % 127773) - 2836 * (x / 127773);
    if (x < 0)
        x += 0x7fffffff;
    random_state = (uint32_t)x;
    return (int32_t)((uint32_t)x % 0x80000000u);
}

int32_t random(int32_t most) { return most ? next_random() % most : 0; }
int32_t random(int32_t least, int32_t most) { return least >= most ? least : least + random(most - least); }
void randomSeed(uint32_t seed) { if (seed) random_state = seed; }

#undef snprintf
#undef vsnprintf

int sketch_vsnprintf(char *to, size_t size, const char *format, va_list values)
{
    std::string out;
    char piece[128];
    for (; *format; format++) {
        if (*format != '%') {
            out += *format;
            continue;
        }
        std::string conversion = "%";
        int length = 0;
        for (format++; *format && strchr("-+ #0123456789.*lh", *format); format++) {
            if (*format == 'l' || *format == 'h')
                length += *format == 'l';
            else if (*format == '*')
                conversion += std::to_string(va_arg(values, int));
            else
                conversion += *format;
        }
        if (!*format)
            break;
        conversion += *format == 'S' ? 's' : *format;
        const char *form = conversion.c_str();
        *piece = 0;
        if (*format == 'd' || *format == 'i') {
            int v = va_arg(values, int);
            snprintf(piece, sizeof piece, form, length ? v : (int16_t)v);
        } else if (strchr("uxXo", *format)) {
            unsigned v = va_arg(values, unsigned);
            snprintf(piece, sizeof piece, form, length ? v : (uint16_t)v);
        } else if (*format == 'c') {
            snprintf(piece, sizeof piece, form, va_arg(values, int));
        } else if (*format == 's' || *format == 'S') {
            const char *text = va_arg(values, const char *);
            std::string whole(strlen(text) + 512, 0);
            snprintf(&whole[0], whole.size(), form, text);
            out += whole.c_str();
        } else if (strchr("feEgG", *format)) {
            (void)va_arg(values, double);
            /* avr-libc's printf has no floating point unless it is linked in */
            conversion = conversion.substr(0, conversion.find('.'));
            if (isalpha(conversion.back()))
                conversion.pop_back();
            snprintf(piece, sizeof piece, (conversion + "s").c_str(), "?");
        } else if (*format == '%') {
            strcpy(piece, "%");
        }
        out += piece;
    }
    charge((uint32_t)(200 + 20 * out.size()));
    if (size) {
        size_t n = out.size() < size - 1 ? out.size() : size - 1;
        memcpy(to, out.data(), n);
        to[n] = 0;
    }
    return (int)out.size();
}

int sketch_snprintf(char *to, size_t size, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    int n = sketch_vsnprintf(to, size, format, values);
    va_end(values);
    return n;
}

int sketch_sprintf(char *to, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    int n = sketch_vsnprintf(to, 4096, format, values);
    va_end(values);
    return n;
}

char *dtostrf(double value, signed char width, unsigned char precision, char *to)
{
    charge(1500);
    ::sprintf(to, "%*.*f", width, precision, (double)(float)value);
    return to;
}

static char *based(uint64_t value, bool negative, char *to, int base)
{
    char digits[68], *at = digits + sizeof digits;
    *--at = 0;
    do
        *--at = "0123456789abcdefghijklmnopqrstuvwxyz"[value % (unsigned)base];
    while (value /= (unsigned)base);
    if (negative)
        *--at = '-';
    return strcpy(to, at);
}

char *ultoa(unsigned long value, char *to, int base) { charge(300); return based((uint32_t)value, false, to, base); }
char *utoa(unsigned value, char *to, int base) { charge(200); return based((uint16_t)value, false, to, base); }

char *ltoa(long value, char *to, int base)
{
    bool negative = base == 10 && value < 0;
    charge(300);
    return based(negative ? (uint32_t)-value : (uint32_t)value, negative, to, base);
}

char *itoa(int value, char *to, int base)
{
    bool negative = base == 10 && value < 0;
    charge(200);
    return based(negative ? (uint16_t)-value : (uint16_t)value, negative, to, base);
}

/* ------------------------------------------------------------------ texts */

String::String(long v, unsigned char base) { char b[68]; ltoa(v, b, base); text_ = b; }
String::String(unsigned long v, unsigned char base) { char b[68]; ultoa(v, b, base); text_ = b; }
String::String(double v, unsigned char decimals) { char b[80]; dtostrf(v, (signed char)(decimals + 2), decimals, b); text_ = b; }
bool String::equalsIgnoreCase(const String &other) const { return strcasecmp(c_str(), other.c_str()) == 0; }

String String::substring(unsigned from, unsigned to) const
{
    if (from > to) {
        unsigned other = from;
        from = to;
        to = other;
    }
    return from < length() ? String(text_.substr(from, to - from)) : String();
}

void String::replace(const String &from, const String &to)
{
    for (size_t at = 0; from.length() && (at = text_.find(from.text_, at)) != std::string::npos; at += to.length())
        text_.replace(at, from.length(), to.text_);
}

void String::trim()
{
    size_t first = text_.find_first_not_of(" \t\r\n\f\v"), last = text_.find_last_not_of(" \t\r\n\f\v");
    text_ = first == std::string::npos ? "" : text_.substr(first, last - first + 1);
}

void String::toCharArray(char *to, unsigned size, unsigned from) const
{
    if (!size)
        return;
    std::string part = from < text_.size() ? text_.substr(from, size - 1) : "";
    memcpy(to, part.c_str(), part.size() + 1);
}

/* ------------------------------------------------------------------ Print and Stream */

size_t Print::write(const uint8_t *data, size_t size)
{
    for (size_t i = 0; i < size; i++)
        write(data[i]);
    return size;
}

size_t Print::print(long v, int base)
{
    if (base == 0)
        return write((uint8_t)v);
    if (base == 10 && v < 0)
        return write('-') + print((unsigned long)(uint32_t)-v, 10);
    return print((unsigned long)(uint32_t)v, base);
}

size_t Print::print(unsigned long v, int base)
{
    if (base == 0)
        return write((uint8_t)v);
    char digits[68];
    based((uint32_t)v, false, digits, base < 2 ? 10 : base);
    for (char *c = digits; *c; c++)
        *c = (char)toupper(*c);
    charge(300);
    return write(digits);
}

/* In single precision, as the board does it. */
size_t Print::print(double value, int digits)
{
    float v = (float)value;
    if (isnan(v))
        return write("nan");
    if (isinf(v))
        return write("inf");
    if (v > 4294967040.0f || v < -4294967040.0f)
        return write("ovf");
    charge(1500);
    size_t n = 0;
    if (v < 0.0f) {
        n += write('-');
        v = -v;
    }
    float rounding = 0.5f;
    for (int i = 0; i < digits; i++)
        rounding /= 10.0f;
    v += rounding;
    uint32_t whole = (uint32_t)v;
    float rest = v - (float)whole;
    n += print((unsigned long)whole);
    if (digits > 0)
        n += write('.');
    for (; digits > 0; digits--) {
        rest *= 10.0f;
        unsigned digit = (unsigned)rest;
        n += print(digit);
        rest -= (float)digit;
    }
    return n;
}

int Stream::timedRead()
{
    uint64_t latest = machine::now + timeout_ * 16000ull;
    for (;;) {
        int c = read();
        if (c >= 0 || machine::now >= latest)
            return c;
        machine::pass_until(latest, true);
    }
}

int Stream::timedPeek()
{
    uint64_t latest = machine::now + timeout_ * 16000ull;
    for (;;) {
        int c = peek();
        if (c >= 0 || machine::now >= latest)
            return c;
        machine::pass_until(latest, true);
    }
}

size_t Stream::readBytes(char *to, size_t size)
{
    size_t n = 0;
    for (int c; n < size && (c = timedRead()) >= 0;)
        to[n++] = (char)c;
    return n;
}

size_t Stream::readBytesUntil(char end, char *to, size_t size)
{
    size_t n = 0;
    for (int c; n < size && (c = timedRead()) >= 0 && (char)c != end;)
        to[n++] = (char)c;
    return n;
}

String Stream::readString()
{
    String text;
    for (int c; (c = timedRead()) >= 0;)
        text += (char)c;
    return text;
}

String Stream::readStringUntil(char end)
{
    String text;
    for (int c; (c = timedRead()) >= 0 && (char)c != end;)
        text += (char)c;
    return text;
}

int Stream::peekNumber(bool dot)
{
    for (;;) {
        int c = timedPeek();
        if (c < 0 || c == '-' || isdigit(c) || (dot && c == '.'))
            return c;
        read();
    }
}

int32_t Stream::parseInt() { return (int32_t)parseFloat(); }

float Stream::parseFloat()
{
    std::string digits;
    int c = peekNumber(true);
    if (c < 0)
        return 0.0f;
    do {
        digits += (char)read();
        c = timedPeek();
    } while (isdigit(c) || c == '.');
    return (float)atof(digits.c_str());
}

bool Stream::find(const char *what)
{
    size_t matched = 0;
    while (what[matched]) {
        int c = timedRead();
        if (c < 0)
            return false;
        matched = c == what[matched] ? matched + 1 : (c == what[0]);
    }
    return true;
}

/* ------------------------------------------------------------------ Serial, Wire, SPI */

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
        part_link_write(out_[i]);
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
uint8_t SPIClass::transfer(uint8_t) { charge((uint32_t)(8.0 * machine::CLOCK / clock_) + 4); return 0xFF; }

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

static uint8_t eeprom[EEPROM_SIZE];
static bool eeprom_erased = (memset(eeprom, 0xFF, sizeof eeprom), true);
EEPROMClass EEPROM;
uint8_t EEPROMClass::read(int at) { charge(12); return eeprom_erased && at >= 0 && at < EEPROM_SIZE ? eeprom[at] : 0xFF; }
void EEPROMClass::write(int at, uint8_t value) { machine::pass_until(machine::now + 54400); if (at >= 0 && at < EEPROM_SIZE) eeprom[at] = value; }
