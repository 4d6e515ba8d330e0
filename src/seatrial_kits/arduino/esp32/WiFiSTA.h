/* A part of WiFi.h. */
#include "WiFi.h"
