/* The chip itself. */
#ifndef ESP_H
#define ESP_H

#include "esp_system.h"

class EspClass {
public:
    [[noreturn]] void restart() { esp_restart(); }
    uint32_t getFreeHeap() { return esp_get_free_heap_size(); }
    uint32_t getMinFreeHeap() { return esp_get_free_heap_size(); }
    uint32_t getMaxAllocHeap() { return 110580; }
    uint32_t getHeapSize() { return 327680; }
    uint32_t getPsramSize() { return 0; }
    uint32_t getFreePsram() { return 0; }
    uint64_t getEfuseMac();
    const char *getChipModel();
    uint8_t getChipRevision() { return 3; }
    uint8_t getChipCores();
    uint32_t getCpuFreqMHz() { return 240; }
    uint32_t getCycleCount();
    const char *getSdkVersion() { return "v4.4.7"; }
    uint32_t getFlashChipSize() { return 4194304; }
    uint32_t getSketchSize() { return 1048576; }
    uint32_t getFreeSketchSpace() { return 1310720; }
};

extern EspClass ESP;

#endif
