/* pythonfmu's library, loaded from the FMU's resources into a process that has a Python. */

#ifdef _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FOUND(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#define WHY "Windows cannot load it, or a library that it needs"
#define LIBRARY "pythonfmu-export.dll"
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FOUND(library, name) dlsym(library, name)
#define WHY dlerror()
#define LIBRARY "libpythonfmu-export.so"
#endif

#include <stdio.h>

#include "forwarded.h"

/* Twice at once does no harm, as both find the same. */
const Forwarded *library_of(const char *resources, char *problem, size_t capacity) {
    static Forwarded its;
    static int is_loaded;
    char path[LONGEST];
    if (is_loaded) return &its;
    snprintf(path, sizeof path, "%s/pythonfmu/%s", resources, LIBRARY);
    void *const library = OPEN(path);
    if (!library) {
        snprintf(problem, capacity, "%s: %s", path, WHY);
        return NULL;
    }
#define FIND(name) *(void **)&its.name = FOUND(library, #name);
    FORWARDED(FIND)
    is_loaded = 1;
    return &its;
}
