/* FMI 2.0 in front of pythonfmu's library: what checks the calls and who loads the library share. */

#ifndef FORWARDED_H
#define FORWARDED_H

#include <stddef.h>

#include "fmi2Functions.h"

#define LONGEST 4096 /* of a path */

#define FORWARDED(F)                                                                              \
    F(fmi2Instantiate) F(fmi2FreeInstance) F(fmi2SetupExperiment) F(fmi2EnterInitializationMode)   \
    F(fmi2ExitInitializationMode) F(fmi2Terminate) F(fmi2Reset) F(fmi2DoStep) F(fmi2CancelStep)    \
    F(fmi2GetReal) F(fmi2GetInteger) F(fmi2GetBoolean) F(fmi2GetString)                           \
    F(fmi2SetReal) F(fmi2SetInteger) F(fmi2SetBoolean) F(fmi2SetString)                           \
    F(fmi2GetFMUstate) F(fmi2SetFMUstate) F(fmi2FreeFMUstate) F(fmi2SerializedFMUstateSize)        \
    F(fmi2SerializeFMUstate) F(fmi2DeSerializeFMUstate) F(fmi2GetDirectionalDerivative)            \
    F(fmi2SetRealInputDerivatives) F(fmi2GetRealOutputDerivatives) F(fmi2GetStatus)               \
    F(fmi2GetRealStatus) F(fmi2GetIntegerStatus) F(fmi2GetBooleanStatus) F(fmi2GetStringStatus)

typedef struct {
#define MEMBER(name) name##TYPE *name;
    FORWARDED(MEMBER)
} Forwarded;

/* The library of the FMU whose resources are in a folder; NULL, with the problem written, if it
   cannot be loaded. */
const Forwarded *library_of(const char *resources, char *problem, size_t capacity);

#endif
