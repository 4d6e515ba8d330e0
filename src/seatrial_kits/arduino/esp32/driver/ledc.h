/* PWM by ESP-IDF's names: its timers are a frequency and bits of Arduino-ESP32's channels. */
#ifndef DRIVER_LEDC_H
#define DRIVER_LEDC_H

#include "gpio.h"

typedef enum { LEDC_HIGH_SPEED_MODE, LEDC_LOW_SPEED_MODE, LEDC_SPEED_MODE_MAX } ledc_mode_t;
typedef enum { LEDC_TIMER_0, LEDC_TIMER_1, LEDC_TIMER_2, LEDC_TIMER_3, LEDC_TIMER_MAX } ledc_timer_t;
typedef enum { LEDC_CHANNEL_0, LEDC_CHANNEL_1, LEDC_CHANNEL_2, LEDC_CHANNEL_3, LEDC_CHANNEL_4, LEDC_CHANNEL_5, LEDC_CHANNEL_6, LEDC_CHANNEL_7, LEDC_CHANNEL_MAX } ledc_channel_t;
typedef enum { LEDC_TIMER_1_BIT = 1, LEDC_TIMER_2_BIT, LEDC_TIMER_3_BIT, LEDC_TIMER_4_BIT, LEDC_TIMER_5_BIT, LEDC_TIMER_6_BIT, LEDC_TIMER_7_BIT, LEDC_TIMER_8_BIT, LEDC_TIMER_9_BIT, LEDC_TIMER_10_BIT, LEDC_TIMER_11_BIT, LEDC_TIMER_12_BIT, LEDC_TIMER_13_BIT, LEDC_TIMER_14_BIT, LEDC_TIMER_15_BIT, LEDC_TIMER_16_BIT, LEDC_TIMER_17_BIT, LEDC_TIMER_18_BIT, LEDC_TIMER_19_BIT, LEDC_TIMER_20_BIT } ledc_timer_bit_t;
typedef enum { LEDC_AUTO_CLK, LEDC_USE_REF_TICK, LEDC_USE_APB_CLK, LEDC_USE_RTC8M_CLK } ledc_clk_cfg_t;
typedef enum { LEDC_INTR_DISABLE, LEDC_INTR_FADE_END } ledc_intr_type_t;

typedef struct {
    ledc_mode_t speed_mode;
    ledc_timer_bit_t duty_resolution;
    ledc_timer_t timer_num;
    uint32_t freq_hz;
    ledc_clk_cfg_t clk_cfg;
} ledc_timer_config_t;
typedef struct {
    int gpio_num;
    ledc_mode_t speed_mode;
    ledc_channel_t channel;
    ledc_intr_type_t intr_type;
    ledc_timer_t timer_sel;
    uint32_t duty;
    int hpoint;
    struct { unsigned output_invert : 1; } flags;
} ledc_channel_config_t;

esp_err_t ledc_timer_config(const ledc_timer_config_t *config);
esp_err_t ledc_channel_config(const ledc_channel_config_t *config);
esp_err_t ledc_set_duty(ledc_mode_t mode, ledc_channel_t channel, uint32_t duty); /* takes effect by the update */
esp_err_t ledc_update_duty(ledc_mode_t mode, ledc_channel_t channel);
uint32_t ledc_get_duty(ledc_mode_t mode, ledc_channel_t channel);
esp_err_t ledc_set_freq(ledc_mode_t mode, ledc_timer_t timer, uint32_t hertz);
uint32_t ledc_get_freq(ledc_mode_t mode, ledc_timer_t timer);
esp_err_t ledc_stop(ledc_mode_t mode, ledc_channel_t channel, uint32_t idle_level);

#endif
