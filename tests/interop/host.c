/* A host without Python: loads an FMI 2.0 co-simulation FMU, steps it, prints Reals.
 *
 * host LIBRARY GUID RESOURCES STEPS H  INPUT_VR VALUE  OUTPUT_VR...
 */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

typedef void *Component;
typedef unsigned int Ref;
typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

static void logger(void *env, const char *name, int status, const char *category,
                   const char *message, ...) {
    (void)env;
    va_list arguments;
    va_start(arguments, message);
    fprintf(stderr, "[%s %d %s] ", name, status, category ? category : "");
    vfprintf(stderr, message, arguments);
    fputc('\n', stderr);
    va_end(arguments);
}

static void *library;

static void *function(const char *name) {
    void *found = dlsym(library, name);
    if (!found) { fprintf(stderr, "no %s\n", name); _exit(2); }
    return found;
}

#define CHECK(call) do { int s = (call); if (s > 1) { \
    fprintf(stderr, "%s: status %d\n", #call, s); _exit(3); } } while (0)

int main(int argc, char **argv) {
    if (argc < 9) { fprintf(stderr, "usage\n"); return 2; }
    library = dlopen(argv[1], RTLD_NOW);
    if (!library) { fprintf(stderr, "%s\n", dlerror()); return 2; }
    Component (*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int,
                             int) = function("fmi2Instantiate");
    int (*setup)(Component, int, double, double, int, double) = function("fmi2SetupExperiment");
    int (*enter)(Component) = function("fmi2EnterInitializationMode");
    int (*leave)(Component) = function("fmi2ExitInitializationMode");
    int (*set)(Component, const Ref *, size_t, const double *) = function("fmi2SetReal");
    int (*get)(Component, const Ref *, size_t, double *) = function("fmi2GetReal");
    int (*step)(Component, double, double, int) = function("fmi2DoStep");
    int (*terminate)(Component) = function("fmi2Terminate");
    void (*release)(Component) = function("fmi2FreeInstance");

    Callbacks callbacks = {logger, calloc, free, NULL, NULL};
    int steps = atoi(argv[4]);
    double h = atof(argv[5]), value = atof(argv[7]);
    Ref input = (Ref)atoi(argv[6]);
    for (int life = 0; life < 2; life++) { /* the second one finds an interpreter running */
        Component c = instantiate("host", 1, argv[2], argv[3], &callbacks, 0, 1);
        if (!c) { fprintf(stderr, "not instantiated\n"); return 3; }
        CHECK(setup(c, 0, 0.0, 0.0, 0, 0.0));
        CHECK(enter(c));
        CHECK(leave(c));
        CHECK(set(c, &input, 1, &value));
        for (int k = 0; k < steps; k++) CHECK(step(c, k * h, h, 1));
        for (int i = 8; i < argc; i++) {
            Ref vr = (Ref)atoi(argv[i]);
            double out;
            CHECK(get(c, &vr, 1, &out));
            printf("%.17g ", out);
        }
        printf("\n");
        CHECK(terminate(c));
        release(c);
    }
    fflush(stdout);
    /* pythonfmu 0.7's library frees its state twice in its destructor: leave without it. */
    _exit(0);
}
