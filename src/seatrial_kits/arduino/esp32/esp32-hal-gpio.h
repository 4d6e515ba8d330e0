/* A part of Arduino.h. */
#include "Arduino.h"
