/* hbil-viewer - a small renderer with hbil.h in it: walk about, switch presets and options, see each output.
 *
 * For what an engine does with hbil.h, read light.c (a config becomes a plan), then gpu_vk.c or gpu_gl.c (a plan
 * meets a G-buffer), then draw_frame here (what changes from frame to frame). */
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define HBIL_IMPLEMENTATION
#include "../../hbil.h"
#include "../frame/image.h"
#include "camera.h"
#include "light.h"
#include "model.h"
#include "overlay.h"

enum { DONE = 0, REFUSED = 1, USAGE = 2, FILES = 3, BACKEND = 5 };

typedef struct arguments {
    const char  *scene, *model, *preset, *view, *png, *screenshot, *press;
    const char **sets;
    int          set_count, gl, headless, validate, frames, width, height;
    float        exposure;   /* 0: the model's */
} arguments;

typedef struct app {
    arguments      args;
    light          light;
    model          model;
    int            scene;    /* built-in scene shown; -1: a file */
    camera         camera;
    const gpu_ops *gpu;
    void          *device;
    char           device_name[128];
    GLFWwindow    *window;   /* NULL: headless */
    int            width, height;

    uint32_t       index;    /* frames drawn */
    uint32_t       since;    /* the first of them with this plan and scene */
    int            reset;    /* 1: the next frame has no last one */
    float          last_view[16], last_projection[16];
    int            view, overlay;
    float          split;    /* pixels */
    int            refused, row; /* values in a row that the key of option_keys[row] was refused */
    double         mouse[2]; /* where a drag was last; pixels of the window */
    char           message[512]; /* in the overlay, until `until` */
    double         until;
    gpu_time       times[GPU_TIMES];
    int            time_count;
    int            code;     /* exit code, once something failed */
    char           error[1024];
} app;

#define FAULT(a, ...) frame_error((a)->error, sizeof (a)->error, __VA_ARGS__)

static int fail(app *a, int code)
{
    fprintf(stderr, "hbil-viewer: %s\n", a->error);
    a->code = code;
    return code;
}

static double seconds(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- changes while running --------------------------------------------------------------------------------------- */

/* Shown for a while; printed too, where there is no overlay to read. */
static void say(app *a, const char *text)
{
    snprintf(a->message, sizeof a->message, "%.*s", (int)sizeof a->message - 1, text);
    a->until = seconds() + 4.0;
    fprintf(stderr, "%s\n", text);
}

/* Use `next` from the next frame on, or say why not and stay with what is: 0. text: what has changed, or room for
 * what hbil.h notes. */
static int change_light(app *a, light *next, const char *about, char *text, size_t text_size)
{
    const int built = light_build(next, a->args.gl, about, text, text_size);
    const int used = built && a->gpu->plan(a->device, &next->plan);

    if (used) {
        a->light = *next;
        a->reset = 1; /* the new plan's history is empty */
        a->since = a->index;
    }
    say(a, built && !used ? a->error : text);
    return used;
}

static void set_preset(app *a, const char *name)
{
    light next = a->light;
    char  text[sizeof a->message];

    if (!light_preset(&next, name, text, sizeof text)) {
        say(a, text);
        return;
    }
    snprintf(text, sizeof text, "preset %s", name);
    change_light(a, &next, NULL, text, sizeof text);
}

/* by: 1 the next preset, -1 the one before. */
static void step_preset(app *a, int by)
{
    int count = 0, at = 0;

    while (hbil_preset_name(count)) count++;
    while (at < count && strcmp(hbil_preset_name(at), a->light.preset) != 0) at++;
    set_preset(a, hbil_preset_name((at + by + count) % count));
}

static void next_preset(app *a) { step_preset(a, 1); }
static void last_preset(app *a) { step_preset(a, -1); }

static void next_view(app *a)
{
    if (!light_view_at(++a->view)) a->view = 0;
    say(a, light_view_at(a->view)->name);
}

static void next_scene(app *a)
{
    model next;

    if (a->scene < 0) {
        say(a, "a file is shown: start without --model for the built-in scenes");
        return;
    }
    if (!model_scene_name(++a->scene)) a->scene = 0;
    if (!model_scene(&next, model_scene_name(a->scene), a->error, sizeof a->error) ||
        !a->gpu->model(a->device, next.vertices, next.count)) {
        model_free(&next);
        fail(a, BACKEND); /* nothing is left to draw */
        return;
    }
    model_free(&a->model);
    a->model = next;
    camera_start(&a->camera, &a->model, 0.0f);
    a->reset = 1;
    a->since = a->index;
    say(a, model_scene_name(a->scene));
}

static void restart_camera(app *a)
{
    camera_start(&a->camera, &a->model, 0.0f);
    a->reset = 1; /* a cut */
}

static void switch_overlay(app *a) { a->overlay = !a->overlay; }
static void brighter(app *a) { a->model.exposure *= 1.25f; }
static void darker(app *a) { a->model.exposure /= 1.25f; }
static void quit(app *a) { if (a->window) glfwSetWindowShouldClose(a->window, 1); }

/* ---- keys -------------------------------------------------------------------------------------------------------- */

#define COUNTS "1 2 3 4 6 8 12 16 24 32 64"

/* Each option of hbil.h that has a key. shift: 1 with Shift, 0 without, -1 either way. */
static const struct { int key, shift; const char *label, *option, *values; int by, ends; } option_keys[] = {
    {GLFW_KEY_EQUAL, -1, "+", "slices", COUNTS, 1, 1},
    {GLFW_KEY_MINUS, -1, "-", "slices", COUNTS, -1, 1},
    {GLFW_KEY_RIGHT_BRACKET, -1, "]", "steps", COUNTS, 1, 1},
    {GLFW_KEY_LEFT_BRACKET, -1, "[", "steps", COUNTS, -1, 1},
    {GLFW_KEY_M, -1, "M", "march", "sampled sweep both", 1, 0},
    {GLFW_KEY_E, 1, "Shift+E", "estimator", "horizon bitmask hbao hbao_plus", 1, 0},
    {GLFW_KEY_O, -1, "O", "occluder", "height_field thick heuristic", 1, 0},
    {GLFW_KEY_T, -1, "T", "temporal", "no yes", 1, 0},
    {GLFW_KEY_F, -1, "F", "filter", "none 3x3 5x5", 1, 0},
    {GLFW_KEY_D, 1, "Shift+D", "downscale", "1 2 4", 1, 0},
    {GLFW_KEY_R, -1, "R", "bounces", "one recursive", 1, 0},
    {GLFW_KEY_P, -1, "P", "reproject", "camera gather scatter", 1, 0},
    {GLFW_KEY_G, -1, "G", "facing", "none filter half_space", 1, 0},
    {GLFW_KEY_N, -1, "N", "noise", "none ign hilbert_r2", 1, 0},
    {GLFW_KEY_I, -1, "I", "interleave", "no yes", 1, 0},
    {GLFW_KEY_L, -1, "L", "environment", "none constant sh", 1, 0},
};

static const struct { int key; const char *label, *what; void (*act)(app *a); } action_keys[] = {
    {GLFW_KEY_PAGE_DOWN, "PageDown", "next preset", next_preset},
    {GLFW_KEY_PAGE_UP, "PageUp", "preset before", last_preset},
    {GLFW_KEY_V, "V", "next view", next_view},
    {GLFW_KEY_TAB, "Tab", "next built-in scene", next_scene},
    {GLFW_KEY_HOME, "Home", "camera back to where it began", restart_camera},
    {GLFW_KEY_H, "H", "text on or off", switch_overlay},
    {GLFW_KEY_PERIOD, ".", "brighter", brighter},
    {GLFW_KEY_COMMA, ",", "darker", darker},
    {GLFW_KEY_ESCAPE, "Esc", "end", quit},
};

/* Held down without Shift. move: along right, forward and up. */
static const struct { int key; const char *label; float move[3]; } camera_keys[] = {
    {GLFW_KEY_W, "W", {0.0f, 1.0f, 0.0f}},  {GLFW_KEY_S, "S", {0.0f, -1.0f, 0.0f}},
    {GLFW_KEY_A, "A", {-1.0f, 0.0f, 0.0f}}, {GLFW_KEY_D, "D", {1.0f, 0.0f, 0.0f}},
    {GLFW_KEY_E, "E", {0.0f, 0.0f, 1.0f}},  {GLFW_KEY_Q, "Q", {0.0f, 0.0f, -1.0f}},
};
#define COUNT(table) (sizeof(table) / sizeof *(table))

/* The next value of an option. Where the last press was refused, the one behind that. */
static void step_option(app *a, int row)
{
    light next = a->light;
    char  text[sizeof a->message];
    const char *option = option_keys[row].option, *values = option_keys[row].values;
    int   by = option_keys[row].by;

    if (row != a->row) a->refused = 0;
    a->row = row;
    by *= 1 + a->refused;
    if (!light_step(&next, option, values, by, option_keys[row].ends, text, sizeof text)) {
        say(a, text);
        a->refused = 0;
    } else {
        a->refused = change_light(a, &next, option, text, sizeof text) ? 0 : a->refused + 1;
    }
}

static void press(app *a, int key, int shift)
{
    size_t i;

    if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) {
        const char *name = hbil_preset_name((key - GLFW_KEY_0 + 9) % 10); /* 1 is the first, 0 the tenth */
        if (name) set_preset(a, name);
    }
    for (i = 0; i < COUNT(action_keys); i++)
        if (key == action_keys[i].key) action_keys[i].act(a);
    for (i = 0; i < COUNT(option_keys); i++)
        if (key == option_keys[i].key && (option_keys[i].shift < 0 || option_keys[i].shift == shift))
            step_option(a, (int)i);
}

/* The key of a label: its length, and which one it is; 0: there is none. */
static size_t find_key(const char *text, int *key, int *shift)
{
    const size_t length = strcspn(text, " ");
    size_t       i;

    *shift = 0;
    *key = length == 1 && *text >= '0' && *text <= '9' ? GLFW_KEY_0 + (*text - '0') : 0;
    for (i = 0; i < COUNT(action_keys); i++)
        if (strlen(action_keys[i].label) == length && strncmp(text, action_keys[i].label, length) == 0)
            *key = action_keys[i].key;
    for (i = 0; i < COUNT(option_keys); i++) {
        if (strlen(option_keys[i].label) != length || strncmp(text, option_keys[i].label, length) != 0) continue;
        *key = option_keys[i].key;
        *shift = option_keys[i].shift == 1;
    }
    return *key ? length : 0;
}

/* The next one of --press. */
static void press_next(app *a)
{
    int    key, shift;
    size_t length = a->args.press ? find_key(a->args.press, &key, &shift) : 0;

    if (!length) return;
    a->args.press += length + strspn(a->args.press + length, " ");
    press(a, key, shift);
}

static void on_key(GLFWwindow *window, int key, int scancode, int action, int mods)
{
    (void)scancode;
    if (action == GLFW_PRESS) press(glfwGetWindowUserPointer(window), key, (mods & GLFW_MOD_SHIFT) != 0);
}

static void on_mouse(GLFWwindow *window, double x, double y)
{
    app   *a = glfwGetWindowUserPointer(window);
    int    width, height;

    glfwGetWindowSize(window, &width, &height);
    a->split = (float)(x * a->width / (width > 0 ? width : 1));
    if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
        /* what is seen follows the mouse */
        const float turn = 2.0f * a->camera.half_fov / (float)(height > 0 ? height : 1);
        a->camera.yaw += turn * (float)(x - a->mouse[0]);
        a->camera.pitch = fmaxf(-1.5f, fminf(1.5f, a->camera.pitch + turn * (float)(y - a->mouse[1])));
    }
    a->mouse[0] = x;
    a->mouse[1] = y;
}

static void move_camera(app *a, double elapsed)
{
    const float length = 0.5f * a->model.radius * (float)elapsed;
    float       move[3] = {0.0f, 0.0f, 0.0f};
    size_t      i;
    int         c;

    if (glfwGetKey(a->window, GLFW_KEY_LEFT_SHIFT) || glfwGetKey(a->window, GLFW_KEY_RIGHT_SHIFT)) return;
    for (i = 0; i < COUNT(camera_keys); i++)
        for (c = 0; c < 3; c++)
            if (glfwGetKey(a->window, camera_keys[i].key)) move[c] += length * camera_keys[i].move[c];
    camera_move(&a->camera, move);
}

/* ---- command line ------------------------------------------------------------------------------------------------ */

static void print_help(void)
{
    size_t i;
    int    k;

    fputs("usage: hbil-viewer [--scene NAME | --model FILE] [options]\n"
          "Draws a scene with sun and sky, lights it with hbil.h, and shows what each pass costs.\n\n"
          "  --scene NAME      a built-in scene: ", stdout);
    for (k = 0; model_scene_name(k); k++) printf("%s%s", k ? ", " : "", model_scene_name(k));
    fputs("; the first by default\n"
          "  --model FILE      glTF, OBJ or what else assimp reads; colours, emission and the camera, no textures\n"
          "  --gl              OpenGL 4.3 instead of Vulkan 1.3\n"
          "  --preset P        where the config begins, default balanced\n"
          "  --set A=B,C=D     options of the config; may be repeated. Outputs set here are not added to by the views\n"
          "  --view V          what is shown first\n"
          "  --exposure X      factor of all light before tone mapping\n"
          "  --size WxH        pixels, default 1280x720, headless 640x360\n"
          "  --frames N        end after N frames, during which the camera swings about the scene\n"
          "  --headless        without a window: Vulkan, or with --gl a context of EGL or OSMesa; wants --frames\n"
          "  --png DIR         headless: write frame-000.png and so on; DIR is made if need be\n"
          "  --screenshot FILE with a window and --frames: the last picture as it was presented\n"
          "  --press KEYS      press these, one before each frame from the second on, as in \"V Shift+D 3\"\n"
          "  --validate        with the validation layer (Vulkan) or debug output (GL); a message is a failure\n"
          "  --help\n\n"
          "keys:\n"
          "  1 to 9, 0         the first ten presets\n", stdout);
    for (i = 0; i < COUNT(action_keys); i++) printf("  %-17s %s\n", action_keys[i].label, action_keys[i].what);
    for (i = 0; i < COUNT(option_keys); i++)
        printf("  %-17s %s: %s %s\n", option_keys[i].label, option_keys[i].option,
               !option_keys[i].ends ? "next of" : option_keys[i].by > 0 ? "more of" : "less of", option_keys[i].values);
    fputs("  mouse             drag to look around; in the view split it moves the line\n ", stdout);
    for (i = 0; i < COUNT(camera_keys); i++) printf(" %s", camera_keys[i].label);
    puts("       move: forward, back, left, right, up, down\n\nviews:");
    for (k = 0; light_view_at(k); k++) printf("  %-17s %s\n", light_view_at(k)->name, light_view_at(k)->what);
    puts("\npresets:");
    for (k = 0; hbil_preset_name(k); k++) printf("  %-17s %s\n", hbil_preset_name(k), hbil_preset_meaning(k));
    puts("\nexit: 0 done; 1 config refused; 2 usage; 3 a file cannot be read or written; 5 window, backend or driver\n"
         "      missing or failed, or a message of --validate");
}

/* Whole number in [min, max] and nothing behind it. */
static int read_int(const char *text, int min, int max, int *out)
{
    char *end;
    long  value = strtol(text, &end, 10);

    if (end == text || *end || value < min || value > max) return 0;
    *out = (int)value;
    return 1;
}

static int read_size(const char *text, int *width, int *height)
{
    char        first[8];
    const char *x = strchr(text, 'x');

    if (!x || x - text >= (int)sizeof first) return 0;
    memcpy(first, text, (size_t)(x - text));
    first[x - text] = 0;
    return read_int(first, 1, 8192, width) && read_int(x + 1, 1, 8192, height);
}

static int read_argument(app *a, const char *name, const char *value)
{
    const struct { const char *name; const char **target; } texts[] = {
        {"--scene", &a->args.scene}, {"--model", &a->args.model}, {"--preset", &a->args.preset},
        {"--view", &a->args.view},   {"--png", &a->args.png},     {"--screenshot", &a->args.screenshot},
        {"--press", &a->args.press},
    };
    char  *end;
    size_t i;

    if (!value || !*value || strncmp(value, "--", 2) == 0)
        return FAULT(a, "%s: unknown, or without its value; hbil-viewer --help lists all", name);
    for (i = 0; i < COUNT(texts); i++) {
        if (strcmp(name, texts[i].name) != 0) continue;
        *texts[i].target = value;
        return 1;
    }
    if (strcmp(name, "--set") == 0) return a->args.sets[a->args.set_count++] = value, 1;
    if (strcmp(name, "--size") == 0)
        return read_size(value, &a->args.width, &a->args.height)
            || FAULT(a, "--size %s: must be WxH, each in [1, 8192], as in 640x360", value);
    if (strcmp(name, "--frames") == 0)
        return read_int(value, 1, 99999, &a->args.frames)
            || FAULT(a, "--frames %s: must be a whole number in [1, 99999]", value);
    if (strcmp(name, "--exposure") == 0) {
        a->args.exposure = strtof(value, &end);
        return (!*end && a->args.exposure > 0.0f && a->args.exposure < 1e6f)
            || FAULT(a, "--exposure %s: must be a number above 0", value);
    }
    return FAULT(a, "%s: unknown; hbil-viewer --help lists all", name);
}

static int check_arguments(app *a)
{
    arguments  *g = &a->args;
    const char *press;
    size_t      length;
    int         i, key, shift;

    if (g->scene && g->model) return FAULT(a, "--scene and --model: give one of them");
    for (i = 0; g->scene && model_scene_name(i) && strcmp(g->scene, model_scene_name(i)) != 0; i++) {}
    if (g->scene && !model_scene_name(i))
        return FAULT(a, "--scene %s: must be one of those that hbil-viewer --help lists", g->scene);
    a->scene = g->model ? -1 : g->scene ? i : 0;
    for (i = 0; g->view && light_view_at(i) && strcmp(g->view, light_view_at(i)->name) != 0; i++) {}
    if (g->view && !light_view_at(i))
        return FAULT(a, "--view %s: must be one of those that hbil-viewer --help lists", g->view);
    a->view = i;
    if (g->headless && !g->frames) return FAULT(a, "--headless needs --frames N");
    if (g->png && !g->headless) return FAULT(a, "--png belongs to --headless; with a window "
                                                   "it is --screenshot FILE");
    if (g->screenshot && (g->headless || !g->frames))
        return FAULT(a, "--screenshot needs a window and --frames N; headless it is --png DIR");
    for (press = g->press; press && *press; press += length + strspn(press + length, " "))
        if (!(length = find_key(press, &key, &shift)))
            return FAULT(a, "--press: no key %s; hbil-viewer --help lists all", press);
    if (!g->width) {
        g->width = g->headless ? 640 : 1280;
        g->height = g->headless ? 360 : 720;
    }
    return 1;
}

static int parse_arguments(app *a, int argc, char **argv)
{
    const struct { const char *name; int *target; } flags[] = {
        {"--gl", &a->args.gl}, {"--headless", &a->args.headless}, {"--validate", &a->args.validate}};
    size_t f;
    int    i;

    for (i = 1; i < argc; i++) {
        for (f = 0; f < COUNT(flags) && strcmp(argv[i], flags[f].name) != 0; f++) {}
        if (f < COUNT(flags)) *flags[f].target = 1;
        else if (!read_argument(a, argv[i], i + 1 < argc ? argv[i + 1] : NULL)) return 0;
        else i++;
    }
    return check_arguments(a);
}

/* ---- one frame --------------------------------------------------------------------------------------------------- */

static void write_overlay(app *a, char *text, size_t size)
{
    const light_view *view = light_view_at(a->view);
    double            total = 0.0;
    size_t            used;
    int               i;

    used = (size_t)snprintf(text, size, "%s, %s, %dx%d\npreset %s, view %s\n\n", a->device_name, a->gpu->name, a->width,
                            a->height, a->light.preset, view->name);
    for (i = 0; i < a->time_count && used < size; i++) {
        used += (size_t)snprintf(text + used, size - used, "%8.2f ms  %s\n", a->times[i].ms, a->times[i].name);
        total += a->times[i].ms;
    }
    if (used < size) used += (size_t)snprintf(text + used, size - used, "%8.2f ms  all\n\n", total);
    if (used < size && seconds() < a->until) snprintf(text + used, size - used, "%s", a->message);
}

/* pixels: NULL, or where the picture goes. */
static int draw_frame(app *a, unsigned char *pixels)
{
    static float corners[TEXT_CORNERS * 3];
    char         text[2048];
    gpu_frame    f;
    gpu_mode     mode;
    float        view[16], projection[16];
    const int    split = strcmp(light_view_at(a->view)->name, "split") == 0;

    memset(&f, 0, sizeof f);
    camera_view(&a->camera, view);
    camera_projection(&a->camera, a->width, a->height, a->args.gl, projection);
    if (a->reset) {
        memcpy(a->last_view, view, sizeof view);
        memcpy(a->last_projection, projection, sizeof projection);
    }
    camera_uniforms(&a->camera, &a->model, a->args.gl, view, projection, &f.scene);
    matrix_multiply(a->last_projection, a->last_view, f.scene.last_clip);
    f.scene.size[0] = (float)a->width;
    f.scene.size[1] = (float)a->height;
    f.scene.exposure = a->model.exposure;
    f.scene.split = split ? a->split : -10.0f;

    /* what hbil.h wants to know of this frame */
    f.light.width = (uint32_t)a->width;
    f.light.height = (uint32_t)a->height;
    f.light.index = a->index++;
    memcpy(f.light.projection, projection, sizeof projection);
    memcpy(f.light.view, view, sizeof view);
    memcpy(f.light.last_projection, a->last_projection, sizeof projection);
    memcpy(f.light.last_view, a->last_view, sizeof view);
    f.light.reset = a->reset ? 1 : 0;
    f.light.live = &a->light.plan.config;
    light_sky(&f.scene, &f.light);

    if (!light_show(&a->light.plan, light_view_at(a->view), &f.shown, &mode) && a->window)
        snprintf(a->message, sizeof a->message, "this config has no output %s", light_view_at(a->view)->output);
    f.scene.mode = (int32_t)mode;
    f.pixels = pixels;
    if (a->overlay) {
        write_overlay(a, text, sizeof text);
        f.text = corners;
        f.text_corners = overlay_text(corners, TEXT_CORNERS, text, 8.0f, 8.0f, a->height >= 1000 ? 2.0f : 1.0f);
    }
    if (!a->gpu->frame(a->device, &f)) return 0;
    a->time_count = a->gpu->times(a->device, a->times);
    a->reset = 0;
    memcpy(a->last_view, view, sizeof view);
    memcpy(a->last_projection, projection, sizeof projection);
    return 1;
}

/* ---- pictures and times ------------------------------------------------------------------------------------------ */

static int write_picture(app *a, const char *path, const unsigned char *pixels)
{
    image  picture;
    size_t i, count = (size_t)a->width * (size_t)a->height;
    int    c, ok;

    if (!image_make(&picture, a->width, a->height, 3)) return FAULT(a, "%s: out of memory", path);
    for (i = 0; i < count; i++)
        for (c = 0; c < 3; c++) picture.data[3 * i + (size_t)c] = (float)pixels[4 * i + (size_t)c] / 255.0f;
    ok = png_write(path, &picture, 0, a->error, sizeof a->error);
    image_free(&picture);
    return ok;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* history: a row of GPU_TIMES for each frame. The first with a plan is left out if there are others: shaders are
 * compiled in it. */
static void print_times(const app *a, double *history, int frames)
{
    const int first = (int)a->since + ((int)a->since + 1 < frames), count = frames - first;
    double   *sorted = malloc((size_t)count * sizeof *sorted), total = 0.0;
    int       t, i;

    if (!sorted) return;
    printf("%s, %s, %dx%d, median of %d frames\n", a->device_name, a->gpu->name, a->width, a->height, count);
    for (t = 0; t < a->time_count; t++) {
        for (i = 0; i < count; i++) sorted[i] = history[(first + i) * GPU_TIMES + t];
        qsort(sorted, (size_t)count, sizeof *sorted, compare_doubles);
        printf("%-12s %9.2f ms\n", a->times[t].name, sorted[count / 2]);
        total += sorted[count / 2];
    }
    printf("%-12s %9.2f ms\n", "all", total);
    free(sorted);
}

/* A slow swing about the pivot: 8 degrees to either side. */
static void swing(app *a) { camera_start(&a->camera, &a->model, 0.14f * sinf(0.035f * (float)a->index)); }

static int run_headless(app *a)
{
    const int      frames = a->args.frames;
    unsigned char *pixels = malloc((size_t)a->width * (size_t)a->height * 4);
    double        *history = calloc((size_t)frames * GPU_TIMES, sizeof *history), told = seconds();
    char           path[4096];
    int            i, t;

    if (!pixels || !history) {
        FAULT(a, "out of memory");
        fail(a, BACKEND);
    }
    a->split = 0.5f * (float)a->width;
    for (i = 0; i < frames && a->code == DONE; i++) {
        if (i > 0) press_next(a);
        swing(a);
        if (a->code == DONE && !draw_frame(a, a->args.png ? pixels : NULL)) fail(a, BACKEND);
        if (a->code != DONE) break;
        for (t = 0; t < a->time_count; t++) history[i * GPU_TIMES + t] = a->times[t].ms;
        snprintf(path, sizeof path, "%s/frame-%03d.png", a->args.png ? a->args.png : "", i);
        if (a->args.png && !write_picture(a, path, pixels)) fail(a, FILES);
        if (seconds() - told >= 2.0) {
            fprintf(stderr, "frame %d of %d\n", i + 1, frames);
            told = seconds();
        }
    }
    if (a->code == DONE) print_times(a, history, frames);
    free(history);
    free(pixels);
    return a->code;
}

/* ---- the window -------------------------------------------------------------------------------------------------- */

static void on_glfw_error(int code, const char *text)
{
    fprintf(stderr, "glfw: %s (0x%x)\n", text, (unsigned)code);
}

static int open_window(app *a)
{
    glfwSetErrorCallback(on_glfw_error);
    if (!glfwInit()) return FAULT(a, "no display: set DISPLAY, or use --headless");
    if (a->args.gl) {
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, a->args.validate);
    } else {
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    }
    a->window = glfwCreateWindow(a->args.width, a->args.height, "hbil-viewer", NULL, NULL);
    if (!a->window)
        return FAULT(a, a->args.gl ? "no window with OpenGL 4.3: leave out --gl, or use --headless"
                                                                 : "no window: use --headless");
    glfwSetWindowUserPointer(a->window, a);
    glfwSetKeyCallback(a->window, on_key);
    glfwSetCursorPosCallback(a->window, on_mouse);
    glfwGetFramebufferSize(a->window, &a->width, &a->height);
    a->split = 0.5f * (float)a->width;
    a->overlay = 1;
    return 1;
}

/* 0: minimised, nothing to draw. */
static int follow_size(app *a)
{
    int width, height;

    glfwGetFramebufferSize(a->window, &width, &height);
    if (width < 1 || height < 1) return 0;
    if (width == a->width && height == a->height) return 1;
    a->width = width;
    a->height = height;
    a->reset = 1;
    return a->gpu->resize(a->device, width, height) || (fail(a, BACKEND), 0);
}

static void show_title(const app *a)
{
    char   title[256];
    double total = 0.0;
    int    i;

    for (i = 0; i < a->time_count; i++) total += a->times[i].ms;
    snprintf(title, sizeof title, "hbil-viewer: %s, %s, %.1f ms", a->light.preset, light_view_at(a->view)->name, total);
    glfwSetWindowTitle(a->window, title);
}

static int run_window(app *a)
{
    unsigned char *pixels = NULL;
    double         before = seconds(), now;

    while (!glfwWindowShouldClose(a->window) && a->code == DONE &&
           (!a->args.frames || (int)a->index < a->args.frames)) {
        const int last = a->args.frames && (int)a->index + 1 == a->args.frames;
        glfwPollEvents();
        if (a->index > 0) press_next(a);
        now = seconds();
        if (a->args.frames) swing(a);
        else move_camera(a, now - before);
        before = now;
        if (!follow_size(a)) {
            if (a->code == DONE) glfwWaitEvents();
            continue;
        }
        if (last && a->args.screenshot) pixels = malloc((size_t)a->width * (size_t)a->height * 4);
        if (!draw_frame(a, pixels)) fail(a, BACKEND);
        else if (pixels && !write_picture(a, a->args.screenshot, pixels)) fail(a, FILES);
        show_title(a);
    }
    free(pixels);
    return a->code;
}

/* ---- start and end ----------------------------------------------------------------------------------------------- */

/* What needs no device, so that mistakes show at once. */
static int load(app *a)
{
    struct stat folder;
    int         i;

    if (!light_preset(&a->light, a->args.preset, a->error, sizeof a->error)) return fail(a, USAGE);
    for (i = 0; i < a->args.set_count; i++)
        if (!light_set(&a->light, a->args.sets[i], a->error, sizeof a->error)) return fail(a, REFUSED);
    if (!light_build(&a->light, a->args.gl, NULL, a->error, sizeof a->error)) return fail(a, REFUSED);
    if (a->args.model ? !model_file(&a->model, a->args.model, a->error, sizeof a->error)
                      : !model_scene(&a->model, model_scene_name(a->scene), a->error, sizeof a->error))
        return fail(a, FILES);
    if (a->args.exposure > 0.0f) a->model.exposure = a->args.exposure;
    if (a->args.png && mkdir(a->args.png, 0777) != 0 && (stat(a->args.png, &folder) != 0 || !S_ISDIR(folder.st_mode))) {
        FAULT(a, "%s: cannot make this folder: %s", a->args.png, strerror(errno));
        return fail(a, FILES);
    }
    camera_start(&a->camera, &a->model, 0.0f);
    return DONE;
}

static int run(app *a)
{
    gpu_setup setup = {NULL, 0, NULL, 0};
    int       code = load(a);

    if (code != DONE) return code;
    a->width = a->args.width;
    a->height = a->args.height;
    if (!a->args.headless && !open_window(a)) return fail(a, BACKEND);
    setup.window = a->window;
    setup.validate = a->args.validate;
    setup.error = a->error;
    setup.error_size = sizeof a->error;
    a->gpu = a->args.gl ? &gpu_gl : &gpu_vulkan;
    a->device = a->gpu->open(&setup, a->device_name);
    if (!a->device || !a->gpu->model(a->device, a->model.vertices, a->model.count) ||
        !a->gpu->plan(a->device, &a->light.plan) || !a->gpu->resize(a->device, a->width, a->height))
        return fail(a, BACKEND);
    a->reset = 1;
    code = a->window ? run_window(a) : run_headless(a);
    if (code == DONE && a->gpu->messages(a->device) > 0) {
        FAULT(a, "%d messages of validation, see above", a->gpu->messages(a->device));
        code = fail(a, BACKEND);
    }
    return code;
}

int main(int argc, char **argv)
{
    static app a;
    int        code;

    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        print_help();
        return DONE;
    }
    a.args.preset = "balanced";
    a.args.sets = malloc((size_t)argc * sizeof *a.args.sets);
    if (!a.args.sets || !parse_arguments(&a, argc, argv)) code = fail(&a, USAGE);
    else code = run(&a);
    if (a.device) a.gpu->close(a.device);
    if (a.window) glfwDestroyWindow(a.window);
    if (!a.args.headless) glfwTerminate();
    model_free(&a.model);
    free(a.args.sets);
    return code;
}
