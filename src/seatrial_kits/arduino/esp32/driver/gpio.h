/* Pins by ESP-IDF's names. */
#ifndef DRIVER_GPIO_H
#define DRIVER_GPIO_H

#include "../Arduino.h"

typedef enum { GPIO_NUM_NC = -1, GPIO_NUM_0, GPIO_NUM_1, GPIO_NUM_2, GPIO_NUM_3, GPIO_NUM_4, GPIO_NUM_5, GPIO_NUM_6, GPIO_NUM_7, GPIO_NUM_8, GPIO_NUM_9, GPIO_NUM_10, GPIO_NUM_11, GPIO_NUM_12, GPIO_NUM_13, GPIO_NUM_14, GPIO_NUM_15, GPIO_NUM_16, GPIO_NUM_17, GPIO_NUM_18, GPIO_NUM_19, GPIO_NUM_20, GPIO_NUM_21, GPIO_NUM_22, GPIO_NUM_23, GPIO_NUM_25 = 25, GPIO_NUM_26, GPIO_NUM_27, GPIO_NUM_28, GPIO_NUM_29, GPIO_NUM_30, GPIO_NUM_31, GPIO_NUM_32, GPIO_NUM_33, GPIO_NUM_34, GPIO_NUM_35, GPIO_NUM_36, GPIO_NUM_37, GPIO_NUM_38, GPIO_NUM_39, GPIO_NUM_40, GPIO_NUM_41, GPIO_NUM_42, GPIO_NUM_43, GPIO_NUM_44, GPIO_NUM_45, GPIO_NUM_46, GPIO_NUM_47, GPIO_NUM_48 } gpio_num_t;
typedef enum { GPIO_MODE_DISABLE, GPIO_MODE_INPUT, GPIO_MODE_OUTPUT, GPIO_MODE_INPUT_OUTPUT } gpio_mode_t;
typedef enum { GPIO_PULLUP_ONLY, GPIO_PULLDOWN_ONLY, GPIO_PULLUP_PULLDOWN, GPIO_FLOATING } gpio_pull_mode_t;

inline esp_err_t gpio_set_level(gpio_num_t pin, uint32_t level) { digitalWrite((uint8_t)pin, level != 0); return ESP_OK; }
inline int gpio_get_level(gpio_num_t pin) { return digitalRead((uint8_t)pin); }
inline esp_err_t gpio_set_direction(gpio_num_t pin, gpio_mode_t mode) { pinMode((uint8_t)pin, mode >= GPIO_MODE_OUTPUT ? OUTPUT : INPUT); return ESP_OK; }
inline esp_err_t gpio_reset_pin(gpio_num_t pin) { pinMode((uint8_t)pin, INPUT_PULLUP); return ESP_OK; }
inline esp_err_t gpio_set_pull_mode(gpio_num_t pin, gpio_pull_mode_t mode) { pinMode((uint8_t)pin, mode == GPIO_PULLUP_ONLY ? INPUT_PULLUP : INPUT); return ESP_OK; }

#endif
