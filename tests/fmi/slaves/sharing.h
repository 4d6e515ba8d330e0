/* Before a slave's own text: all instances in a process are one, and its memory is never cleared. */

#include <stdlib.h>

static char only[1 << 16];
#define calloc(count, size) ((void *)only)
#define free(memory) ((void)(memory))
