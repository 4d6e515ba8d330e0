/* The folder of an FMU's resources: from its URI, or from what hosts pass instead. */

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "folder.h"
#include "forwarded.h"

#define SCRIPT 256 /* characters of the name of the FMU's script, at most */

/* Return the path in a URI of a file, whatever its number of slashes; a path alone is one too. */
static const char *path_in(const char *location) {
    const char *path = location ? location : "";
    if (!strncmp(path, "file://", 7)) {
        path += 7;
        if (*path != '/') path = strchr(path, '/'); /* file://localhost/... */
    } else if (!strncmp(path, "file:", 5)) {
        path += 5;
    } else if (strstr(path, "://")) {
        return NULL;
    }
#ifdef _WIN32
    if (path && *path == '/') path++; /* /C:/... */
#endif
    return path && *path ? path : NULL;
}

static void copied(const char *path, int decodes, char *folder, size_t capacity) {
    size_t n = 0;
    for (; *path && n + 1 < capacity; path++) {
        const char digits[] = {path[0] == '%' ? path[1] : 0, path[0] == '%' && path[1] ? path[2] : 0, 0};
        const int is_code = isxdigit((unsigned char)digits[0]) && isxdigit((unsigned char)digits[1]);
        folder[n++] = decodes && is_code ? (char)strtol(digits, NULL, 16) : *path;
        if (decodes && is_code) path += 2;
    }
    while (n > 1 && folder[n - 1] == '/') n--;
    folder[n] = '\0';
}

/* Whether the script that pythonfmu's library runs can be opened, as that library does it. */
static int has_script(const char *folder) {
    char path[LONGEST + SCRIPT], name[SCRIPT] = "";
    snprintf(path, sizeof path, "%s/slavemodule.txt", folder);
    FILE *file = fopen(path, "r");
    if (!file) return 0;
    if (!fgets(name, sizeof name, file)) name[0] = '\0';
    fclose(file);
    name[strcspn(name, "\r\n")] = '\0';
    snprintf(path, sizeof path, "%s/%s.py", folder, name);
    file = fopen(path, "r");
    if (file) fclose(file);
    return file != NULL;
}

int folder_of(const char *location, char *folder, size_t capacity, char *problem, size_t problem_capacity) {
    const char *const path = path_in(location);
    if (!path) {
        snprintf(problem, problem_capacity, "the location of the resources is no file: %s",
                 location ? location : "(none)");
        return 0;
    }
    if (strlen(path) + SCRIPT >= capacity) {
        snprintf(problem, problem_capacity, "the path of the resources is longer than %zu bytes",
                 capacity - SCRIPT);
        return 0;
    }
    copied(path, 1, folder, capacity);
    if (!has_script(folder)) { /* a path that was not encoded, of FMI 3.0 say */
        copied(path, 0, folder, capacity);
        if (!has_script(folder)) {
            snprintf(problem, problem_capacity,
                     "the script that slavemodule.txt names cannot be opened in %s", folder);
            return 0;
        }
    }
    if (strstr(folder, "%20")) {
        snprintf(problem, problem_capacity,
                 "pythonfmu takes %%20 for a space, and the path of the resources has it: %s",
                 folder);
        return 0;
    }
    return 1;
}
