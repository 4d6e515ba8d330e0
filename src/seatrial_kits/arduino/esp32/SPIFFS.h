/* The file system SPIFFS. */
#ifndef SPIFFS_H
#define SPIFFS_H
#include "FS.h"
extern fs::FS SPIFFS;
#endif
