/* ESP-IDF's logs, as Arduino-ESP32 has them. */
#ifndef ESP_LOG_H
#define ESP_LOG_H
#include "esp32-hal-log.h"
typedef enum { ESP_LOG_NONE, ESP_LOG_ERROR, ESP_LOG_WARN, ESP_LOG_INFO, ESP_LOG_DEBUG, ESP_LOG_VERBOSE } esp_log_level_t;
inline void esp_log_level_set(const char *, esp_log_level_t) {}
#define SKETCH_TAGGED(log, tag, format, ...) log("[%s] " format, tag, ##__VA_ARGS__)
#define ESP_LOGE(tag, format, ...) SKETCH_TAGGED(log_e, tag, format, ##__VA_ARGS__)
#define ESP_LOGW(tag, format, ...) SKETCH_TAGGED(log_w, tag, format, ##__VA_ARGS__)
#define ESP_LOGI(tag, format, ...) SKETCH_TAGGED(log_i, tag, format, ##__VA_ARGS__)
#define ESP_LOGD(tag, format, ...) SKETCH_TAGGED(log_d, tag, format, ##__VA_ARGS__)
#define ESP_LOGV(tag, format, ...) SKETCH_TAGGED(log_v, tag, format, ##__VA_ARGS__)
#endif
