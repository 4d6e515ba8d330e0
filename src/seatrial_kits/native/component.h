/* What an instance consists of. `model.h` has the sizes, tables and memory of its component. */

#ifndef COMPONENT_H
#define COMPONENT_H

#include <stddef.h>
#include <stdint.h>

#include "fmi2Functions.h"

#define NS 1e9
#define TEXT_SIZE 256
#define QUEUE_SIZE 256    /* entries that wait for their time, at most */
#define FAULT_SETTINGS 4  /* value, rate, factor, coefficients */
#define FAULT_VALUES 16   /* of one setting, at most */
#define ERROR_SIZE 1024

typedef struct { /* in turn round the first `size` entries, a power of two: what is not needed stays cold */
    int first, count, size;
} Queue;

typedef struct {
    int number, of; /* number: negative for a text that is none */
    double at, grows_over;
    int counts[FAULT_SETTINGS];
} Fault;

#if !defined(MODEL_H) /* of a rig as one FMU, each component has one of another name */
#define MODEL_H "model.h"
#endif
#include MODEL_H

/* What surrounds a craft at a time, s, by its states; returns 0 where there is no value. `of` is
   whatever it was given with. */
typedef int (*Surroundings)(const void *of, double t, const double *state, double *around);

typedef enum { INSTANTIATED, INITIALISING, RUNNING, TERMINATED } Phase;

typedef struct { /* first what every step touches: many instances must fit in the caches */
    uint64_t fmu; /* of which it is a state */
    long long now_ns;
    double reached; /* the same as the host has it, s */
    Phase phase;
    int stale, restart, failed;
    int words[TEXTS + 1];       /* which of the texts that it knows each is */
    Fault fault;
    double values[SCALARS + 1]; /* of all types, by value reference */
    Memory memory;              /* queues last */
    double settings[FAULT_SETTINGS][FAULT_VALUES]; /* of the fault */
    char texts[TEXTS + 1][TEXT_SIZE]; /* inputs of text */
} State;

typedef struct {
    int is_wrong; /* there is an error */
    State state;
    fmi2CallbackLogger log;
    fmi2ComponentEnvironment environment;
    char name[256];
    char error[ERROR_SIZE]; /* of the call that runs */
    char shown[8][32];      /* numbers for a message */
    int shown_count;
    Surroundings met; /* of a plant in waves, current or wind, from its host, */
    const void *of;   /* and of what */
} Instance;

#if !defined(TOUCHED) /* bytes of the memory that most steps touch */
#define TOUCHED sizeof(Memory)
#endif
#define TOUCHED_OF_INSTANCE (offsetof(Instance, state.memory) + TOUCHED)

/* What a component does: these are in plant.c, or written from its Python. */
void model_start(Instance *self, double t);
void model_step(Instance *self, double t, double h);
void model_outputs(Instance *self, double t);

/* Along a direction of inputs and parameters: what outputs do at this instant. Both are by value
   reference; return 0 for a component without derivatives. */
int model_derivative(Instance *self, const double *seeds, double *along);

/* A text was set: what it means. */
void model_text(Instance *self, int text);

/* Note what is wrong; the call that runs will fail. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void fail(Instance *self, const char *format, ...);

/* Write a number so that it reads back exactly. */
const char *shown(Instance *self, double value);

#endif
