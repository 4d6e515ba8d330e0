/* A board's pins, for libraries that include them by themselves. */
#include "Arduino.h"
