/* From counts of the ADC to millivolts, linear as it is here. */
#ifndef ESP_ADC_CAL_H
#define ESP_ADC_CAL_H

#include "driver/adc.h"

typedef enum { ESP_ADC_CAL_VAL_EFUSE_VREF, ESP_ADC_CAL_VAL_EFUSE_TP, ESP_ADC_CAL_VAL_DEFAULT_VREF } esp_adc_cal_value_t;
typedef struct {
    double full_mv;
    uint32_t most, vref;
} esp_adc_cal_characteristics_t;

inline esp_adc_cal_value_t esp_adc_cal_characterize(adc_unit_t, adc_atten_t attenuation, adc_bits_width_t width, uint32_t vref, esp_adc_cal_characteristics_t *made)
{
    const double full_mv[] = {1100.0, 1500.0, 2200.0, 3300.0};
    *made = {full_mv[attenuation], (512u << width) - 1, vref};
    return ESP_ADC_CAL_VAL_EFUSE_VREF;
}

inline uint32_t esp_adc_cal_raw_to_voltage(uint32_t raw, const esp_adc_cal_characteristics_t *made) { return (uint32_t)lround(raw * made->full_mv / made->most); }

#endif
