/* Before each source of a sketch, and after all headers of the computer: double is float, and
 * structures have no padding, as on a board. */
#include "Arduino.h"
#pragma pack(1)
#define double float
