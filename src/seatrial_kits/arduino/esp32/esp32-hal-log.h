/* Logs: by default Arduino-ESP32 has none but the errors. */
#ifndef ESP32_HAL_LOG_H
#define ESP32_HAL_LOG_H

#ifndef CORE_DEBUG_LEVEL
#define CORE_DEBUG_LEVEL 0
#endif
#define ARDUHAL_LOG_LEVEL CORE_DEBUG_LEVEL

void sketch_log(char letter, const char *file, int line, const char *function, const char *format, ...) __attribute__((format(printf, 5, 6)));
#define SKETCH_LOG(level, letter, ...) do { if (CORE_DEBUG_LEVEL >= level) sketch_log(letter, __FILE__, __LINE__, __FUNCTION__, __VA_ARGS__); } while (0)
#define log_e(...) SKETCH_LOG(1, 'E', __VA_ARGS__)
#define log_w(...) SKETCH_LOG(2, 'W', __VA_ARGS__)
#define log_i(...) SKETCH_LOG(3, 'I', __VA_ARGS__)
#define log_d(...) SKETCH_LOG(4, 'D', __VA_ARGS__)
#define log_v(...) SKETCH_LOG(5, 'V', __VA_ARGS__)

#endif
