/* Stands for RenderDoc in the tests: the functions that the worker calls, at their places in version 1.1.2. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static int started, ended;

static void start(void *device, void *window) { started += !device && !window; }
static uint32_t end(void *device, void *window) { return (ended += !device && !window) == started; }
static uint32_t count(void) { return ended; }

static uint32_t name(uint32_t index, char *file, uint32_t *bytes, uint64_t *time) {
    char text[32];
    snprintf(text, sizeof text, "frame%u.rdc", index);
    *bytes = strlen(text) + 1;
    if (file) memcpy(file, text, *bytes);
    (void)time;
    return index + 1 == (uint32_t)ended;
}

static void *functions[23];

int RENDERDOC_GetAPI(int version, void **api) {
    functions[13] = count;
    functions[14] = name;
    functions[19] = start;
    functions[21] = end;
    *api = functions;
    return version == 10102;
}
