/* A card at the pins of SDMMC: see SD.h. */
#include "SD.h"
