/* PWM: LEDC by channels and by pins, analogWrite, tone, and servos on top of it. */
#include "Arduino.h"
#include "ESP32Servo.h"
#include "machine.h"

using machine::charge;

namespace {

constexpr int CHANNELS = 16, NONE = -1;

struct Channel {
    double frequency = 0.0;
    int bits = 0;
    uint32_t duty = 0;
    bool by_pin = false; /* it was found for a pin: of version 3.0, analogWrite, servos */
} channels[CHANNELS];
int8_t channel_of[board::PINS]; /* one more; 0: none */

int channel_at(uint8_t pin) { return pin < board::PINS ? channel_of[pin] - 1 : NONE; }

void act(int number)
{
    const Channel &one = channels[number];
    for (uint8_t pin = 0; pin < board::PINS; pin++) {
        if (channel_at(pin) != number)
            continue;
        double share = one.bits ? (double)one.duty / (double)(1u << one.bits) : 0.0;
        machine::direct(pin, true);
        if (share <= 0.0 || share >= 1.0 || one.frequency <= 0.0)
            machine::drive(pin, share >= 1.0);
        else
            machine::modulate(pin, share, machine::CLOCK / one.frequency);
    }
}

int free_channel()
{
    for (int each = CHANNELS - 1; each >= 0; each--)
        if (!channels[each].bits)
            return each;
    return NONE;
}

/* The channel that a number means: of a pin with one of its own, that one. */
int meant(uint8_t number)
{
    int found = channel_at(number);
    if (found != NONE && channels[found].by_pin)
        return found;
    return number < CHANNELS ? number : NONE;
}

/* As the hardware: the most that bits hold, plus one, is always high. */
bool write(int number, uint32_t duty)
{
    charge(16);
    if (number == NONE)
        return false;
    Channel &one = channels[number];
    one.duty = one.bits && duty == (1u << one.bits) - 1 ? duty + 1 : duty;
    act(number);
    return true;
}

} // namespace

double ledcSetup(uint8_t channel, double frequency, uint8_t bits)
{
    charge(160);
    if (channel >= CHANNELS || !bits || bits > 20 || frequency <= 0.0)
        return 0.0;
    channels[channel] = {frequency, bits, channels[channel].duty, false};
    act(channel);
    return frequency;
}

void ledcAttachPin(uint8_t pin, uint8_t channel)
{
    charge(80);
    machine::level(pin);
    if (channel >= CHANNELS)
        return;
    channel_of[pin] = (int8_t)(channel + 1);
    act(channel);
}

void ledcDetachPin(uint8_t pin) { ledcDetach(pin); }

bool ledcDetach(uint8_t pin)
{
    int found = channel_at(pin);
    if (found == NONE)
        return false;
    channel_of[pin] = 0;
    machine::drive(pin, false);
    if (channels[found].by_pin)
        channels[found] = Channel();
    return true;
}

bool ledcAttachChannel(uint8_t pin, uint32_t frequency, uint8_t bits, uint8_t channel)
{
    charge(160);
    machine::level(pin);
    if (channel >= CHANNELS || !bits || bits > 20 || !frequency)
        return false;
    channels[channel] = {(double)frequency, bits, 0, true};
    channel_of[pin] = (int8_t)(channel + 1);
    act(channel);
    return true;
}

bool ledcAttach(uint8_t pin, uint32_t frequency, uint8_t bits)
{
    int found = channel_at(pin);
    if (found == NONE)
        found = free_channel();
    return found != NONE && ledcAttachChannel(pin, frequency, bits, (uint8_t)found);
}

void ledcWrite(uint8_t number, uint32_t duty) { write(meant(number), duty); }
bool ledcWriteChannel(uint8_t channel, uint32_t duty) { return write(channel < CHANNELS ? channel : NONE, duty); }
uint32_t ledcRead(uint8_t number) { int found = meant(number); return found == NONE ? 0 : channels[found].duty; }
double ledcReadFreq(uint8_t number) { int found = meant(number); return found == NONE || !channels[found].duty ? 0.0 : channels[found].frequency; }

double ledcChangeFrequency(uint8_t number, double frequency, uint8_t bits)
{
    int found = meant(number);
    if (found == NONE || frequency <= 0.0)
        return 0.0;
    channels[found].frequency = frequency;
    channels[found].bits = bits;
    act(found);
    return frequency;
}

double ledcWriteTone(uint8_t number, double frequency)
{
    int found = meant(number);
    if (found == NONE)
        return 0.0;
    channels[found].frequency = frequency;
    channels[found].bits = 10;
    channels[found].duty = frequency > 0.0 ? 512 : 0;
    act(found);
    return frequency;
}

/* ------------------------------------------------------------------ analogWrite, tone, dacWrite */

static uint32_t write_frequency = 1000;
static uint8_t write_bits = 8;

void analogWriteFrequency(uint32_t frequency) { write_frequency = frequency; }
void analogWriteResolution(uint8_t bits) { write_bits = bits; }
void analogWriteFrequency(uint8_t pin, uint32_t frequency) { ledcChangeFrequency(pin, frequency, write_bits); write_frequency = frequency; }
void analogWriteResolution(uint8_t pin, uint8_t bits) { ledcChangeFrequency(pin, write_frequency, bits); write_bits = bits; }

void analogWrite(uint8_t pin, int value)
{
    if (channel_at(pin) == NONE && !ledcAttach(pin, write_frequency, write_bits))
        return;
    ledcWrite(pin, (uint32_t)(value < 0 ? 0 : value));
}

/* A share of the time in the place of a voltage: pins have levels. */
void dacWrite(uint8_t pin, uint8_t value)
{
    if (channel_at(pin) == NONE && !ledcAttach(pin, 100000, 8))
        return;
    ledcWrite(pin, value);
}

void tone(uint8_t pin, unsigned frequency, unsigned long duration)
{
    charge(160);
    machine::direct(pin, true);
    if (!frequency || !machine::can_sound(pin))
        return;
    machine::sound(pin, (uint32_t)(machine::CLOCK / 2.0 / frequency), duration ? (int64_t)(2ull * frequency * duration / 1000) : -1);
}

void noTone(uint8_t pin) { charge(40); machine::hush(pin); }

/* ------------------------------------------------------------------ servos */

constexpr uint8_t SERVO_BITS = 16;

int Servo::attach(int pin, int least, int most)
{
    if (!ledcAttach((uint8_t)pin, (uint32_t)hertz_, SERVO_BITS))
        return 0;
    pin_ = pin;
    least_ = least;
    most_ = most;
    return channel_at((uint8_t)pin) + 1;
}

void Servo::detach()
{
    if (attached())
        ledcDetach((uint8_t)pin_);
    pin_ = -1;
}

void Servo::setPeriodHertz(int hertz)
{
    hertz_ = hertz;
    if (attached())
        ledcChangeFrequency((uint8_t)pin_, hertz, SERVO_BITS);
}

void Servo::write(int value)
{
    if (value < MIN_PULSE_WIDTH)
        value = (int)map(constrain(value, 0, 180), 0, 180, least_, most_);
    writeMicroseconds(value);
}

void Servo::writeMicroseconds(int us)
{
    us_ = constrain(us, least_, most_);
    if (attached())
        ledcWrite((uint8_t)pin_, (uint32_t)lround((double)us_ * hertz_ / 1e6 * (1u << SERVO_BITS)));
}

int Servo::read() { return (int)map(us_ + 1, least_, most_, 0, 180); }
