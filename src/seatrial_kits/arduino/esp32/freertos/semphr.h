/* All of it is in one header. */
#include "FreeRTOS.h"
