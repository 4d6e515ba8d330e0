/* LEDC is called by Arduino-ESP32's functions. */
#include "../Arduino.h"
