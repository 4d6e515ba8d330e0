/* Servos: one pulse after the other, all again in each frame. */
#ifndef SERVOS_H
#define SERVOS_H

uint64_t first(bool do_it);

struct Servo {
    int pin = -1;
    double us = 1500.0;
} servos[SERVOS];
int servo_count, servo_turn = -1;
uint64_t servo_next = NEVER, frame_start;

void turn_servos()
{
    if (servo_turn >= 0 && servos[servo_turn].pin >= 0)
        put_output((uint8_t)servos[servo_turn].pin, false);
    if (++servo_turn == servo_count) {
        uint64_t following = frame_start + FRAME;
        servo_turn = -1;
        servo_next = following > now ? following : now + 64;
        return;
    }
    if (servo_turn == 0)
        frame_start = now;
    if (servos[servo_turn].pin >= 0)
        put_output((uint8_t)servos[servo_turn].pin, true);
    servo_next = now + (uint64_t)lround(servos[servo_turn].us * 16.0);
}

} // namespace

int new_servo() { return servo_count < SERVOS ? servo_count++ : -1; }

void set_servo(int servo, int pin, double us)
{
    if (servo < 0)
        return;
    if (pin >= 0)
        need_pin((uint8_t)pin);
    if (pin != servos[servo].pin && servos[servo].pin >= 0)
        put_output((uint8_t)servos[servo].pin, false);
    servos[servo] = {pin, us};
    if (servo_next == NEVER && pin >= 0)
        servo_next = now + 64;
    plan_next();
}

namespace {

#endif
