/* What a component in C does for the rig around it: its FMI functions, under a name of its own.

   With CARRIER defined, behind a component's own sources, this defines them. */

#ifndef CARRIER_H
#define CARRIER_H

#include <stddef.h>

#include "fmi2FunctionTypes.h"

typedef struct {
    const char *guid;
    size_t state_size;
    size_t touched; /* bytes of an instance that most steps need, from its start on */
    size_t values;  /* where its numbers by reference are */
    fmi2InstantiateTYPE *instantiate;
    fmi2FreeInstanceTYPE *free_instance;
    fmi2SetupExperimentTYPE *set_up;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *exit;
    fmi2TerminateTYPE *terminate;
    fmi2ResetTYPE *reset;
    fmi2DoStepTYPE *do_step;
    fmi2GetRealTYPE *get_real;
    fmi2SetRealTYPE *set_real;
    fmi2GetIntegerTYPE *get_integer;
    fmi2SetIntegerTYPE *set_integer;
    fmi2GetBooleanTYPE *get_boolean;
    fmi2SetBooleanTYPE *set_boolean;
    fmi2GetStringTYPE *get_string;
    fmi2SetStringTYPE *set_string;
    fmi2GetFMUstateTYPE *get_state;
    fmi2SetFMUstateTYPE *set_state;
    void (*surround)(void *component, int (*met)(const void *, double, const double *, double *),
                     const void *of);
#if LANES /* of copies that step together; of a component that cannot, the first is 0 */
    size_t together; /* bytes that all of them share */
    void (*gather)(void *memory, void *const copies[], const unsigned char *active);
    void (*step)(void *memory, void *const copies[], const unsigned char *active, double t, double h,
                 fmi2Status *found);
    void (*refresh)(void *memory, void *const copies[], const unsigned char *active);
#endif
} Carrier;

#endif

#if defined(CARRIER) && !defined(TERMS) /* a sum's is its own */
const Carrier CARRIER = {
    MODEL_GUID,
    sizeof(State),
    TOUCHED_OF_INSTANCE,
    offsetof(Instance, state.values),
    fmi2Instantiate,
    fmi2FreeInstance,
    fmi2SetupExperiment,
    fmi2EnterInitializationMode,
    fmi2ExitInitializationMode,
    fmi2Terminate,
    fmi2Reset,
    fmi2DoStep,
    fmi2GetReal,
    fmi2SetReal,
    fmi2GetInteger,
    fmi2SetInteger,
    fmi2GetBoolean,
    fmi2SetBoolean,
    fmi2GetString,
    fmi2SetString,
    fmi2GetFMUstate,
    fmi2SetFMUstate,
#if defined(AROUND) && AROUND /* a plant that can meet weather */
    seatrial_surround,
#else
    NULL,
#endif
#if defined(STEPS_TOGETHER)
    sizeof(Together), gather_together, step_together, refresh_together,
#endif
};
#endif
