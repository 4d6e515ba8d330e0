/* A part of esp32-hal.h. */
#include "esp32-hal.h"
