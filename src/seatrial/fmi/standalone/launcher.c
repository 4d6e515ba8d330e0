/* Library of a standalone FMU: it starts the Python that the FMU carries, unless the process has
   one, loads pythonfmu's library from the FMU's resources, and passes every call on to it.

   Python is never finalised: extension modules and threads of the components may outlive the last
   instance, and pythonfmu's library, when it is the one to start Python, ends it in an exit handler after
   the C library has freed what it needs. Here it finds Python started, and leaves it alone. */
#define _GNU_SOURCE
#include <ctype.h>
#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>

#include "fmi2Functions.h"
#include "python.h" /* PYTHON_VERSION, PYTHON_LIBRARY, FMU_LIBRARY */

#define LONGEST 4096

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static void *library;
static char problem[LONGEST + 512];

/* ---- every function but the first is passed on ---- */

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

static fmi2Component (*its_fmi2Instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String,
                                            const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
static void (*its_fmi2FreeInstance)(fmi2Component);

FMI2_Export void fmi2FreeInstance(fmi2Component c) {
    if (c) its_fmi2FreeInstance(c);
}

FMI2_Export const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

FMI2_Export const char *fmi2GetVersion(void) { return "2.0"; }

/* ---- Python ---- */

/* Write the folder of the FMU's own Python; 0 if the URI of the resources is no file's. */
static int home_of(const char *uri, char *home, size_t size) {
    const char *path = uri ? uri : "";
    if (!strncmp(path, "file://", 7)) {
        path += 7;
        if (*path != '/') path = strchr(path, '/'); /* file://localhost/... */
    } else if (!strncmp(path, "file:/", 6)) {
        path += 5;
    } else {
        return 0;
    }
    size_t n = 0;
    for (; path && *path; path++, n++) {
        if (n + sizeof("/python/site-packages") >= size) return 0;
        unsigned code;
        if (*path == '%' && isxdigit((unsigned char)path[1]) && isxdigit((unsigned char)path[2]) &&
            sscanf(path + 1, "%2x", &code) == 1) {
            home[n] = (char)code;
            path += 2;
        } else {
            home[n] = *path;
        }
    }
    while (n && home[n - 1] == '/') n--;
    strcpy(home + n, "/python");
    return n > 0;
}

static void *open_in(const char *home, const char *name, int scope) {
    char path[LONGEST];
    snprintf(path, sizeof path, "%s/lib/%s", home, name);
    void *opened = dlopen(path, RTLD_NOW | scope);
    if (!opened) snprintf(problem, sizeof problem, "%s", dlerror());
    return opened;
}

/* Open the libraries that others need, this machine's where it has them. Their list has those that
   others need before these. */
static void open_needed(const char *home) {
    char line[512];
    snprintf(problem, sizeof problem, "%s/lib/libraries.txt", home);
    FILE *list = fopen(problem, "r");
    while (list && fgets(line, sizeof line, list)) {
        line[strcspn(line, "\n")] = 0;
        if (!dlopen(line, RTLD_LAZY | RTLD_LOCAL)) open_in(home, line, RTLD_LOCAL);
    }
    if (list) fclose(list);
}

static void set_flag(const char *name) {
    int *flag = (int *)dlsym(RTLD_DEFAULT, name);
    if (flag) *flag = 1;
}

/* A function of Python by its name: POSIX says that a pointer of dlsym may be one. */
#define PYTHON(type, name, parameters)                                                            \
    type(*name) parameters;                                                                       \
    *(void **)&name = dlsym(RTLD_DEFAULT, #name)

/* Start the FMU's Python unless there is one, and let an equal version find what the FMU carries. */
static int with_python(const char *home) {
    if (!dlsym(RTLD_DEFAULT, "Py_IsInitialized") && !open_in(home, PYTHON_LIBRARY, RTLD_GLOBAL))
        return 0;
    PYTHON(const char *, Py_GetVersion, (void));
    if (strncmp(Py_GetVersion(), PYTHON_VERSION ".", sizeof PYTHON_VERSION)) return 1;
    PYTHON(int, Py_IsInitialized, (void));
    if (!Py_IsInitialized()) {
        PYTHON(void, Py_SetPythonHome, (const wchar_t *));
        PYTHON(wchar_t *, Py_DecodeLocale, (const char *, size_t *));
        PYTHON(void, Py_InitializeEx, (int));
        PYTHON(void *, PyEval_SaveThread, (void));
        set_flag("Py_IgnoreEnvironmentFlag"); /* PYTHONPATH is for other Pythons */
        set_flag("Py_NoUserSiteDirectory");
        set_flag("Py_DontWriteBytecodeFlag");
        Py_SetPythonHome(Py_DecodeLocale(home, NULL));
        Py_InitializeEx(0);
        PyEval_SaveThread();
    }
    PYTHON(int, PyGILState_Ensure, (void));
    PYTHON(void, PyGILState_Release, (int));
    PYTHON(int, PyRun_SimpleString, (const char *));
    PYTHON(int, PySys_SetObject, (const char *, void *));
    PYTHON(void *, PyUnicode_DecodeFSDefault, (const char *));
    char packages[LONGEST];
    snprintf(packages, sizeof packages, "%s/site-packages", home);
    int state = PyGILState_Ensure();
    PySys_SetObject("_fmu_packages", PyUnicode_DecodeFSDefault(packages));
    int failed = PyRun_SimpleString("import sys\n"
                                    "if sys._fmu_packages not in sys.path:\n"
                                    "    sys.path.append(sys._fmu_packages)\n"
                                    "del sys._fmu_packages\n");
    PyGILState_Release(state);
    if (failed) snprintf(problem, sizeof problem, "Python did not start in %s", home);
    return !failed;
}

static int loaded(const char *uri) {
    char home[LONGEST];
    if (library) return 1;
    if (!home_of(uri, home, sizeof home)) {
        snprintf(problem, sizeof problem, "the location of the resources is no file: %s",
                 uri ? uri : "(none)");
        return 0;
    }
    open_needed(home);
    if (!with_python(home)) return 0;
    void *opened = open_in(home, FMU_LIBRARY, RTLD_LOCAL);
    if (!opened) return 0;
#define FIND(name, parameters, arguments) *(void **)&its_##name = dlsym(opened, #name);
    FORWARDED(FIND)
    FIND(fmi2Instantiate, , )
    FIND(fmi2FreeInstance, , )
    library = opened;
    return 1;
}

FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                          fmi2String resources,
                                          const fmi2CallbackFunctions *functions,
                                          fmi2Boolean visible, fmi2Boolean logging) {
    pthread_mutex_lock(&lock);
    int ready = loaded(resources);
    pthread_mutex_unlock(&lock);
    if (!ready) {
        if (functions && functions->logger)
            functions->logger(functions->componentEnvironment, name, fmi2Error, "logStatusError",
                              "%s", problem);
        return NULL;
    }
    return its_fmi2Instantiate(name, type, guid, resources, functions, visible, logging);
}
