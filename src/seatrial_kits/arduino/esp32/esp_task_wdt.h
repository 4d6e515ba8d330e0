/* The watchdog of tasks: it restarts the board unless each task that has joined resets it in time. */
#ifndef ESP_TASK_WDT_H
#define ESP_TASK_WDT_H

#include "Arduino.h"

/* Of Arduino-ESP32 3. */
typedef struct {
    uint32_t timeout_ms, idle_core_mask;
    bool trigger_panic;
} esp_task_wdt_config_t;

esp_err_t esp_task_wdt_init(uint32_t seconds, bool panic);
esp_err_t esp_task_wdt_init(const esp_task_wdt_config_t *config);
esp_err_t esp_task_wdt_reconfigure(const esp_task_wdt_config_t *config);
esp_err_t esp_task_wdt_deinit();
esp_err_t esp_task_wdt_add(TaskHandle_t task);
esp_err_t esp_task_wdt_delete(TaskHandle_t task);
esp_err_t esp_task_wdt_reset();
esp_err_t esp_task_wdt_status(TaskHandle_t task);

#endif
