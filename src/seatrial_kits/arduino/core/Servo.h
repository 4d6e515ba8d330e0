/* Servos: one pulse after the other, all again every 20 ms. */
#ifndef Servo_h
#define Servo_h

#include "Arduino.h"

#pragma pack(push)
#pragma pack()

#define MIN_PULSE_WIDTH 544
#define MAX_PULSE_WIDTH 2400
#define DEFAULT_PULSE_WIDTH 1500
#define REFRESH_INTERVAL 20000
#define INVALID_SERVO 255

class Servo {
public:
    Servo();
    uint8_t attach(int pin, int least = MIN_PULSE_WIDTH, int most = MAX_PULSE_WIDTH);
    void detach();
    void write(int value);
    void writeMicroseconds(int us);
    int16_t read();
    int16_t readMicroseconds();
    bool attached();

private:
    uint8_t index_;
};

#pragma pack(pop)

#endif
