/* Timers: of the hardware (interrupts), and of ESP-IDF and FreeRTOS (callbacks of a task of their own). */
#include <algorithm>
#include <vector>

#include "Arduino.h"
#include "freertos/timers.h"
#include "machine.h"
#include "tasks.h"

using machine::charge;

constexpr uint64_t OFF = UINT64_MAX;

/* ------------------------------------------------------------------ of the hardware */

struct hw_timer_s {
    double unit = 16.0; /* of the machine's, a count */
    uint64_t counted = 0, since = 0; /* count, and when it was so */
    bool runs = true, armed = false, again = false;
    uint64_t value = OFF;
    std::function<void()> handler;
    int alarm = -1;
};

static uint64_t count_of(const hw_timer_t *timer)
{
    return timer->counted + (timer->runs ? (uint64_t)((double)(machine::now - timer->since) / timer->unit + 1e-9) : 0);
}

static void plan(hw_timer_t *timer)
{
    bool due = timer->runs && timer->armed && timer->value != OFF;
    uint64_t left = due && timer->value > timer->counted ? timer->value - timer->counted : 0;
    machine::set_alarm(timer->alarm, due ? timer->since + (uint64_t)(timer->unit * (double)left) : OFF);
}

static void set_count(hw_timer_t *timer, uint64_t value)
{
    timer->counted = value;
    timer->since = machine::now;
    plan(timer);
}

static void fire(void *argument)
{
    hw_timer_t *timer = (hw_timer_t *)argument;
    if (timer->again && timer->value) { /* it begins at zero, at the time that was due */
        timer->since += (uint64_t)(timer->unit * (double)(timer->value - timer->counted));
        timer->counted = 0;
    } else {
        timer->armed = false;
    }
    plan(timer);
    if (timer->handler)
        timer->handler();
}

static hw_timer_t *new_timer(double unit)
{
    charge(160);
    hw_timer_t *timer = new hw_timer_t;
    timer->unit = unit;
    timer->since = machine::now;
    timer->alarm = machine::new_alarm(fire, timer);
    return timer;
}

static hw_timer_t *timers_by_number[4];

hw_timer_t *timerBegin(uint8_t number, uint16_t divider, bool)
{
    if (number > 3 || divider < 2)
        return nullptr;
    hw_timer_t *&timer = timers_by_number[number];
    if (!timer)
        timer = new_timer(0.0);
    timer->unit = machine::CLOCK / 80e6 * divider;
    set_count(timer, 0);
    return timer;
}

hw_timer_t *timerBegin(uint32_t frequency) { return frequency ? new_timer(machine::CLOCK / frequency) : nullptr; }
void timerEnd(hw_timer_t *timer) { timer->armed = timer->runs = false; plan(timer); }
void timerAttachInterrupt(hw_timer_t *timer, void (*handler)(), bool) { charge(40); timer->handler = handler; }
void timerAttachInterruptArg(hw_timer_t *timer, void (*handler)(void *), void *argument) { timer->handler = [=] { handler(argument); }; }
void timerDetachInterrupt(hw_timer_t *timer) { timer->handler = nullptr; }
void timerAlarmWrite(hw_timer_t *timer, uint64_t value, bool again) { timer->value = value; timer->again = again; plan(timer); }
void timerAlarmEnable(hw_timer_t *timer) { charge(8); timer->armed = true; plan(timer); }
void timerAlarmDisable(hw_timer_t *timer) { charge(8); timer->armed = false; plan(timer); }
bool timerAlarmEnabled(hw_timer_t *timer) { return timer->armed; }
void timerAlarm(hw_timer_t *timer, uint64_t value, bool again, uint64_t) { timerAlarmWrite(timer, value, again); timerAlarmEnable(timer); }
void timerStart(hw_timer_t *timer) { timer->runs = true; set_count(timer, timer->counted); }
void timerRestart(hw_timer_t *timer) { set_count(timer, 0); }
void timerWrite(hw_timer_t *timer, uint64_t value) { set_count(timer, value); }
uint64_t timerRead(hw_timer_t *timer) { charge(4); return count_of(timer); }
uint64_t timerReadMicros(hw_timer_t *timer) { return (uint64_t)((double)timerRead(timer) * timer->unit / 16.0); }
uint64_t timerReadMilis(hw_timer_t *timer) { return timerReadMicros(timer) / 1000; }

void timerStop(hw_timer_t *timer)
{
    timer->counted = count_of(timer);
    timer->runs = false;
    plan(timer);
}

/* ------------------------------------------------------------------ of a task */

struct SoftTimer {
    std::function<void()> callback;
    uint64_t period = 0, due = OFF;
    bool again = false;
    void *id = nullptr;
};

static std::vector<SoftTimer *> soft_timers;
static bool changed;

static uint64_t next_timer()
{
    uint64_t soonest = OFF;
    for (SoftTimer *one : soft_timers)
        soonest = std::min(soonest, one->due);
    return soonest;
}

static void serve_timers(void *)
{
    for (;;) {
        changed = false;
        wait_until(next_timer(), [] { return changed; });
        for (size_t each = 0; each < soft_timers.size(); each++) {
            SoftTimer *one = soft_timers[each];
            if (one->due > machine::now)
                continue;
            one->due = one->again ? one->due + one->period : OFF;
            one->callback();
        }
    }
}

static SoftTimer *new_soft_timer(uint64_t period, bool again, std::function<void()> callback)
{
    static bool begun = false;
    soft_timers.push_back(new SoftTimer{callback, period, OFF, again});
    if (!begun) {
        begun = true;
        xTaskCreatePinnedToCore(serve_timers, "esp_timer", 4096, nullptr, 22, nullptr, 0);
    }
    return soft_timers.back();
}

static void start(SoftTimer *timer, uint64_t due)
{
    charge(16);
    timer->due = due;
    changed = true;
    let_others();
}

static void drop(SoftTimer *timer) { soft_timers.erase(std::remove(soft_timers.begin(), soft_timers.end(), timer), soft_timers.end()); }

struct esp_timer : SoftTimer {};

esp_err_t esp_timer_create(const esp_timer_create_args_t *given, esp_timer_handle_t *made)
{
    esp_timer_cb_t call = given->callback;
    void *argument = given->arg;
    *made = (esp_timer_handle_t)new_soft_timer(0, false, [=] { call(argument); });
    return ESP_OK;
}

static esp_err_t start(esp_timer_handle_t timer, uint64_t us, bool again)
{
    if (timer->due != OFF)
        return ESP_ERR_INVALID_STATE;
    timer->period = us * 16;
    timer->again = again;
    start(timer, machine::now + timer->period);
    return ESP_OK;
}

esp_err_t esp_timer_start_periodic(esp_timer_handle_t timer, uint64_t period) { return start(timer, period, true); }
esp_err_t esp_timer_start_once(esp_timer_handle_t timer, uint64_t timeout) { return start(timer, timeout, false); }
bool esp_timer_is_active(esp_timer_handle_t timer) { return timer->due != OFF; }
esp_err_t esp_timer_delete(esp_timer_handle_t timer) { drop(timer); return ESP_OK; }

esp_err_t esp_timer_stop(esp_timer_handle_t timer)
{
    if (timer->due == OFF)
        return ESP_ERR_INVALID_STATE;
    timer->due = OFF;
    return ESP_OK;
}

TimerHandle_t xTimerCreate(const char *, TickType_t period, UBaseType_t again, void *id, TimerCallbackFunction_t callback)
{
    TimerHandle_t made = new_soft_timer(period * 16000ull, again, nullptr);
    made->id = id;
    made->callback = [=] { callback(made); };
    return made;
}

BaseType_t xTimerStart(TimerHandle_t timer, TickType_t) { start(timer, machine::now + timer->period); return pdPASS; }
BaseType_t xTimerReset(TimerHandle_t timer, TickType_t) { return xTimerStart(timer, 0); }
BaseType_t xTimerStop(TimerHandle_t timer, TickType_t) { timer->due = OFF; return pdPASS; }
BaseType_t xTimerDelete(TimerHandle_t timer, TickType_t) { drop(timer); return pdPASS; }
BaseType_t xTimerIsTimerActive(TimerHandle_t timer) { return timer->due != OFF; }
void *pvTimerGetTimerID(TimerHandle_t timer) { return timer->id; }

BaseType_t xTimerChangePeriod(TimerHandle_t timer, TickType_t period, TickType_t)
{
    timer->period = period * 16000ull;
    return xTimerStart(timer, 0);
}
