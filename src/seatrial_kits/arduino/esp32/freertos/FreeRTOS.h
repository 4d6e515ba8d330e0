/* FreeRTOS in simulated time: tasks of both cores take turns; a tick is 1 ms. */
#ifndef FREERTOS_H
#define FREERTOS_H

#include <stddef.h>
#include <stdint.h>

typedef int BaseType_t;
typedef unsigned UBaseType_t;
typedef uint32_t TickType_t;
typedef uint8_t StackType_t;
typedef struct Task *TaskHandle_t;
typedef struct Queue *QueueHandle_t, *SemaphoreHandle_t;
typedef struct Flags *EventGroupHandle_t;
typedef struct SoftTimer *TimerHandle_t;
typedef QueueHandle_t xQueueHandle;
typedef SemaphoreHandle_t xSemaphoreHandle;
typedef TaskHandle_t xTaskHandle;
typedef uint32_t EventBits_t;
typedef void (*TaskFunction_t)(void *argument);
typedef void (*TimerCallbackFunction_t)(TimerHandle_t timer);
typedef struct { void *nothing; } StaticTask_t, StaticSemaphore_t, StaticQueue_t;
typedef enum { eNoAction, eSetBits, eIncrement, eSetValueWithOverwrite, eSetValueWithoutOverwrite } eNotifyAction;

#define pdFALSE 0
#define pdTRUE 1
#define pdFAIL 0
#define pdPASS 1
#define errQUEUE_EMPTY 0
#define errQUEUE_FULL 0
#define portMAX_DELAY 0xffffffffUL
#define configTICK_RATE_HZ 1000
#define configMAX_PRIORITIES 25
#define configMINIMAL_STACK_SIZE 768
#define portTICK_PERIOD_MS 1
#define portTICK_RATE_MS 1
#define pdMS_TO_TICKS(ms) ((TickType_t)(ms))
#define pdTICKS_TO_MS(ticks) ((uint32_t)(ticks))
#define tskIDLE_PRIORITY 0
#define tskNO_AFFINITY 0x7FFFFFFF
#define PRO_CPU_NUM 0
#define APP_CPU_NUM 1
#define ARDUINO_RUNNING_CORE 1
#define CONFIG_ARDUINO_RUNNING_CORE 1

/* ------------------------------------------------------------------ tasks */

BaseType_t xTaskCreatePinnedToCore(TaskFunction_t code, const char *name, uint32_t stack, void *argument, UBaseType_t priority, TaskHandle_t *made, BaseType_t core);
inline BaseType_t xTaskCreate(TaskFunction_t code, const char *name, uint32_t stack, void *argument, UBaseType_t priority, TaskHandle_t *made) { return xTaskCreatePinnedToCore(code, name, stack, argument, priority, made, tskNO_AFFINITY); }
inline BaseType_t xTaskCreateUniversal(TaskFunction_t code, const char *name, uint32_t stack, void *argument, UBaseType_t priority, TaskHandle_t *made, BaseType_t core) { return xTaskCreatePinnedToCore(code, name, stack, argument, priority, made, core); }
void vTaskDelete(TaskHandle_t task);
void vTaskDelay(TickType_t ticks);
BaseType_t xTaskDelayUntil(TickType_t *last, TickType_t period);
inline void vTaskDelayUntil(TickType_t *last, TickType_t period) { xTaskDelayUntil(last, period); }
void taskYIELD();
#define portYIELD taskYIELD
#define vPortYield taskYIELD
/* A handler of an interrupt ends first: the task that it wakes goes on behind it. */
#define portYIELD_FROM_ISR(...) ((void)0)
void vTaskSuspend(TaskHandle_t task);
void vTaskResume(TaskHandle_t task);
void vTaskPrioritySet(TaskHandle_t task, UBaseType_t priority);
UBaseType_t uxTaskPriorityGet(TaskHandle_t task);
TickType_t xTaskGetTickCount();
inline TickType_t xTaskGetTickCountFromISR() { return xTaskGetTickCount(); }
TaskHandle_t xTaskGetCurrentTaskHandle();
TaskHandle_t xTaskGetHandle(const char *name);
char *pcTaskGetName(TaskHandle_t task);
#define pcTaskGetTaskName pcTaskGetName
UBaseType_t uxTaskGetStackHighWaterMark(TaskHandle_t task);
UBaseType_t uxTaskGetNumberOfTasks();
BaseType_t xPortGetCoreID();
BaseType_t xPortInIsrContext();
void vTaskSuspendAll();
BaseType_t xTaskResumeAll();
inline uint32_t xPortGetFreeHeapSize() { return 270000; }

BaseType_t xTaskGenericNotify(TaskHandle_t task, uint32_t value, eNotifyAction action);
inline BaseType_t xTaskNotify(TaskHandle_t task, uint32_t value, eNotifyAction action) { return xTaskGenericNotify(task, value, action); }
inline BaseType_t xTaskNotifyFromISR(TaskHandle_t task, uint32_t value, eNotifyAction action, BaseType_t *woken) { if (woken) *woken = pdTRUE; return xTaskGenericNotify(task, value, action); }
inline BaseType_t xTaskNotifyGive(TaskHandle_t task) { return xTaskGenericNotify(task, 0, eIncrement); }
inline void vTaskNotifyGiveFromISR(TaskHandle_t task, BaseType_t *woken) { xTaskNotifyFromISR(task, 0, eIncrement, woken); }
uint32_t ulTaskNotifyTake(BaseType_t clear, TickType_t ticks);
BaseType_t xTaskNotifyWait(uint32_t clear_before, uint32_t clear_after, uint32_t *value, TickType_t ticks);

/* ------------------------------------------------------------------ queues and semaphores */

QueueHandle_t xQueueCreate(UBaseType_t length, UBaseType_t size);
void vQueueDelete(QueueHandle_t queue);
BaseType_t sketch_queue_send(QueueHandle_t queue, const void *item, TickType_t ticks, bool front, bool over);
BaseType_t sketch_queue_take(QueueHandle_t queue, void *item, TickType_t ticks, bool keep);
inline BaseType_t xQueueSend(QueueHandle_t queue, const void *item, TickType_t ticks) { return sketch_queue_send(queue, item, ticks, false, false); }
#define xQueueSendToBack xQueueSend
inline BaseType_t xQueueSendToFront(QueueHandle_t queue, const void *item, TickType_t ticks) { return sketch_queue_send(queue, item, ticks, true, false); }
inline BaseType_t xQueueOverwrite(QueueHandle_t queue, const void *item) { return sketch_queue_send(queue, item, 0, false, true); }
inline BaseType_t xQueueSendFromISR(QueueHandle_t queue, const void *item, BaseType_t *woken) { if (woken) *woken = pdTRUE; return sketch_queue_send(queue, item, 0, false, false); }
#define xQueueSendToBackFromISR xQueueSendFromISR
inline BaseType_t xQueueOverwriteFromISR(QueueHandle_t queue, const void *item, BaseType_t *woken) { if (woken) *woken = pdTRUE; return xQueueOverwrite(queue, item); }
inline BaseType_t xQueueReceive(QueueHandle_t queue, void *item, TickType_t ticks) { return sketch_queue_take(queue, item, ticks, false); }
inline BaseType_t xQueueReceiveFromISR(QueueHandle_t queue, void *item, BaseType_t *) { return sketch_queue_take(queue, item, 0, false); }
inline BaseType_t xQueuePeek(QueueHandle_t queue, void *item, TickType_t ticks) { return sketch_queue_take(queue, item, ticks, true); }
BaseType_t xQueueReset(QueueHandle_t queue);
UBaseType_t uxQueueMessagesWaiting(QueueHandle_t queue);
UBaseType_t uxQueueSpacesAvailable(QueueHandle_t queue);
#define uxQueueMessagesWaitingFromISR uxQueueMessagesWaiting

SemaphoreHandle_t xSemaphoreCreateCounting(UBaseType_t most, UBaseType_t first);
inline SemaphoreHandle_t xSemaphoreCreateBinary() { return xSemaphoreCreateCounting(1, 0); }
#define vSemaphoreCreateBinary(made) ((made) = xSemaphoreCreateCounting(1, 1))
SemaphoreHandle_t xSemaphoreCreateMutex();
inline SemaphoreHandle_t xSemaphoreCreateRecursiveMutex() { return xSemaphoreCreateMutex(); }
BaseType_t xSemaphoreTake(SemaphoreHandle_t semaphore, TickType_t ticks);
BaseType_t xSemaphoreGive(SemaphoreHandle_t semaphore);
BaseType_t xSemaphoreTakeRecursive(SemaphoreHandle_t mutex, TickType_t ticks);
BaseType_t xSemaphoreGiveRecursive(SemaphoreHandle_t mutex);
inline BaseType_t xSemaphoreTakeFromISR(SemaphoreHandle_t semaphore, BaseType_t *) { return xSemaphoreTake(semaphore, 0); }
inline BaseType_t xSemaphoreGiveFromISR(SemaphoreHandle_t semaphore, BaseType_t *woken) { if (woken) *woken = pdTRUE; return xSemaphoreGive(semaphore); }
inline UBaseType_t uxSemaphoreGetCount(SemaphoreHandle_t semaphore) { return uxQueueMessagesWaiting(semaphore); }
inline void vSemaphoreDelete(SemaphoreHandle_t semaphore) { vQueueDelete(semaphore); }

/* ------------------------------------------------------------------ event groups and timers */

EventGroupHandle_t xEventGroupCreate();
void vEventGroupDelete(EventGroupHandle_t group);
EventBits_t xEventGroupSetBits(EventGroupHandle_t group, EventBits_t bits);
inline BaseType_t xEventGroupSetBitsFromISR(EventGroupHandle_t group, EventBits_t bits, BaseType_t *woken) { if (woken) *woken = pdTRUE; xEventGroupSetBits(group, bits); return pdPASS; }
EventBits_t xEventGroupClearBits(EventGroupHandle_t group, EventBits_t bits);
EventBits_t xEventGroupGetBits(EventGroupHandle_t group);
EventBits_t xEventGroupWaitBits(EventGroupHandle_t group, EventBits_t bits, BaseType_t clear, BaseType_t all, TickType_t ticks);

TimerHandle_t xTimerCreate(const char *name, TickType_t period, UBaseType_t again, void *id, TimerCallbackFunction_t callback);
BaseType_t xTimerStart(TimerHandle_t timer, TickType_t ticks);
BaseType_t xTimerStop(TimerHandle_t timer, TickType_t ticks);
BaseType_t xTimerReset(TimerHandle_t timer, TickType_t ticks);
BaseType_t xTimerDelete(TimerHandle_t timer, TickType_t ticks);
BaseType_t xTimerChangePeriod(TimerHandle_t timer, TickType_t period, TickType_t ticks);
BaseType_t xTimerIsTimerActive(TimerHandle_t timer);
void *pvTimerGetTimerID(TimerHandle_t timer);

/* ------------------------------------------------------------------ critical sections */

typedef struct { uint32_t owner, count; } portMUX_TYPE;
#define portMUX_INITIALIZER_UNLOCKED {0xB33FFFFF, 0}
#define portMUX_INITIALIZE(mux) ((void)(mux))
#define spinlock_initialize(mux) ((void)(mux))
void sketch_enter_critical();
void sketch_exit_critical();
#define portENTER_CRITICAL(...) sketch_enter_critical()
#define portEXIT_CRITICAL(...) sketch_exit_critical()
#define portENTER_CRITICAL_ISR portENTER_CRITICAL
#define portEXIT_CRITICAL_ISR portEXIT_CRITICAL
#define portENTER_CRITICAL_SAFE portENTER_CRITICAL
#define portEXIT_CRITICAL_SAFE portEXIT_CRITICAL
#define taskENTER_CRITICAL portENTER_CRITICAL
#define taskEXIT_CRITICAL portEXIT_CRITICAL
#define taskENTER_CRITICAL_ISR portENTER_CRITICAL
#define taskEXIT_CRITICAL_ISR portEXIT_CRITICAL
#define portDISABLE_INTERRUPTS sketch_enter_critical
#define portENABLE_INTERRUPTS sketch_exit_critical

#endif
