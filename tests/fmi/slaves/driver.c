/* A host of FMI 2.0 that is a C program alone, for Linux and Windows. It reads jobs, line by line:

     fmu LIBRARY GUID
     set STEP TYPE REFERENCE VALUE      before that step
     get TYPE REFERENCE
     run SECONDS STEPS

   with types f, i, b, s for reals (in hexadecimal), integers, booleans and strings. It prints for each
   job what it gets after each step, a step a line. Half-way it saves the state as bytes; in the end it
   goes back there and sees that the rest comes again.
   With -DLINKED the FMU is a part of it, whatever LIBRARY is. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

#ifdef LINKED
#include "fmi2Functions.h"
#define OPEN(path) (path)[0]
#define CLOSE() (void)0
#define GET(name) name##_ = name;
#elif defined(_WIN32)
#include <windows.h>
static HMODULE library;
#define OPEN(path) (library = LoadLibraryA(path)) != NULL
#define CLOSE() FreeLibrary(library)
#define GET(name) name##_ = (name##TYPE *)(void (*)(void))GetProcAddress(library, #name);
#else
#include <dlfcn.h>
static void *library;
#define OPEN(path) (library = dlopen(path, RTLD_NOW | RTLD_LOCAL)) != NULL
#define CLOSE() dlclose(library)
#define GET(name) *(void **)&name##_ = dlsym(library, #name);
#endif
#define DECLARE(name) static name##TYPE *name##_;

#define FUNCTIONS(X)                                                                               \
    X(fmi2Instantiate) X(fmi2SetupExperiment) X(fmi2EnterInitializationMode)                       \
    X(fmi2ExitInitializationMode) X(fmi2DoStep) X(fmi2SetReal) X(fmi2SetInteger) X(fmi2SetBoolean) \
    X(fmi2SetString) X(fmi2GetReal) X(fmi2GetInteger) X(fmi2GetBoolean) X(fmi2GetFMUstate)         \
    X(fmi2SetFMUstate) X(fmi2FreeFMUstate) X(fmi2SerializedFMUstateSize) X(fmi2SerializeFMUstate)  \
    X(fmi2DeSerializeFMUstate) X(fmi2Terminate) X(fmi2FreeInstance)
FUNCTIONS(DECLARE)

#define MOST 1024

static struct {
    int step;
    char type, text[256];
    fmi2ValueReference reference;
} changes[MOST];
static struct {
    char type;
    fmi2ValueReference reference;
} watched[MOST];
static int change_count, watched_count;

static void must(int holds, const char *what) {
    if (holds) return;
    fprintf(stderr, "%s\n", what);
    exit(3);
}
#define CALL(name, ...) must(name##_(__VA_ARGS__) == fmi2OK, #name)

static void log_it(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String format, ...) {
    (void)e, (void)name, (void)status, (void)category;
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
}

static void load(const char *path) {
    must(OPEN(path), path);
    FUNCTIONS(GET)
}

static void set(fmi2Component c, char type, fmi2ValueReference reference, const char *text) {
    const fmi2Real real = strtod(text, NULL);
    const fmi2Integer whole = atoi(text);
    if (type == 'f') CALL(fmi2SetReal, c, &reference, 1, &real);
    if (type == 'i') CALL(fmi2SetInteger, c, &reference, 1, &whole);
    if (type == 'b') CALL(fmi2SetBoolean, c, &reference, 1, &whole);
    if (type == 's') CALL(fmi2SetString, c, &reference, 1, &text);
}

static double get(fmi2Component c, char type, fmi2ValueReference reference) {
    fmi2Real real = 0.0;
    fmi2Integer whole = 0;
    if (type == 'f') CALL(fmi2GetReal, c, &reference, 1, &real);
    if (type == 'i') CALL(fmi2GetInteger, c, &reference, 1, &whole);
    if (type == 'b') CALL(fmi2GetBoolean, c, &reference, 1, &whole);
    return type == 'f' ? real : whole;
}

/* Take steps up to `to`, with a row of values each. */
static void step(fmi2Component c, double h, int from, int to, double *rows) {
    for (int k = from; k < to; k++) {
        for (int i = 0; i < change_count; i++)
            if (changes[i].step == k) set(c, changes[i].type, changes[i].reference, changes[i].text);
        CALL(fmi2DoStep, c, k * h, h, 1);
        for (int i = 0; i < watched_count; i++)
            rows[k * watched_count + i] = get(c, watched[i].type, watched[i].reference);
    }
}

/* Return the state as bytes, in memory of just that size. */
static char *saved(fmi2Component c, size_t *size) {
    fmi2FMUstate state = NULL;
    CALL(fmi2GetFMUstate, c, &state);
    CALL(fmi2SerializedFMUstateSize, c, state, size);
    char *bytes = malloc(*size);
    CALL(fmi2SerializeFMUstate, c, state, bytes, *size);
    CALL(fmi2FreeFMUstate, c, &state);
    return bytes;
}

static void restore(fmi2Component c, const char *bytes, size_t size) {
    fmi2FMUstate state = NULL;
    CALL(fmi2DeSerializeFMUstate, c, bytes, size, &state);
    CALL(fmi2SetFMUstate, c, state);
    CALL(fmi2FreeFMUstate, c, &state);
}

static void run(const char *guid, double h, int steps) {
    const fmi2CallbackFunctions functions = {log_it, calloc, free, NULL, NULL};
    const size_t size = sizeof(double) * steps * watched_count;
    double *rows = malloc(size), *again = malloc(size);
    fmi2Component c = fmi2Instantiate_("x", fmi2CoSimulation, guid, "", &functions, 0, 0);
    must(c != NULL, "fmi2Instantiate");
    CALL(fmi2SetupExperiment, c, 0, 0.0, 0.0, 0, 0.0);
    CALL(fmi2EnterInitializationMode, c);
    CALL(fmi2ExitInitializationMode, c);
    const int half = steps / 2;
    size_t length;
    step(c, h, 0, half, rows);
    char *kept = saved(c, &length);
    step(c, h, half, steps, rows);
    memcpy(again, rows, size);
    restore(c, kept, length);
    step(c, h, half, steps, again);
    must(memcmp(rows, again, size) == 0, "another way from a state that was restored");
    for (int k = 0; k < steps; k++)
        for (int i = 0; i < watched_count; i++)
            printf("%a%c", rows[k * watched_count + i], i + 1 < watched_count ? ' ' : '\n');
    CALL(fmi2Terminate, c);
    fmi2FreeInstance_(c);
    free(kept), free(rows), free(again);
}

int main(void) {
    char line[1024], guid[128] = "", path[900];
    int at, steps;
    double h;
    while (fgets(line, sizeof line, stdin)) {
        line[strcspn(line, "\r\n")] = '\0';
        must(change_count < MOST && watched_count < MOST, "too long a job");
        if (sscanf(line, "fmu %899s %127s", path, guid) == 2) {
            load(path);
            change_count = watched_count = 0;
        } else if (sscanf(line, "set %d %c %u %n", &changes[change_count].step,
                          &changes[change_count].type, &changes[change_count].reference, &at) == 3) {
            snprintf(changes[change_count++].text, sizeof changes[0].text, "%.255s", line + at);
        } else if (sscanf(line, "get %c %u", &watched[watched_count].type,
                          &watched[watched_count].reference) == 2) {
            watched_count++;
        } else if (sscanf(line, "run %lf %d", &h, &steps) == 2) {
            run(guid, h, steps);
            CLOSE();
        } else {
            must(0, line);
        }
    }
    return 0;
}
