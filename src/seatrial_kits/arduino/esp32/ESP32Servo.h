/* Servos by LEDC: what the library ESP32Servo and others of its kind are called with. */
#ifndef ESP32_Servo_h
#define ESP32_Servo_h

#include "Arduino.h"

#define MIN_PULSE_WIDTH 500
#define MAX_PULSE_WIDTH 2500
#define DEFAULT_uS_LOW 544
#define DEFAULT_uS_HIGH 2400
#define DEFAULT_PULSE_WIDTH 1500
#define REFRESH_CPS 50

class Servo {
public:
    int attach(int pin) { return attach(pin, DEFAULT_uS_LOW, DEFAULT_uS_HIGH); }
    int attach(int pin, int least, int most);
    void detach();
    void write(int value);
    void writeMicroseconds(int us);
    int read();
    int readMicroseconds() { return us_; }
    bool attached() { return pin_ >= 0; }
    void setPeriodHertz(int hertz);
    void setTimerWidth(int) {}

private:
    int pin_ = -1, least_ = DEFAULT_uS_LOW, most_ = DEFAULT_uS_HIGH, us_ = DEFAULT_PULSE_WIDTH, hertz_ = REFRESH_CPS;
};

class ESP32PWM {
public:
    static void allocateTimer(int) {}
};

#endif
