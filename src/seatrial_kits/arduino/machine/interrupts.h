/* Interrupts: of pins, and of alarms, which come at a time. */
#ifndef INTERRUPTS_H
#define INTERRUPTS_H

uint64_t first(bool do_it);

struct Interrupt {
    Handler handler;
    void *argument;
    int mode;
    bool pending;
} externals[INTERRUPTS];
struct Alarm {
    Handler handler;
    void *argument;
    uint64_t when;
    bool pending;
} alarms[ALARMS];
int alarm_count;
uint64_t alarm_next = NEVER;
bool interrupts_on = true, in_interrupt;

void plan_alarms()
{
    alarm_next = NEVER;
    for (int each = 0; each < alarm_count; each++)
        alarm_next = alarms[each].when < alarm_next ? alarms[each].when : alarm_next;
}

void ring()
{
    for (int each = 0; each < alarm_count; each++)
        if (alarms[each].when <= now) {
            alarms[each].when = NEVER;
            alarms[each].pending = true;
        }
    plan_alarms();
}

template <typename Source> void handle(Source &source)
{
    if (!source.pending)
        return;
    source.pending = false;
    in_interrupt = true;
    last_call = now;
    charge(board::INTERRUPT);
    source.handler(source.argument);
    in_interrupt = false;
    interrupts_on = true; /* the return of a handler sets the flag */
}

void interrupt()
{
    if (in_interrupt || !interrupts_on)
        return;
    for (int each = 0; each < INTERRUPTS; each++)
        handle(externals[each]);
    for (int each = 0; each < alarm_count; each++)
        handle(alarms[each]);
}

} // namespace

void on_edge(int number, Handler handler, void *argument, int mode)
{
    if (number >= 0 && number < INTERRUPTS)
        externals[number] = {handler, argument, mode, false};
}

int new_alarm(Handler handler, void *argument)
{
    if (alarm_count == ALARMS)
        end("it has more than %d timers", ALARMS);
    alarms[alarm_count] = {handler, argument, NEVER, false};
    return alarm_count++;
}

void set_alarm(int alarm, uint64_t when)
{
    alarms[alarm].when = when;
    alarms[alarm].pending = false;
    plan_alarms();
    plan_next();
}

void enable(bool on)
{
    interrupts_on = on;
    if (on)
        interrupt();
}

bool enabled() { return interrupts_on && !in_interrupt; }
bool interrupted() { return in_interrupt; }

namespace {

#endif
