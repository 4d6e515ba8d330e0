/* The registers are the emulator's; sketches include this without using any. */
#include "../Arduino.h"
