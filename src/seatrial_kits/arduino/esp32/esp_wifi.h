/* The radio below WiFi.h, as sketches set it beside ESP-NOW: nothing depends on it here. */
#ifndef ESP_WIFI_H
#define ESP_WIFI_H

#include "WiFi.h"
#include "esp_wifi_types.h"

inline esp_err_t esp_wifi_set_channel(uint8_t, wifi_second_chan_t) { return ESP_OK; }
inline esp_err_t esp_wifi_get_channel(uint8_t *first, wifi_second_chan_t *second) { *first = 1, *second = WIFI_SECOND_CHAN_NONE; return ESP_OK; }
inline esp_err_t esp_wifi_set_protocol(wifi_interface_t, uint8_t) { return ESP_OK; }
inline esp_err_t esp_wifi_set_ps(wifi_ps_type_t) { return ESP_OK; }
inline esp_err_t esp_wifi_set_max_tx_power(int8_t) { return ESP_OK; }
inline esp_err_t esp_wifi_set_mac(wifi_interface_t, const uint8_t *) { return ESP_OK; }
inline esp_err_t esp_wifi_get_mac(wifi_interface_t, uint8_t *mac) { return esp_efuse_mac_get_default(mac); }
inline esp_err_t esp_wifi_start() { return ESP_OK; }
inline esp_err_t esp_wifi_stop() { return ESP_OK; }
/* Other stations' frames are not heard: the handler is never called. */
inline esp_err_t esp_wifi_set_promiscuous(bool) { return ESP_OK; }
inline esp_err_t esp_wifi_set_promiscuous_filter(const wifi_promiscuous_filter_t *) { return ESP_OK; }
inline esp_err_t esp_wifi_set_promiscuous_rx_cb(wifi_promiscuous_cb_t) { return ESP_OK; }

#endif
