/* Calls of FMI 2.0 that are passed on to pythonfmu's library, which lies in the FMU's resources. */

#ifndef FORWARDED_H
#define FORWARDED_H

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "fmi2Functions.h"

#define LONGEST 4096

static char problem[LONGEST + 512];

#define FORWARDED(F)                                                                              \
    F(fmi2SetDebugLogging, (fmi2Component c, fmi2Boolean on, size_t n, const fmi2String k[]),      \
      (c, on, n, k))                                                                              \
    F(fmi2SetupExperiment,                                                                        \
      (fmi2Component c, fmi2Boolean d, fmi2Real t, fmi2Real s, fmi2Boolean e, fmi2Real x),         \
      (c, d, t, s, e, x))                                                                         \
    F(fmi2EnterInitializationMode, (fmi2Component c), (c))                                        \
    F(fmi2ExitInitializationMode, (fmi2Component c), (c))                                         \
    F(fmi2Terminate, (fmi2Component c), (c))                                                      \
    F(fmi2Reset, (fmi2Component c), (c))                                                          \
    F(fmi2GetReal, (fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[]),        \
      (c, r, n, v))                                                                               \
    F(fmi2GetInteger, (fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer v[]),  \
      (c, r, n, v))                                                                               \
    F(fmi2GetBoolean, (fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Boolean v[]),  \
      (c, r, n, v))                                                                               \
    F(fmi2GetString, (fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]),    \
      (c, r, n, v))                                                                               \
    F(fmi2SetReal, (fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real v[]),  \
      (c, r, n, v))                                                                               \
    F(fmi2SetInteger,                                                                             \
      (fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer v[]),            \
      (c, r, n, v))                                                                               \
    F(fmi2SetBoolean,                                                                             \
      (fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Boolean v[]),            \
      (c, r, n, v))                                                                               \
    F(fmi2SetString,                                                                              \
      (fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String v[]),             \
      (c, r, n, v))                                                                               \
    F(fmi2GetFMUstate, (fmi2Component c, fmi2FMUstate *s), (c, s))                                \
    F(fmi2SetFMUstate, (fmi2Component c, fmi2FMUstate s), (c, s))                                 \
    F(fmi2FreeFMUstate, (fmi2Component c, fmi2FMUstate *s), (c, s))                               \
    F(fmi2SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate s, size_t *n), (c, s, n))         \
    F(fmi2SerializeFMUstate, (fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n),            \
      (c, s, b, n))                                                                               \
    F(fmi2DeSerializeFMUstate,                                                                    \
      (fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s), (c, b, n, s))              \
    F(fmi2GetDirectionalDerivative,                                                               \
      (fmi2Component c, const fmi2ValueReference z[], size_t nz, const fmi2ValueReference v[],     \
       size_t nv, const fmi2Real dv[], fmi2Real dz[]),                                            \
      (c, z, nz, v, nv, dv, dz))                                                                  \
    F(fmi2SetRealInputDerivatives,                                                                \
      (fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[],             \
       const fmi2Real v[]),                                                                       \
      (c, r, n, o, v))                                                                            \
    F(fmi2GetRealOutputDerivatives,                                                               \
      (fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[],             \
       fmi2Real v[]),                                                                             \
      (c, r, n, o, v))                                                                            \
    F(fmi2DoStep, (fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean b), (c, t, h, b))          \
    F(fmi2CancelStep, (fmi2Component c), (c))                                                     \
    F(fmi2GetStatus, (fmi2Component c, const fmi2StatusKind k, fmi2Status *v), (c, k, v))          \
    F(fmi2GetRealStatus, (fmi2Component c, const fmi2StatusKind k, fmi2Real *v), (c, k, v))        \
    F(fmi2GetIntegerStatus, (fmi2Component c, const fmi2StatusKind k, fmi2Integer *v), (c, k, v))  \
    F(fmi2GetBooleanStatus, (fmi2Component c, const fmi2StatusKind k, fmi2Boolean *v), (c, k, v))  \
    F(fmi2GetStringStatus, (fmi2Component c, const fmi2StatusKind k, fmi2String *v), (c, k, v))

#define DEFINE(name, parameters, arguments)                                                       \
    static fmi2Status(*its_##name) parameters;                                                    \
    FMI2_Export fmi2Status name parameters { return its_##name arguments; }
FORWARDED(DEFINE)

/* These two are called with care. */
static fmi2Component (*its_fmi2Instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String,
                                            const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
static void (*its_fmi2FreeInstance)(fmi2Component);

FMI2_Export void fmi2FreeInstance(fmi2Component c) {
    if (c) its_fmi2FreeInstance(c);
}

FMI2_Export const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

FMI2_Export const char *fmi2GetVersion(void) { return "2.0"; }

/* Find the library's functions: FIND(name, , ) of its own macro for each. */
#define EVERY(F) FORWARDED(F) F(fmi2Instantiate, , ) F(fmi2FreeInstance, , )

/* Write the path of what is in the FMU's resources; 0 if their URI is no file's. */
static int path_of(const char *uri, const char *inside, char *to, size_t size) {
    const char *path = uri ? uri : "";
    if (!strncmp(path, "file://", 7)) {
        path += 7;
        if (*path != '/') path = strchr(path, '/'); /* file://localhost/... */
    } else if (!strncmp(path, "file:/", 6)) {
        path += 5;
    } else {
        return 0;
    }
#ifdef _WIN32
    if (path && *path == '/') path++; /* /C:/... */
#endif
    size_t n = 0;
    for (; path && *path; path++, n++) {
        if (n + strlen(inside) + 64 >= size) return 0;
        unsigned code;
        if (*path == '%' && isxdigit((unsigned char)path[1]) && isxdigit((unsigned char)path[2]) &&
            sscanf(path + 1, "%2x", &code) == 1) {
            to[n] = (char)code;
            path += 2;
        } else {
            to[n] = *path;
        }
    }
    while (n && to[n - 1] == '/') n--;
    strcpy(to + n, inside);
    return n > 0;
}

#endif
