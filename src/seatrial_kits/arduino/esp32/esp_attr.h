/* Where code and data lie makes no difference here. */
#ifndef ESP_ATTR_H
#define ESP_ATTR_H
#define IRAM_ATTR
#define DRAM_ATTR
#define ARDUINO_ISR_ATTR
#define ICACHE_RAM_ATTR
#define ICACHE_FLASH_ATTR
#define RTC_DATA_ATTR
#define RTC_NOINIT_ATTR
#define RTC_FAST_ATTR
#define RTC_SLOW_ATTR
#define EXT_RAM_ATTR
#define WORD_ALIGNED_ATTR __attribute__((aligned(4)))
#endif
