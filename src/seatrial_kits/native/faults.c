/* Faults of devices by their text: `off`, or `bias of=heading value=0.1 at=12 grows_over=3`. */

#include <stdlib.h>
#include <string.h>

#include "runtime.h"

/* fault_names: none and the failures, then what measurements have; SETTING of each of the latter. */

static int number_of(const char *const *names, int count, const char *text, size_t length) {
    for (int i = 0; i < count; i++)
        if (strlen(names[i]) == length && memcmp(names[i], text, length) == 0) return i;
    return -1;
}

/* Read numbers separated by commas; return how many, -1 for what is none. */
static int numbers(const char *text, size_t length, double values[FAULT_VALUES]) {
    const char *const end = text + length;
    int count = 0;
    if (strspn(text, "+-.0123456789eE,") < length) return -1;
    for (;;) {
        char *after;
        if (count == FAULT_VALUES) return -1;
        values[count] = strtod(text, &after);
        if (after == text || after > end || !isfinite(values[count])) return -1;
        count++;
        if (after == end) return count;
        if (*after != ',') return -1;
        text = after + 1;
    }
}

static int read_setting(State *state, const char *part, size_t length, int needed) {
    Fault *fault = &state->fault;
    const char *const equals = memchr(part, '=', length);
    if (!equals) return 0;
    const size_t key = (size_t)(equals - part), rest = length - key - 1;
    const char *const value = equals + 1;
    if (key == 2 && memcmp(part, "of", 2) == 0) {
        fault->of = number_of(fault_measured, FAULT_MEASURED, value, rest);
        if (fault->of < 0) fault->of = FAULT_MEASURED; /* one that there is not */
        return 1;
    }
    double values[FAULT_VALUES];
    const int count = numbers(value, rest, values);
    if (count < 1) return 0;
    if (key == 2 && memcmp(part, "at", 2) == 0) {
        fault->at = values[0];
    } else if (key == 10 && memcmp(part, "grows_over", 10) == 0) {
        fault->grows_over = values[0];
    } else {
        const int setting = number_of(fault_settings, FAULT_SETTINGS, part, key);
        if (setting < 0 || setting != needed) return 0;
        fault->counts[setting] = count;
        memcpy(state->settings[setting], values, sizeof values);
    }
    return 1;
}

/* Return the number of a fault, -1 for a text that is none. */
static int read_fault(State *state, const char *text) {
    Fault *fault = &state->fault;
    size_t length = strcspn(text, " ");
    const int what = number_of(fault_names, FAULT_NAMES, text, length);
    memset(fault, 0, sizeof *fault);
    if (what < 0 || (text[length] != '\0') != (what >= FAULT_PLAIN)) return -1;
    const int needed = what >= FAULT_PLAIN ? fault_needs[what - FAULT_PLAIN] : -1;
    while (text[length] != '\0') {
        text += length + 1;
        length = strcspn(text, " ");
        if (!read_setting(state, text, length, needed)) return -1;
    }
    const int is_whole = needed < 0 || (fault->of > 0 && fault->counts[needed] > 0);
    return is_whole && (needed != 3 || fault->counts[needed] == 5) ? what : -1;
}

void model_text(Instance *self, int text) {
    State *state = &self->state;
    if (text == FAULT_TEXT) state->fault.number = read_fault(state, state->texts[text]);
}

int present_fault(Instance *self) {
    if (self->state.fault.number >= 0) return self->state.fault.number;
    fail(self, "%s.fault: '%s' is no fault that it can have", self->name, self->state.texts[FAULT_TEXT]);
    return 0;
}

int fault_index(Instance *self, int setting, long long index) {
    if (0 <= index && index < self->state.fault.counts[setting]) return (int)index;
    fail(self, "%s.fault: '%s' has too few values", self->name, self->state.texts[FAULT_TEXT]);
    return 0;
}
