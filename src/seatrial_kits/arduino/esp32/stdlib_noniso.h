/* Where the board has what libc.h declares. */
#include "libc.h"
