/* Registers by their addresses: of those that sketches write, the brown-out detector's alone, which nothing depends on. */
#ifndef SOC_SOC_H
#define SOC_SOC_H

#define WRITE_PERI_REG(place, value) ((void)(sketch_register::place), (void)(value))
#define CLEAR_PERI_REG_MASK WRITE_PERI_REG

#endif
