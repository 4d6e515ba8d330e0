/* Library of a standalone FMU: it starts the Python that the FMU carries, unless the process has
   one, and loads pythonfmu's library from the FMU's resources.

   Python is never finalised: extension modules and threads of the components may outlive the last
   instance, and pythonfmu's library, when it is the one to start Python, ends it in an exit handler after
   the C library has freed what it needs. Here it finds Python started, and leaves it alone. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>

#include "forwarded.h"
#include "python.h" /* PYTHON_VERSION, PYTHON_LIBRARY, FMU_LIBRARY */

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static void *library;
static Forwarded its;
static char problem[LONGEST + 512];

/* ---- Python ---- */

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

static int loaded(const char *resources) {
    char home[LONGEST];
    if (library) return 1;
    snprintf(home, sizeof home, "%s/python", resources);
    open_needed(home);
    if (!with_python(home)) return 0;
    void *opened = open_in(home, FMU_LIBRARY, RTLD_LOCAL);
    if (!opened) return 0;
#define FIND(name) *(void **)&its.name = dlsym(opened, #name);
    FORWARDED(FIND)
    library = opened;
    return 1;
}

const Forwarded *library_of(const char *resources, char *text, size_t capacity) {
    pthread_mutex_lock(&lock);
    const int ready = loaded(resources);
    if (!ready) snprintf(text, capacity, "%s", problem);
    pthread_mutex_unlock(&lock);
    return ready ? &its : NULL;
}
