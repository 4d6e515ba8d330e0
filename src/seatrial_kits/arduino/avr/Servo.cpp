#include "Servo.h"

#include <Arduino.h>

#if defined(__AVR_ATmega2560__)
#define CONTROL_A TCCR5A
#define CONTROL_B TCCR5B
#define COUNT TCNT5
#define COMPARE OCR5A
#define MASK TIMSK5
#define ENABLE OCIE5A
#define FLAGS TIFR5
#define FLAG OCF5A
#define VECTOR TIMER5_COMPA_vect
#else
#define CONTROL_A TCCR1A
#define CONTROL_B TCCR1B
#define COUNT TCNT1
#define COMPARE OCR1A
#define MASK TIMSK1
#define ENABLE OCIE1A
#define FLAGS TIFR1
#define FLAG OCF1A
#define VECTOR TIMER1_COMPA_vect
#endif

#define SERVOS 12
#define TICKS(us) ((uint16_t)((us) * 2)) /* prescaler 8 at 16 MHz */
/* Ticks by which the interrupt raises a pin later than it lowers one: the first, and the others. */
#define LATE_FIRST 7
#define LATE 12

static struct {
    volatile uint8_t *port;
    uint8_t mask;
    volatile uint16_t ticks;
    volatile bool active;
    uint8_t pin;
} servos[SERVOS];
static uint8_t count;
static volatile int8_t turn = -1;
static volatile uint16_t since; /* ticks since the beginning of the frame */

ISR(VECTOR)
{
    if (turn >= 0 && servos[turn].active)
        *servos[turn].port &= ~servos[turn].mask;
    turn++;
    if (turn < (int8_t)count) {
        uint16_t ticks = servos[turn].ticks;
        if (turn == 0)
            since = 0;
        ticks += turn == 0 ? LATE_FIRST : LATE;
        COMPARE += ticks;
        since += ticks;
        if (servos[turn].active)
            *servos[turn].port |= servos[turn].mask;
    } else {
        uint16_t rest = TICKS(REFRESH_INTERVAL) - since;
        COMPARE += since + 8 < TICKS(REFRESH_INTERVAL) ? rest : 8;
        turn = -1;
    }
}

Servo::Servo() : index_(INVALID_SERVO), least_(MIN_PULSE_WIDTH), most_(MAX_PULSE_WIDTH)
{
    if (count < SERVOS) {
        index_ = count++;
        servos[index_].ticks = TICKS(DEFAULT_PULSE_WIDTH);
    }
}

uint8_t Servo::attach(int pin, int least, int most)
{
    if (index_ == INVALID_SERVO)
        return INVALID_SERVO;
    least_ = least;
    most_ = most;
    pinMode(pin, OUTPUT);
    digitalWrite(pin, LOW);
    servos[index_].port = portOutputRegister(digitalPinToPort(pin));
    servos[index_].mask = digitalPinToBitMask(pin);
    servos[index_].pin = pin;
    servos[index_].active = true;
    if (!(MASK & _BV(ENABLE))) {
        CONTROL_A = 0;
        CONTROL_B = _BV(1); /* counts on, at a prescaler of 8 */
        uint8_t was = SREG;
        cli();
        COMPARE = COUNT + 64;
        FLAGS = _BV(FLAG);
        MASK |= _BV(ENABLE);
        SREG = was;
    }
    return index_;
}

void Servo::detach()
{
    if (attached()) {
        servos[index_].active = false;
        digitalWrite(servos[index_].pin, LOW);
    }
}

bool Servo::attached() { return index_ != INVALID_SERVO && servos[index_].active; }

void Servo::write(int value)
{
    if (value < MIN_PULSE_WIDTH)
        value = map(constrain(value, 0, 180), 0, 180, least_, most_);
    writeMicroseconds(value);
}

void Servo::writeMicroseconds(int us)
{
    if (index_ == INVALID_SERVO)
        return;
    uint16_t ticks = TICKS(constrain(us, least_, most_));
    uint8_t was = SREG;
    cli();
    servos[index_].ticks = ticks;
    SREG = was;
}

int Servo::readMicroseconds() { return index_ == INVALID_SERVO ? 0 : servos[index_].ticks / 2; }
int Servo::read() { return map(readMicroseconds() + 1, least_, most_, 0, 180); }
