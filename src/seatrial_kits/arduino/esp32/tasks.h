/* Waiting of tasks, for the board's own parts. */
#ifndef TASKS_H
#define TASKS_H

#include <functional>

/* Let others go on until `ready` or until the time `when`; returns whether it is ready. */
bool wait_until(uint64_t when, const std::function<bool()> &ready);
/* When so many ticks are over. */
uint64_t after_ticks(uint32_t ticks);
/* Something has changed that others may wait for. */
void let_others();

#endif
