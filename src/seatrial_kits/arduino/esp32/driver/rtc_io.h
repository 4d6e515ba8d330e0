/* Pins of the sleeping chip: all of them are the ordinary ones here. */
#ifndef DRIVER_RTC_IO_H
#define DRIVER_RTC_IO_H
#include "gpio.h"
inline bool rtc_gpio_is_valid_gpio(gpio_num_t) { return false; }
inline esp_err_t rtc_gpio_deinit(gpio_num_t) { return ESP_OK; }
#endif
