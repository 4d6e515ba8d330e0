/* Instances that were freed stay readable for a while, so that a call with one is refused. */

#ifndef RETIRED_H
#define RETIRED_H

#include <stdlib.h>

#define MOST_RETIRED 256

static inline void retire(void *instance) {
    static void *retired[MOST_RETIRED];
    static unsigned count;
    const unsigned place = __atomic_fetch_add(&count, 1, __ATOMIC_RELAXED) % MOST_RETIRED;
    free(__atomic_exchange_n(&retired[place], instance, __ATOMIC_ACQ_REL));
}

#endif
