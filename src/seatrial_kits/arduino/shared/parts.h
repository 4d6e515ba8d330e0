/* Simulated I2C devices: registers as their data sheets have them, quantities from outside.
 *
 * MPU-6050: InvenSense RM-MPU-6000A, registers and sensitivities. HMC5883L: Honeywell
 * 900405 rev E. MS5837-30BA: TE ENG_DS_MS5837-30BA. Pixy: the CMUcam5's serial protocol, object
 * blocks, which on I2C are read as a stream. Axes are the body's: x bow, y starboard, z down.
 */
#ifndef SEATRIAL_PARTS_H
#define SEATRIAL_PARTS_H

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { PART_MPU6050 = 1, PART_HMC5883L, PART_MS5837, PART_PIXY };
enum { PIXY_BLOCKS = 6, PIXY_NUMBERS = 3 /* signature, x, width */ };
enum { Q_GYRO = 0, Q_FORCE = 3, Q_FIELD = 6, Q_PRESSURE = 9, Q_TEMPERATURE = 10, Q_FRAME = 11, Q_BLOCKS = 12, Q_BLOCK = 13,
    QUANTITIES = Q_BLOCK + PIXY_BLOCKS * PIXY_NUMBERS };

typedef struct {
    uint8_t type, address, pointer, pointed, command, reading;
    uint8_t registers[128];
    uint8_t latched[8];
    double frame;
} part;

static double part_quantities[QUANTITIES] = {
    0, 0, 0, 0, 0, -9.80665, 2e-5, 0, 0, 101325.0, 293.15,
};
static part parts[8];
static int part_count;
static part *part_open;

static void part_add(uint8_t type, uint8_t address)
{
    part *one = &parts[part_count++ & 7];
    memset(one, 0, sizeof *one);
    one->type = type;
    one->address = address;
    if (type == PART_MPU6050) {
        one->registers[0x6B] = 0x40; /* asleep */
        one->registers[0x75] = 0x68;
    } else if (type == PART_HMC5883L) {
        const uint8_t reset[] = {0x10, 0x20, 0x01};
        memcpy(one->registers, reset, sizeof reset);
        memcpy(one->registers + 10, "H43", 3);
    }
}

static int16_t part_rounded(double value, double least, double most)
{
    return (int16_t)lround(fmin(fmax(value, least), most));
}

static void part_store(uint8_t *to, int16_t value)
{
    to[0] = (uint8_t)((uint16_t)value >> 8);
    to[1] = (uint8_t)value;
}

/* Take in the measurements, at the beginning of a reading: bytes of one reading belong together. */
static void part_measure_motion(part *one)
{
    if (one->registers[0x6B] & 0x40)
        return;
    double per_g = 16384.0 / (1 << (one->registers[0x1C] >> 3 & 3));
    double per_dps = 131.0 / (1 << (one->registers[0x1B] >> 3 & 3));
    for (int axis = 0; axis < 3; axis++) {
        double force = part_quantities[Q_FORCE + axis] / 9.80665;
        double rate = part_quantities[Q_GYRO + axis] * 57.29577951308232;
        part_store(one->registers + 0x3B + 2 * axis, part_rounded(force * per_g, -32768, 32767));
        part_store(one->registers + 0x43 + 2 * axis, part_rounded(rate * per_dps, -32768, 32767));
    }
    double celsius = part_quantities[Q_TEMPERATURE] - 273.15;
    part_store(one->registers + 0x41, part_rounded((celsius - 36.53) * 340.0, -32768, 32767));
}

static void part_measure_field(part *one)
{
    static const double per_gauss[] = {1370, 1090, 820, 660, 440, 390, 330, 230};
    static const int place[] = {0, 2, 1}; /* x, z, y */
    static const double bias[] = {1.16, 1.16, 1.08}; /* gauss: a coil's, from which the field is taken */
    int test = one->registers[0] & 3;
    if ((one->registers[2] & 3) > 1)
        return;
    for (int axis = 0; axis < 3; axis++) {
        double gauss = part_quantities[Q_FIELD + axis] * 1e4;
        gauss = test == 1 ? bias[axis] : test == 2 ? -bias[axis] : gauss;
        double raw = gauss * per_gauss[one->registers[1] >> 5];
        int16_t value = fabs(raw) > 2047.5 ? -4096 : part_rounded(raw, -2048, 2047);
        part_store(one->registers + 3 + 2 * place[axis], value);
    }
    one->registers[9] = 1;
    if ((one->registers[2] & 3) == 1)
        one->registers[2] |= 2; /* a single measurement, then idle */
}

/* MS5837-30BA: the data sheet's example of calibration, and its compensation to second order. */
static const uint16_t part_prom[8] = {0, 34982, 36352, 20328, 22354, 26646, 26146, 0};

static double part_celsius(double d2, double *first_order)
{
    double dt = d2 - part_prom[5] * 256.0;
    double temp = 2000.0 + dt * part_prom[6] / 8388608.0;
    double ti = temp < 2000.0 ? 3.0 * dt * dt / 8589934592.0 : 2.0 * dt * dt / 137438953472.0;
    *first_order = temp;
    return (temp - ti) / 100.0;
}

static double part_pascal(double d1, double d2)
{
    double temp, dt = d2 - part_prom[5] * 256.0;
    (void)part_celsius(d2, &temp);
    double off = part_prom[2] * 65536.0 + part_prom[4] * dt / 128.0;
    double sens = part_prom[1] * 32768.0 + part_prom[3] * dt / 256.0;
    double t = (temp - 2000.0) * (temp - 2000.0), offi, sensi = 0.0;
    if (temp < 2000.0) {
        double cold = (temp + 1500.0) * (temp + 1500.0);
        offi = 3.0 * t / 2.0 + (temp < -1500.0 ? 7.0 * cold : 0.0);
        sensi = 5.0 * t / 8.0 + (temp < -1500.0 ? 4.0 * cold : 0.0);
    } else {
        offi = t / 16.0;
    }
    return (d1 * (sens - sensi) / 2097152.0 - (off - offi)) / 8192.0 * 10.0;
}

/* Both rise with their count: halve until it is found to the bit. */
static uint32_t part_count_of(double wanted, uint32_t d2, int pressure)
{
    uint32_t low = 0, high = (1u << 24) - 1;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        double unused, got = pressure ? part_pascal(middle, d2) : part_celsius(middle, &unused);
        if (got < wanted)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static uint8_t part_crc4(void)
{
    uint16_t words[8], remainder = 0;
    memcpy(words, part_prom, sizeof words);
    for (int byte = 0; byte < 16; byte++) {
        remainder ^= byte % 2 ? words[byte >> 1] & 0xFF : words[byte >> 1] >> 8;
        for (int bit = 0; bit < 8; bit++)
            remainder = (uint16_t)(remainder & 0x8000 ? remainder << 1 ^ 0x3000 : remainder << 1);
    }
    return remainder >> 12 & 0xF;
}

static void part_command_pressure(part *one, uint8_t command)
{
    int reads = command <= 0x1E || (command >= 0x40 && command <= 0x5A); /* others: nothing drives the bus */
    memset(one->latched, reads ? 0 : 0xFF, sizeof one->latched);
    if (command >= 0xA0 && command <= 0xAC) {
        uint16_t word = part_prom[(command - 0xA0) / 2];
        if (command == 0xA0)
            word = (uint16_t)(part_crc4() << 12);
        part_store(one->latched, (int16_t)word);
    } else if (command >= 0x40 && command <= 0x5A) {
        uint32_t d2 = part_count_of(part_quantities[Q_TEMPERATURE] - 273.15, 0, 0);
        uint32_t count = command >= 0x50 ? d2 : part_count_of(part_quantities[Q_PRESSURE], d2, 1);
        for (int byte = 0; byte < 3; byte++)
            one->registers[byte] = (uint8_t)(count >> (16 - 8 * byte));
    } else if (command == 0x00) {
        memcpy(one->latched, one->registers, 3);
    }
}

static void part_append(part *one, unsigned word)
{
    one->registers[one->command++] = (uint8_t)word;
    one->registers[one->command++] = (uint8_t)(word >> 8);
}

/* A frame begins with one sync more than its blocks have. What is left of the one before is dropped
 * at its end only: a master that is slow reads older blocks, never half of two. */
static void part_frame(part *one)
{
    if (one->pointer < one->command || one->frame == part_quantities[Q_FRAME])
        return;
    one->frame = part_quantities[Q_FRAME];
    one->pointer = one->command = 0;
    int blocks = (int)fmin(fmax(part_quantities[Q_BLOCKS], 0.0), PIXY_BLOCKS);
    if (blocks)
        part_append(one, 0xAA55);
    for (int block = 0; block < blocks; block++) {
        const double *of = part_quantities + Q_BLOCK + PIXY_NUMBERS * block;
        unsigned width = (unsigned)part_rounded(of[2], 1, 320);
        unsigned words[5] = {(unsigned)part_rounded(of[0], 1, 7), (unsigned)part_rounded(of[1], 0, 319), 100, width, width > 200 ? 200 : width};
        unsigned sum = 0;
        part_append(one, 0xAA55);
        for (int word = 0; word < 5; word++)
            sum += words[word];
        part_append(one, sum & 0xFFFF);
        for (int word = 0; word < 5; word++)
            part_append(one, words[word]);
    }
}

/* Address a device; returns whether one answers. */
static int part_begin(uint8_t address, int reading)
{
    part_open = 0;
    for (int each = 0; each < part_count; each++)
        if (parts[each].address == address)
            part_open = &parts[each];
    if (!part_open)
        return 0;
    part_open->pointed = 0;
    if (reading && part_open->type == PART_MPU6050)
        part_measure_motion(part_open);
    if (reading && part_open->type == PART_HMC5883L)
        part_measure_field(part_open);
    if (reading && part_open->type == PART_PIXY)
        part_frame(part_open);
    part_open->reading = 0;
    return 1;
}

static int part_write(uint8_t data)
{
    part *one = part_open;
    if (!one)
        return 0;
    if (one->type == PART_PIXY) {
        return 1; /* its servos and brightness are not there */
    } else if (one->type == PART_MS5837) {
        part_command_pressure(one, data);
    } else if (!one->pointed) {
        one->pointer = data & 127;
        one->pointed = 1;
    } else {
        one->registers[one->pointer] = data;
        one->pointer = (one->pointer + 1) & 127;
    }
    return 1;
}

static uint8_t part_read(void)
{
    part *one = part_open;
    if (!one)
        return 0xFF;
    if (one->type == PART_MS5837)
        return one->reading < 8 ? one->latched[one->reading++] : 0;
    if (one->type == PART_PIXY)
        return one->pointer < one->command ? one->registers[one->pointer++] : 0;
    uint8_t data = one->registers[one->pointer];
    one->pointer = (one->pointer + 1) & 127;
    if (one->type == PART_HMC5883L && one->pointer == 9)
        one->pointer = 3; /* data registers come round */
    return data;
}

#endif
