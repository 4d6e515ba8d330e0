/* Registers of the pins: reading and writing them is as digitalRead and digitalWrite. */
#ifndef SOC_GPIO_STRUCT_H
#define SOC_GPIO_STRUCT_H

#include <stdint.h>

uint32_t sketch_gpio_read(int first);
void sketch_gpio_write(int first, uint32_t pins, bool level);
void sketch_gpio_enable(int first, uint32_t pins, bool output);

template <int FIRST> struct GpioInputs {
    operator uint32_t() const { return sketch_gpio_read(FIRST); }
};
template <int FIRST> struct GpioOutputs {
    operator uint32_t() const { return sketch_gpio_read(FIRST); }
    void operator=(uint32_t pins) { sketch_gpio_write(FIRST, pins, true), sketch_gpio_write(FIRST, ~pins, false); }
    void operator|=(uint32_t pins) { sketch_gpio_write(FIRST, pins, true); }
    void operator&=(uint32_t pins) { sketch_gpio_write(FIRST, ~pins, false); }
};
template <int FIRST, bool LEVEL> struct GpioWrite {
    void operator=(uint32_t pins) { sketch_gpio_write(FIRST, pins, LEVEL); }
};
template <int FIRST, bool OUTPUT_> struct GpioEnable {
    void operator=(uint32_t pins) { sketch_gpio_enable(FIRST, pins, OUTPUT_); }
};
template <typename T> struct GpioHigh {
    union { T val, data; };
};

/* Pins 0 to 31; those from 32 on behind `.val`, and of the C3 all. */
struct GpioRegisters {
#ifdef BOARD_ESP32C3
    GpioHigh<GpioInputs<0>> in;
    GpioHigh<GpioOutputs<0>> out;
    GpioHigh<GpioWrite<0, true>> out_w1ts;
    GpioHigh<GpioWrite<0, false>> out_w1tc;
    GpioHigh<GpioEnable<0, true>> enable_w1ts;
    GpioHigh<GpioEnable<0, false>> enable_w1tc;
#else
    GpioInputs<0> in;
    GpioOutputs<0> out;
    GpioWrite<0, true> out_w1ts;
    GpioWrite<0, false> out_w1tc;
    GpioEnable<0, true> enable_w1ts;
    GpioEnable<0, false> enable_w1tc;
    GpioHigh<GpioInputs<32>> in1;
    GpioHigh<GpioWrite<32, true>> out1_w1ts;
    GpioHigh<GpioWrite<32, false>> out1_w1tc;
    GpioHigh<GpioEnable<32, true>> enable1_w1ts;
    GpioHigh<GpioEnable<32, false>> enable1_w1tc;
#endif
};
extern GpioRegisters GPIO;

#endif
