/* The first ADC by ESP-IDF's names: its channels are pins of analogRead. */
#ifndef DRIVER_ADC_H
#define DRIVER_ADC_H

#include "../Arduino.h"

typedef enum { ADC_UNIT_1 = 1, ADC_UNIT_2 } adc_unit_t;
typedef enum { ADC1_CHANNEL_0, ADC1_CHANNEL_1, ADC1_CHANNEL_2, ADC1_CHANNEL_3, ADC1_CHANNEL_4, ADC1_CHANNEL_5, ADC1_CHANNEL_6, ADC1_CHANNEL_7, ADC1_CHANNEL_8, ADC1_CHANNEL_9, ADC1_CHANNEL_MAX } adc1_channel_t;
typedef enum { ADC_WIDTH_BIT_9, ADC_WIDTH_BIT_10, ADC_WIDTH_BIT_11, ADC_WIDTH_BIT_12 } adc_bits_width_t;
typedef adc_attenuation_t adc_atten_t;
#define ADC_ATTEN_DB_0 ADC_0db
#define ADC_ATTEN_DB_2_5 ADC_2_5db
#define ADC_ATTEN_DB_6 ADC_6db
#define ADC_ATTEN_DB_11 ADC_11db
#define ADC_ATTEN_DB_12 ADC_11db

inline uint8_t sketch_adc1_pin(adc1_channel_t channel)
{
#if defined(BOARD_ESP32S3)
    return (uint8_t)(channel + 1);
#elif defined(BOARD_ESP32C3)
    return (uint8_t)channel;
#else
    return (uint8_t)(channel < ADC1_CHANNEL_4 ? 36 + channel : 28 + channel);
#endif
}

inline esp_err_t adc1_config_width(adc_bits_width_t width) { analogReadResolution((uint8_t)(9 + width)); return ESP_OK; }
inline esp_err_t adc1_config_channel_atten(adc1_channel_t channel, adc_atten_t attenuation) { analogSetPinAttenuation(sketch_adc1_pin(channel), attenuation); return ESP_OK; }
inline int adc1_get_raw(adc1_channel_t channel) { return analogRead(sketch_adc1_pin(channel)); }

#endif
