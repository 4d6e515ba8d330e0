/* A slave of FMI 2.0 or 3.0 (FMI = 2, 3) with SIZE numbers, each read and set by its reference;
a step adds its length to the last one. */

#include <stdlib.h>

#if FMI == 2
#include "fmi2FunctionTypes.h"
#define NUMBER(word) fmi2##word##Real
#define COUNT
#else
#include "fmi3FunctionTypes.h"
#include <stdbool.h>
#define NUMBER(word) fmi3##word##Float64
#define COUNT , size_t count
#endif
#define EXPORT(name) API(FMI, name)
#define API(version, name) API_(version, name)
#define API_(version, name) fmi##version##name

int NUMBER(Get)(double *c, const unsigned r[], size_t n, double v[] COUNT) {
    for (size_t i = 0; i < n; i++) v[i] = c[r[i]];
    return 0;
}
int NUMBER(Set)(double *c, const unsigned r[], size_t n, const double v[] COUNT) {
    for (size_t i = 0; i < n; i++) c[r[i]] = v[i];
    return 0;
}
void EXPORT(FreeInstance)(double *c) { free(c); }
int EXPORT(ExitInitializationMode)(double *c) { return 0; }
int EXPORT(Terminate)(double *c) { return 0; }

#if FMI == 2
double *fmi2Instantiate(const char *a, int b, const char *c, const char *d, const void *e, int f,
                        int g) {
    return calloc(SIZE, sizeof(double));
}
int fmi2SetupExperiment(double *c, int a, double b, double d, int e, double f) { return 0; }
int fmi2EnterInitializationMode(double *c) { return 0; }
int fmi2DoStep(double *c, double t, double h, int a) {
    c[SIZE - 1] += h;
    return 0;
}
#else
double *fmi3InstantiateCoSimulation(const char *a, const char *b, const char *c, bool d, bool e,
                                    bool f, bool g, const unsigned r[], size_t n, void *h, void *i,
                                    void *j) {
    return calloc(SIZE, sizeof(double));
}
int fmi3EnterInitializationMode(double *c, bool a, double b, double d, bool e, double f) {
    return 0;
}
int fmi3DoStep(double *c, double t, double h, bool a, bool *event, bool *end, bool *early,
               double *reached) {
    *event = *end = *early = false;
    *reached = t + h;
    c[SIZE - 1] += h;
    return 0;
}
#endif
