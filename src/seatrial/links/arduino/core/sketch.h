/* Before each source of a sketch, and after all headers of the computer: double is float. */
#include "Arduino.h"
#define double float
