/* FreeRTOS's queues, semaphores and event groups. */
#include <deque>
#include <string>

#include "Arduino.h"
#include "freertos/event_groups.h"
#include "machine.h"
#include "tasks.h"

using machine::charge;

struct Queue {
    size_t length, size;
    std::deque<std::string> items;
    bool mutex = false;
    TaskHandle_t owner = nullptr; /* of a mutex that is taken */
    int depth = 0;
};

QueueHandle_t xQueueCreate(UBaseType_t length, UBaseType_t size) { charge(160); return length ? new Queue{length, size, {}} : nullptr; }
void vQueueDelete(QueueHandle_t queue) { delete queue; }
BaseType_t xQueueReset(QueueHandle_t queue) { queue->items.clear(); return pdPASS; }
UBaseType_t uxQueueMessagesWaiting(QueueHandle_t queue) { charge(4); return (UBaseType_t)queue->items.size(); }
UBaseType_t uxQueueSpacesAvailable(QueueHandle_t queue) { return (UBaseType_t)(queue->length - queue->items.size()); }

BaseType_t sketch_queue_send(QueueHandle_t queue, const void *item, TickType_t ticks, bool front, bool over)
{
    if (over)
        queue->items.clear();
    if (!wait_until(after_ticks(ticks), [=] { return queue->items.size() < queue->length; }))
        return errQUEUE_FULL;
    std::string copy((const char *)item, queue->size);
    if (front)
        queue->items.push_front(copy);
    else
        queue->items.push_back(copy);
    let_others();
    return pdPASS;
}

BaseType_t sketch_queue_take(QueueHandle_t queue, void *item, TickType_t ticks, bool keep)
{
    if (!wait_until(after_ticks(ticks), [=] { return !queue->items.empty(); }))
        return errQUEUE_EMPTY;
    memcpy(item, queue->items.front().data(), queue->size);
    if (!keep)
        queue->items.pop_front();
    let_others();
    return pdPASS;
}

/* ------------------------------------------------------------------ semaphores */

SemaphoreHandle_t xSemaphoreCreateCounting(UBaseType_t most, UBaseType_t first)
{
    QueueHandle_t made = xQueueCreate(most, 0);
    made->items.assign(first, "");
    return made;
}

SemaphoreHandle_t xSemaphoreCreateMutex()
{
    SemaphoreHandle_t made = xSemaphoreCreateCounting(1, 1);
    made->mutex = true;
    return made;
}

BaseType_t xSemaphoreTake(SemaphoreHandle_t semaphore, TickType_t ticks)
{
    if (!wait_until(after_ticks(ticks), [=] { return !semaphore->items.empty(); }))
        return pdFALSE;
    semaphore->items.pop_front();
    semaphore->owner = xTaskGetCurrentTaskHandle();
    return pdTRUE;
}

BaseType_t xSemaphoreGive(SemaphoreHandle_t semaphore)
{
    charge(16);
    if (semaphore->items.size() >= semaphore->length)
        return pdFALSE;
    if (semaphore->mutex && semaphore->owner != xTaskGetCurrentTaskHandle())
        machine::end("the task %s gives a mutex that %s has taken", pcTaskGetName(nullptr), pcTaskGetName(semaphore->owner));
    semaphore->items.push_back("");
    semaphore->owner = nullptr;
    let_others();
    return pdTRUE;
}

BaseType_t xSemaphoreTakeRecursive(SemaphoreHandle_t mutex, TickType_t ticks)
{
    if (mutex->owner != xTaskGetCurrentTaskHandle() && !xSemaphoreTake(mutex, ticks))
        return pdFALSE;
    mutex->depth++;
    return pdTRUE;
}

BaseType_t xSemaphoreGiveRecursive(SemaphoreHandle_t mutex)
{
    if (mutex->owner != xTaskGetCurrentTaskHandle())
        return pdFALSE;
    return --mutex->depth ? pdTRUE : xSemaphoreGive(mutex);
}

/* ------------------------------------------------------------------ event groups */

struct Flags {
    EventBits_t bits = 0;
};

EventGroupHandle_t xEventGroupCreate() { return new Flags; }
void vEventGroupDelete(EventGroupHandle_t group) { delete group; }
EventBits_t xEventGroupGetBits(EventGroupHandle_t group) { charge(4); return group->bits; }

EventBits_t xEventGroupSetBits(EventGroupHandle_t group, EventBits_t bits)
{
    charge(16);
    group->bits |= bits;
    let_others();
    return group->bits;
}

EventBits_t xEventGroupClearBits(EventGroupHandle_t group, EventBits_t bits)
{
    charge(16);
    EventBits_t before = group->bits;
    group->bits &= ~bits;
    return before;
}

EventBits_t xEventGroupWaitBits(EventGroupHandle_t group, EventBits_t bits, BaseType_t clear, BaseType_t all, TickType_t ticks)
{
    bool came = wait_until(after_ticks(ticks), [=] { return all ? (group->bits & bits) == bits : (group->bits & bits) != 0; });
    EventBits_t found = group->bits;
    if (came && clear)
        group->bits &= ~bits;
    return found;
}
