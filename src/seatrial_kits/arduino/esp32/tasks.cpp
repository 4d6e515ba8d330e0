/* FreeRTOS's tasks: contexts with a stack each, of which one goes on at a time.
 *
 * A task gives way where it waits, and between stretches of code when another one that waited is ready or
 * its millisecond is over. Tasks of the two cores take turns as if they ran side by side; on one core the
 * highest priority goes first. A task without affinity counts as one of core 0, where less runs.
 */
#include <errno.h>
#include <pthread.h>
#include <string.h>
#include <sys/mman.h>
#include <ucontext.h>

#include <algorithm>
#include <string>
#include <vector>

#include "Arduino.h"
#include "machine.h"
#include "tasks.h"

using machine::charge;

constexpr uint64_t TICK = 16000, ALWAYS = UINT64_MAX;
constexpr size_t STACK = 128 << 10;

struct Task {
    std::string name;
    TaskFunction_t code = nullptr;
    void *argument = nullptr;
    unsigned priority = 1;
    int core = 1;
    ucontext_t context = {};
    char *stack = nullptr;
    uint64_t wake = 0; /* when a waiting task goes on, at the latest; 0: it does not wait */
    const std::function<bool()> *ready = nullptr;
    bool suspended = false, deleted = false;
    uint32_t notice = 0;
    bool noticed = false;
    int critical = 0; /* how deep it is in critical sections */

    bool waits() const { return wake > machine::now || ready; }
    bool able() const { return !suspended && !deleted && (wake <= machine::now || (ready && (*ready)())); }
};

namespace {

Task main_task;
std::vector<Task *> tasks = {&main_task};
Task *current = &main_task;
uint64_t slice_end;
int alarm = -1, held; /* held: the scheduler is suspended */

/* The next that can go on, the current one last; of a core the highest priority. */
Task *next_task()
{
    size_t count = tasks.size(), at = (size_t)(std::find(tasks.begin(), tasks.end(), current) - tasks.begin());
    std::vector<Task *> able;
    for (size_t each = 1; each <= count; each++)
        if (Task *one = tasks[(at + each) % count]; one->able())
            able.push_back(one);
    for (Task *one : able)
        if (std::none_of(able.begin(), able.end(), [&](Task *other) { return other->core == one->core && other->priority > one->priority; }))
            return one;
    return nullptr;
}

void bury()
{
    for (size_t each = 0; each < tasks.size(); each++) {
        Task *one = tasks[each];
        if (!one->deleted || one == current)
            continue;
        if (one->stack)
            munmap(one->stack, STACK);
        tasks.erase(tasks.begin() + (long)each--);
        if (one != &main_task)
            delete one;
    }
}

void plan()
{
    uint64_t soonest = tasks.size() > 1 ? slice_end : ALWAYS;
    for (Task *one : tasks)
        if (one != current && !one->suspended && one->wake > machine::now)
            soonest = std::min(soonest, one->wake);
    if (tasks.size() > 1)
        machine::set_alarm(alarm, soonest);
}

void go_on(Task *next)
{
    slice_end = machine::now + TICK;
    Task *before = current;
    current = next;
    plan();
    if (next == before)
        return;
    charge(32);
    machine::on_stack(next->stack ? next->stack : machine::main_stack(), next->stack ? STACK : board::STACK);
    swapcontext(&before->context, &next->context);
    bury();
}

/* Let the next task go on that can, and time pass until there is one. */
void give_way()
{
    for (;;) {
        if (Task *next = next_task())
            return go_on(next);
        uint64_t soonest = ALWAYS;
        for (Task *one : tasks)
            if (!one->suspended && !one->deleted && one->wake > machine::now)
                soonest = std::min(soonest, one->wake);
        machine::pass_until(soonest, true);
    }
}

bool may_give_way() { return tasks.size() > 1 && !machine::interrupted() && !held && !current->critical; }

void between_stretches()
{
    if (!may_give_way())
        return;
    machine::let_others_go_on(false);
    bool woken = std::any_of(tasks.begin(), tasks.end(), [](Task *one) { return one != current && one->waits() && one->able(); });
    if (woken || machine::now >= slice_end)
        give_way();
    else
        plan();
}

/* Others go on while one waits for a line; without others, time passes. */
void wait_once(uint64_t when)
{
    if (may_give_way())
        if (Task *next = next_task(); next && next != current)
            return go_on(next);
    machine::pass_until(when, true);
}

void begin_task()
{
    bury();
    current->code(current->argument);
    machine::end("the task %s returned from its function: FreeRTOS aborts there; vTaskDelete(NULL) is its end", current->name.c_str());
}

bool begin_tasks()
{
    main_task.name = "loopTask";
    machine::between = between_stretches;
    machine::wait = wait_once;
    return true;
}

bool begun = begin_tasks();

Task *meant(TaskHandle_t task) { return task ? task : current; }

} // namespace

bool wait_until(uint64_t when, const std::function<bool()> &ready)
{
    charge(16);
    if (ready())
        return true;
    if (when <= machine::now || machine::interrupted())
        return false;
    current->wake = when;
    current->ready = &ready;
    give_way();
    current->wake = 0;
    current->ready = nullptr;
    return ready();
}

uint64_t after_ticks(uint32_t ticks) { return ticks == portMAX_DELAY ? ALWAYS : (machine::now / TICK + ticks) * TICK; }
void let_others()
{
    if (may_give_way())
        between_stretches();
    else
        machine::let_others_go_on(tasks.size() > 1);
}

/* ------------------------------------------------------------------ tasks */

BaseType_t xTaskCreatePinnedToCore(TaskFunction_t code, const char *name, uint32_t, void *argument, UBaseType_t priority, TaskHandle_t *made, BaseType_t core)
{
    charge(320);
    if (alarm < 0)
        alarm = machine::new_alarm([](void *) { machine::let_others_go_on(true); }, nullptr);
    Task *one = new Task;
    one->name = name ? name : "";
    one->code = code;
    one->argument = argument;
    one->priority = priority;
    one->core = core == 1 ? 1 : 0;
    one->stack = machine::new_stack(STACK);
    getcontext(&one->context);
    one->context.uc_stack.ss_sp = one->stack;
    one->context.uc_stack.ss_size = STACK;
    makecontext(&one->context, begin_task, 0);
    if (made)
        *made = one;
    tasks.push_back(one);
    if (may_give_way())
        give_way();
    return pdPASS;
}

void vTaskDelete(TaskHandle_t task)
{
    charge(160);
    Task *one = meant(task);
    one->deleted = true;
    if (one == current)
        give_way();
    else
        bury();
}

static void sleep_until(uint64_t when)
{
    charge(16);
    if (machine::interrupted())
        return machine::pass_until(when);
    current->wake = when;
    give_way();
    current->wake = 0;
}

void vTaskDelay(TickType_t ticks) { if (ticks) sleep_until(after_ticks(ticks)); else taskYIELD(); }

BaseType_t xTaskDelayUntil(TickType_t *last, TickType_t period)
{
    *last += period;
    if ((int32_t)(*last - xTaskGetTickCount()) <= 0)
        return pdFALSE;
    sleep_until(after_ticks(*last - xTaskGetTickCount()));
    return pdTRUE;
}

void taskYIELD() { charge(4); if (may_give_way()) give_way(); }

void vTaskSuspend(TaskHandle_t task)
{
    meant(task)->suspended = true;
    if (meant(task) == current)
        give_way();
}

void vTaskResume(TaskHandle_t task) { task->suspended = false; let_others(); }
void vTaskPrioritySet(TaskHandle_t task, UBaseType_t priority) { meant(task)->priority = priority; }
UBaseType_t uxTaskPriorityGet(TaskHandle_t task) { return meant(task)->priority; }
TickType_t xTaskGetTickCount() { charge(2); return (TickType_t)(machine::now / TICK); }
TaskHandle_t xTaskGetCurrentTaskHandle() { return current; }
char *pcTaskGetName(TaskHandle_t task) { return &meant(task)->name[0]; }
UBaseType_t uxTaskGetStackHighWaterMark(TaskHandle_t) { return 2048; }
UBaseType_t uxTaskGetNumberOfTasks() { return (UBaseType_t)tasks.size(); }
BaseType_t xPortGetCoreID() { return ESP.getChipCores() > 1 ? current->core : 0; }
BaseType_t xPortInIsrContext() { return machine::interrupted(); }
void vTaskSuspendAll() { held++; }
BaseType_t xTaskResumeAll() { held -= held > 0; return pdFALSE; }

TaskHandle_t xTaskGetHandle(const char *name)
{
    auto found = std::find_if(tasks.begin(), tasks.end(), [&](Task *one) { return one->name == name; });
    return found == tasks.end() ? nullptr : *found;
}

BaseType_t xTaskGenericNotify(TaskHandle_t task, uint32_t value, eNotifyAction action)
{
    charge(32);
    if (action == eSetValueWithoutOverwrite && task->noticed)
        return pdFAIL;
    if (action == eIncrement)
        task->notice++;
    else if (action == eSetBits)
        task->notice |= value;
    else if (action != eNoAction)
        task->notice = value;
    task->noticed = true;
    let_others();
    return pdPASS;
}

uint32_t ulTaskNotifyTake(BaseType_t clear, TickType_t ticks)
{
    Task *one = current;
    wait_until(after_ticks(ticks), [=] { return one->notice != 0; });
    uint32_t found = one->notice;
    one->notice = clear || !found ? 0 : found - 1;
    one->noticed = false;
    return found;
}

BaseType_t xTaskNotifyWait(uint32_t clear_before, uint32_t clear_after, uint32_t *value, TickType_t ticks)
{
    Task *one = current;
    if (!one->noticed)
        one->notice &= ~clear_before;
    bool came = wait_until(after_ticks(ticks), [=] { return one->noticed; });
    if (value)
        *value = one->notice;
    if (came)
        one->notice &= ~clear_after;
    one->noticed = false;
    return came;
}

/* Tasks are of one thread: std::mutex lets others go on while one of them has it. */
extern "C" int pthread_mutex_lock(pthread_mutex_t *mutex)
{
    while (int refused = pthread_mutex_trylock(mutex)) {
        if (refused != EBUSY)
            return refused;
        taskYIELD();
    }
    return 0;
}

/* Interrupts wait meanwhile, and so does every other task. */
void sketch_enter_critical()
{
    charge(2);
    if (machine::interrupted())
        return;
    current->critical++;
    machine::enable(false);
}

void sketch_exit_critical()
{
    charge(2);
    if (machine::interrupted() || !current->critical)
        return;
    if (!--current->critical)
        machine::enable(true);
}
