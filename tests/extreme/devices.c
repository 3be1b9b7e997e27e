/* devices.c - the devices' table: Vulkan and GL by examples/frame's runner, the CPU by tests/twin. */
#include <stdlib.h>
#include <string.h>

#include "devices.h"
#include "../../examples/frame/runner.h"
#include "../twin/twin.h"

/* How a kind of device is opened and run; `name` goes to open. */
typedef struct device_kind {
    const char *name, *target;
    void     *(*open)(const char *name, char *error, size_t size);
    void      (*close)(void *it);
    int       (*run)(void *it, const hbil_plan *plan, const hbil_frame *frame, const image *inputs, image *outputs, char *error, size_t size);
    int       (*text)(void *it, const char *pass, const char *text);
    int       (*hook)(void *it, const char *text);
} device_kind;

struct device { const device_kind *kind; void *it; };

static void *open_runner(const char *name, char *error, size_t size) { return runner_open(name, 0, error, size); }
static void close_runner(void *it) { runner_close((runner *)it); }
static int text_runner(void *it, const char *pass, const char *text) { return runner_text((runner *)it, pass, text); }
static int hook_runner(void *it, const char *text) { return runner_hook((runner *)it, text); }
static int run_runner(void *it, const hbil_plan *plan, const hbil_frame *frame, const image *inputs, image *outputs, char *error, size_t size)
{
    return runner_run((runner *)it, plan, frame, inputs, outputs, 1, NULL, error, size);
}

/* min and max of NaN give NaN: the worst that GLSL allows. loose: what Vulkan allows of precision, too. */
static void *open_twin(const char *name, char *error, size_t size)
{
    twin *t = twin_open(TWIN_FLOAT, strcmp(name, "loose") == 0 ? TWIN_STICKY | TWIN_LOOSE : TWIN_STICKY);
    if (!t) frame_error(error, size, "%s: out of memory", name);
    return t;
}
static void close_twin(void *it) { twin_close((twin *)it); }
static int text_twin(void *it, const char *pass, const char *text) { return twin_text((twin *)it, pass, text); }
static int hook_twin(void *it, const char *text) { return twin_hook((twin *)it, text); }
static int run_twin(void *it, const hbil_plan *plan, const hbil_frame *frame, const image *inputs, image *outputs, char *error, size_t size)
{
    if (!twin_run((twin *)it, plan, frame, inputs, outputs, error, size)) return 0;
    if (twin_faultless((twin *)it, error, size)) return 1;
    twin_forgive((twin *)it);
    return 0;
}

static const device_kind kinds[] = {
    { "vulkan", "vulkan", open_runner, close_runner, run_runner, text_runner, hook_runner },
    { "gl", "gl", open_runner, close_runner, run_runner, text_runner, hook_runner },
    { "gles", "gles", open_runner, close_runner, run_runner, text_runner, hook_runner },
    { "twin", "vulkan", open_twin, close_twin, run_twin, text_twin, hook_twin },
    { "loose", "vulkan", open_twin, close_twin, run_twin, text_twin, hook_twin },
};

int device_known(const char *name)
{
    size_t i;
    for (i = 0; i < sizeof kinds / sizeof *kinds; ++i)
        if (strcmp(kinds[i].name, name) == 0) return 1;
    return 0;
}

device *device_open(const char *name, char *error, size_t error_size)
{
    size_t i;
    for (i = 0; i < sizeof kinds / sizeof *kinds; ++i) {
        device *d;
        if (strcmp(kinds[i].name, name) != 0) continue;
        d = (device *)malloc(sizeof *d);
        if (!d) return frame_error(error, error_size, "out of memory"), NULL;
        d->kind = &kinds[i];
        d->it = kinds[i].open(name, error, error_size);
        if (d->it) return d;
        free(d);
        return NULL;
    }
    frame_error(error, error_size, "%s: no such device; " DEVICES, name);
    return NULL;
}

void device_close(device *d)
{
    if (!d) return;
    d->kind->close(d->it);
    free(d);
}

const char *device_name(const device *d) { return d->kind->name; }
const char *device_target(const device *d) { return d->kind->target; }

int device_run(device *d, const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
               image outputs[HBIL_MAX_TEXTURES], char *error, size_t error_size)
{
    return d->kind->run(d->it, plan, frame, inputs, outputs, error, error_size);
}

int device_text(device *d, const char *pass, const char *text)
{
    return d->kind->text(d->it, pass, text);
}

int device_hook(device *d, const char *text)
{
    return d->kind->hook(d->it, text);
}
