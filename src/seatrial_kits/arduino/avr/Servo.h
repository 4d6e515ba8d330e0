/* Servos for AVR boards: one 16-bit timer, one pulse after the other, all again every 20 ms.
 *
 * Written from the public documentation of Arduino's Servo: Debian's Arduino core has none.
 */
#ifndef Servo_h
#define Servo_h

#include <stdint.h>

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
    int read();
    int readMicroseconds();
    bool attached();

private:
    uint8_t index_;
    int least_, most_;
};

#endif
