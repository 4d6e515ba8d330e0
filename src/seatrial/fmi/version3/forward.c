/* Library beneath an FMU of FMI 3.0 that needs a Python: it loads pythonfmu's library of FMI 2.0
   from the FMU's resources, and passes every call on to it. */

#ifdef _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FOUND(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#define WHY "Windows cannot load it, or a library that it needs"
#define LIBRARY "/pythonfmu/pythonfmu-export.dll"
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FOUND(library, name) dlsym(library, name)
#define WHY dlerror()
#define LIBRARY "/pythonfmu/libpythonfmu-export.so"
#endif

#include "forwarded.h"

static void *library;

/* Load the library; twice at once does no harm, as both find the same. */
static int loaded(const char *uri) {
    char path[LONGEST];
    if (library) return 1;
    if (!path_of(uri, LIBRARY, path, sizeof path)) {
        snprintf(problem, sizeof problem, "the location of the resources is no file: %s",
                 uri ? uri : "(none)");
        return 0;
    }
    void *const opened = OPEN(path);
    if (!opened) {
        snprintf(problem, sizeof problem, "%s: %s", path, WHY);
        return 0;
    }
#define FIND(name, parameters, arguments) *(void **)&its_##name = FOUND(opened, #name);
    EVERY(FIND)
    library = opened;
    return 1;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
    if (loaded(resources))
        return its_fmi2Instantiate(name, type, guid, resources, functions, visible, logging);
    if (functions && functions->logger)
        functions->logger(functions->componentEnvironment, name, fmi2Error, "logStatusError", "%s",
                          problem);
    return NULL;
}
