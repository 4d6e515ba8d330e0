/* The watchdog of tasks. */
#include "esp_task_wdt.h"

#include <map>

#include "machine.h"

static uint64_t limit; /* of the machine's time; 0: off, or it only says that it was late */
static std::map<TaskHandle_t, bool> joined; /* whether they have reset it since it last began */

static esp_err_t begin(uint64_t ms, bool panic)
{
    limit = panic ? ms * 16000 : 0;
    machine::watchdog(joined.empty() ? 0 : limit);
    return ESP_OK;
}

static TaskHandle_t task_of(TaskHandle_t task) { return task ? task : xTaskGetCurrentTaskHandle(); }

esp_err_t esp_task_wdt_init(uint32_t seconds, bool panic) { return begin(1000ull * seconds, panic); }
esp_err_t esp_task_wdt_init(const esp_task_wdt_config_t *config) { return begin(config->timeout_ms, config->trigger_panic); }
esp_err_t esp_task_wdt_reconfigure(const esp_task_wdt_config_t *config) { return esp_task_wdt_init(config); }
esp_err_t esp_task_wdt_deinit() { joined.clear(); machine::watchdog(0); return ESP_OK; }
esp_err_t esp_task_wdt_status(TaskHandle_t task) { return joined.count(task_of(task)) ? ESP_OK : ESP_ERR_NOT_FOUND; }

esp_err_t esp_task_wdt_add(TaskHandle_t task)
{
    if (joined.empty())
        machine::watchdog(limit);
    joined[task_of(task)] = false;
    return ESP_OK;
}

esp_err_t esp_task_wdt_delete(TaskHandle_t task)
{
    if (!joined.erase(task_of(task)))
        return ESP_ERR_NOT_FOUND;
    if (joined.empty())
        machine::watchdog(0);
    return ESP_OK;
}

esp_err_t esp_task_wdt_reset()
{
    auto own = joined.find(xTaskGetCurrentTaskHandle());
    if (own == joined.end())
        return ESP_ERR_NOT_FOUND;
    own->second = true;
    for (const auto &each : joined)
        if (!each.second)
            return ESP_OK;
    for (auto &each : joined)
        each.second = false;
    machine::watchdog(limit);
    return ESP_OK;
}
