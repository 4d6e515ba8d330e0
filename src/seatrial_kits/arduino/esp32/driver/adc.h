/* The ADC is called by analogRead. */
#include "../Arduino.h"
