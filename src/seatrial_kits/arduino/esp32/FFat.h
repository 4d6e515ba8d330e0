/* FAT in the flash. */
#ifndef FFAT_H
#define FFAT_H
#include "FS.h"
extern fs::FS FFat;
#endif
