/* See ledc.h. */
#include "ledc.h"

#include "machine.h"

namespace {

constexpr int TIMERS = LEDC_TIMER_MAX, CHANNELS = LEDC_CHANNEL_MAX;

struct Timer {
    uint32_t hertz = 0;
    uint8_t bits = 0;
} timers[2 * TIMERS];
struct Channel {
    int timer = -1;
    uint32_t duty = 0;
} channels[2 * CHANNELS];

int timer_at(ledc_mode_t mode, ledc_timer_t timer) { return mode * TIMERS + timer; }
uint8_t channel_at(ledc_mode_t mode, ledc_channel_t channel) { return (uint8_t)(mode * CHANNELS + channel); }

} // namespace

esp_err_t ledc_timer_config(const ledc_timer_config_t *config)
{
    int timer = timer_at(config->speed_mode, config->timer_num);
    timers[timer] = {config->freq_hz, (uint8_t)config->duty_resolution};
    for (uint8_t each = 0; each < 2 * CHANNELS; each++)
        if (channels[each].timer == timer)
            ledcSetup(each, config->freq_hz, (uint8_t)config->duty_resolution);
    return config->freq_hz && config->duty_resolution <= LEDC_TIMER_20_BIT ? ESP_OK : ESP_ERR_INVALID_ARG;
}

esp_err_t ledc_channel_config(const ledc_channel_config_t *config)
{
    if (config->flags.output_invert)
        machine::end("ledc_channel_config: an inverted output is not here");
    uint8_t channel = channel_at(config->speed_mode, config->channel);
    channels[channel] = {timer_at(config->speed_mode, config->timer_sel), config->duty};
    const Timer &timer = timers[channels[channel].timer];
    if (timer.hertz)
        ledcSetup(channel, timer.hertz, timer.bits);
    ledcAttachPin((uint8_t)config->gpio_num, channel);
    return ledc_update_duty(config->speed_mode, config->channel);
}

esp_err_t ledc_set_duty(ledc_mode_t mode, ledc_channel_t channel, uint32_t duty)
{
    channels[channel_at(mode, channel)].duty = duty;
    return ESP_OK;
}

esp_err_t ledc_update_duty(ledc_mode_t mode, ledc_channel_t channel)
{
    uint8_t number = channel_at(mode, channel);
    ledcWriteChannel(number, channels[number].duty);
    return ESP_OK;
}

uint32_t ledc_get_duty(ledc_mode_t mode, ledc_channel_t channel) { return channels[channel_at(mode, channel)].duty; }

esp_err_t ledc_set_freq(ledc_mode_t mode, ledc_timer_t timer, uint32_t hertz)
{
    ledc_timer_config_t config = {mode, (ledc_timer_bit_t)timers[timer_at(mode, timer)].bits, timer, hertz, LEDC_AUTO_CLK};
    return ledc_timer_config(&config);
}

uint32_t ledc_get_freq(ledc_mode_t mode, ledc_timer_t timer) { return timers[timer_at(mode, timer)].hertz; }

esp_err_t ledc_stop(ledc_mode_t mode, ledc_channel_t channel, uint32_t idle_level)
{
    uint8_t number = channel_at(mode, channel);
    ledcWriteChannel(number, idle_level ? 1u << timers[channels[number].timer < 0 ? 0 : channels[number].timer].bits : 0);
    return ESP_OK;
}
