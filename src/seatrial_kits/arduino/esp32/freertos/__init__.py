"""FreeRTOS as far as sketches use it."""

DATA_FILES = (
    "FreeRTOS.h",
    "event_groups.h",
    "portmacro.h",
    "queue.h",
    "semphr.h",
    "task.h",
    "timers.h",
)
