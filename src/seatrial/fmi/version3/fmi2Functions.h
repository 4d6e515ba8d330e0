/* Functions of FMI 2.0, co-simulation, that those of FMI 3.0 are made of: none is exported. */

#ifndef FMI2_FUNCTIONS_H
#define FMI2_FUNCTIONS_H

#include "fmi2FunctionTypes.h"
#include "fmi2TypesPlatform.h"

#define fmi2Version "2.0"
#define FMI2_Export

fmi2GetTypesPlatformTYPE fmi2GetTypesPlatform;
fmi2GetVersionTYPE fmi2GetVersion;
fmi2SetDebugLoggingTYPE fmi2SetDebugLogging;
fmi2InstantiateTYPE fmi2Instantiate;
fmi2FreeInstanceTYPE fmi2FreeInstance;
fmi2SetupExperimentTYPE fmi2SetupExperiment;
fmi2EnterInitializationModeTYPE fmi2EnterInitializationMode;
fmi2ExitInitializationModeTYPE fmi2ExitInitializationMode;
fmi2TerminateTYPE fmi2Terminate;
fmi2ResetTYPE fmi2Reset;
fmi2GetRealTYPE fmi2GetReal;
fmi2GetIntegerTYPE fmi2GetInteger;
fmi2GetBooleanTYPE fmi2GetBoolean;
fmi2GetStringTYPE fmi2GetString;
fmi2SetRealTYPE fmi2SetReal;
fmi2SetIntegerTYPE fmi2SetInteger;
fmi2SetBooleanTYPE fmi2SetBoolean;
fmi2SetStringTYPE fmi2SetString;
fmi2GetFMUstateTYPE fmi2GetFMUstate;
fmi2SetFMUstateTYPE fmi2SetFMUstate;
fmi2FreeFMUstateTYPE fmi2FreeFMUstate;
fmi2SerializedFMUstateSizeTYPE fmi2SerializedFMUstateSize;
fmi2SerializeFMUstateTYPE fmi2SerializeFMUstate;
fmi2DeSerializeFMUstateTYPE fmi2DeSerializeFMUstate;
fmi2GetDirectionalDerivativeTYPE fmi2GetDirectionalDerivative;
fmi2SetRealInputDerivativesTYPE fmi2SetRealInputDerivatives;
fmi2GetRealOutputDerivativesTYPE fmi2GetRealOutputDerivatives;
fmi2DoStepTYPE fmi2DoStep;
fmi2CancelStepTYPE fmi2CancelStep;
fmi2GetStatusTYPE fmi2GetStatus;
fmi2GetRealStatusTYPE fmi2GetRealStatus;
fmi2GetIntegerStatusTYPE fmi2GetIntegerStatus;
fmi2GetBooleanStatusTYPE fmi2GetBooleanStatus;
fmi2GetStringStatusTYPE fmi2GetStringStatus;

/* The function of FMI 3.0 by which the host called one of these. */
#define CALLED(name) CALLED_##name
#define CALLED_fmi2SetDebugLogging "fmi3SetDebugLogging"
#define CALLED_fmi2Instantiate "fmi3InstantiateCoSimulation"
#define CALLED_fmi2SetupExperiment "fmi3EnterInitializationMode"
#define CALLED_fmi2EnterInitializationMode "fmi3EnterInitializationMode"
#define CALLED_fmi2ExitInitializationMode "fmi3ExitInitializationMode"
#define CALLED_fmi2Terminate "fmi3Terminate"
#define CALLED_fmi2Reset "fmi3Reset"
#define CALLED_fmi2GetReal "fmi3GetFloat64"
#define CALLED_fmi2GetInteger "fmi3GetInt32"
#define CALLED_fmi2GetBoolean "fmi3GetBoolean"
#define CALLED_fmi2GetString "fmi3GetString"
#define CALLED_fmi2SetReal "fmi3SetFloat64"
#define CALLED_fmi2SetInteger "fmi3SetInt32"
#define CALLED_fmi2SetBoolean "fmi3SetBoolean"
#define CALLED_fmi2SetString "fmi3SetString"
#define CALLED_fmi2GetFMUstate "fmi3GetFMUState"
#define CALLED_fmi2SetFMUstate "fmi3SetFMUState"
#define CALLED_fmi2FreeFMUstate "fmi3FreeFMUState"
#define CALLED_fmi2SerializedFMUstateSize "fmi3SerializedFMUStateSize"
#define CALLED_fmi2SerializeFMUstate "fmi3SerializeFMUState"
#define CALLED_fmi2DeSerializeFMUstate "fmi3DeserializeFMUState"
#define CALLED_fmi2GetDirectionalDerivative "fmi3GetDirectionalDerivative"
#define CALLED_fmi2SetRealInputDerivatives "fmi2SetRealInputDerivatives"
#define CALLED_fmi2GetRealOutputDerivatives "fmi2GetRealOutputDerivatives"
#define CALLED_fmi2DoStep "fmi3DoStep"
#define CALLED_fmi2CancelStep "fmi2CancelStep"
#define CALLED_fmi2GetStatus "fmi2GetStatus"
#define CALLED_fmi2GetRealStatus "fmi2GetRealStatus"
#define CALLED_fmi2GetIntegerStatus "fmi2GetIntegerStatus"
#define CALLED_fmi2GetBooleanStatus "fmi2GetBooleanStatus"
#define CALLED_fmi2GetStringStatus "fmi2GetStringStatus"

#endif
