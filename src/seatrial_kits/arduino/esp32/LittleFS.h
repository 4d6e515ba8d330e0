/* The file system LittleFS. */
#ifndef LITTLEFS_H
#define LITTLEFS_H
#include "FS.h"
extern fs::FS LittleFS;
#endif
