/* A rig as one FMU: its tables, which `tables.py` writes. */

#ifndef RIG_H
#define RIG_H

#include <stdint.h>

#include "carrier.h"
#include "sizes.h"

enum { REAL_TYPE, INTEGER_TYPE, BOOLEAN_TYPE, STRING_TYPE };
enum { CONTINUOUS_INPUT, OTHER_INPUT, PARAMETER_VALUE, OUTPUT_VALUE };

typedef struct {
    const Carrier *carrier;
    const char *name;
    int every;       /* it steps once in so many steps of the rig */
    int first, last; /* operations that read all its outputs: from first, before last */
} Node;

typedef struct { /* an operation of `master.c`; pointers are places in the tables, -1: none */
    int kind, type, node, every, phase, count;
    int64_t start, length;
    int references, places, numbers, values, previous;
    int scaled, scales, continuous, moving, limited, bounds, reals, loop;
} Row;

typedef struct {
    int type, kind;
    int place;           /* of an output among the signals */
    int node;            /* of an output: its component */
    int target, targets; /* of the others: where the components' variables are in rig_targets */
} Variable;

typedef struct {
    int node;
    fmi2ValueReference reference;
} Target;

typedef struct {
    int variable;
    double value;
    const char *text;
} Given;

/* A component of an instance, as its own functions take it. */
fmi2Component rig_component(fmi2Component rig, int node);

/* Before a step of an instance: its memory comes into the caches while another steps. */
void rig_fetch(fmi2Component rig);

/* Operations of any instance, to lend to several, or to free; NULL without memory. */
typedef struct Work Work;
Work *rig_new_work(void);
void rig_lend(fmi2Component rig, Work *work);

#if LANES
/* What LANES copies need to step together; NULL without memory, or if none of their components can. */
typedef struct Lockstep Lockstep;
Lockstep *rig_new_lockstep(void);
void rig_free_lockstep(Lockstep *lockstep);

/* Let the `active` of LANES instances, after as many steps each, take `count` steps; each gets rows
   of values as of `rig_read`, one after each step, unless `rows` is NULL. How many were taken counts
   one that failed too. */
void rig_step_together(Lockstep *lockstep, fmi2Component rigs[], const unsigned char active[],
                       int64_t count, const fmi2ValueReference vr[], size_t values, double *rows[],
                       int64_t taken[], fmi2Status found[]);
#endif

/* Values of numbers, of any type. */
fmi2Status rig_read(fmi2Component rig, const fmi2ValueReference vr[], size_t count, double values[]);

/* Let noise from now on be that of another seed: `parameter` is one of a component. */
void rig_reseed(fmi2Component rig, fmi2ValueReference parameter, double seed);

void rig_override(fmi2Component rig, fmi2ValueReference output, int begins, double value);

extern const Node rig_nodes[];
extern const Row rig_rows[];
extern const Variable rig_variables[];
extern const char *const rig_names[], *const rig_signals[];
extern const Target rig_targets[];
extern const Given rig_given[];
extern const uint32_t rig_references[];
extern const int64_t rig_places[];
extern const double rig_numbers[];
extern const uint8_t rig_reals[];

#endif
