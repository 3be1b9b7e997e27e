/* test_faults_gl.c - GL that fails: calls that are out of memory, shaders that the driver rejects, functions, versions and limits that are
 * missing, framebuffers that are incomplete, contexts that are lost, sizes that change within a sequence, threads; on hbil_gl.h and the
 * runner, OpenGL and ES, compute and fragment shaders. Each gives an error that names cause and fix, leaks nothing, and a new start gives
 * the same bytes.
 *
 * HBIL_LONG=1: every place; else a slice of them, seeded by HBIL_SEED (default 1). HBIL_ONLY=NAME: tests of that name alone, with * and ?.
 * Exit code 77 (skipped) without OpenGL. */
#define HBIL_IMPLEMENTATION
#include "../test.h"

#include "../../examples/frame/runner_gl.c"
#include "gl_shim.h"
#include "faults.h"

#include <pthread.h>

/* A runner's context with textures for a plan; `mine` is a backend of the test's own on them. */
typedef struct rig {
    gl_device *d;
    hbil_plan  plan;
    hbil_frame frame;
    image      inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    unsigned   names[HBIL_MAX_TEXTURES];
    hbil_gl_info info;
    hbil_gl    mine;
} rig;

static void *egl_proc(const char *name);
static PFNEGLGETPROCADDRESSPROC real_egl_proc;

static void *egl_proc(const char *name) { return gls_address(real_egl_proc(name)); }
static __eglMustCastToProperFunctionPointerType EGLAPIENTRY shim_egl_proc(const char *name)
{
    void *address = gls_proc(name);
    __eglMustCastToProperFunctionPointerType function;
    memcpy(&function, &address, sizeof function);
    return function;
}

static void *own_proc(void *user, const char *name) { return runner_gl_proc(user, name); }

/* Puts the shim between a device and its GL. */
static void put_shim(gl_device *d)
{
    if (d->osmesa_context) {
        gls.proc = d->osmesa.GetProcAddress;
        d->osmesa.GetProcAddress = gls_proc;
    } else {
        real_egl_proc = d->egl.GetProcAddress;
        gls.proc = egl_proc;
        d->egl.GetProcAddress = shim_egl_proc;
    }
    assert_true(load_functions(d, error, sizeof error));
}

/* 0: no such context here. */
static int set_up(rig *g, const char *target, const char *config)
{
    runner_info about;
    uint32_t t;
    memset(g, 0, sizeof *g);
    gls_clear();
    g->d = (gl_device *)open_device(strcmp(target, "gles") == 0, 0, &about, error, sizeof error);
    if (!g->d) return 0;
    put_shim(g->d);
    g->plan = plan_of(config, target);
    g->frame = test_frame(&g->plan.config, WIDTH, HEIGHT);
    make_inputs(&g->plan, WIDTH, HEIGHT, g->inputs);
    assert_true(set_plan(g->d, &g->plan));
    if (!set_images(g->d, &g->plan, WIDTH, HEIGHT, g->inputs, g->outputs, error, sizeof error)) fail_msg("%s", error);
    for (t = 0; t < g->plan.texture_count; ++t) g->names[t] = g->d->images[t].name;
    g->info.plan = &g->plan;
    g->info.get_proc = own_proc;
    g->info.user = g->d;
    g->info.scratch = g->d->scratch;
    g->info.scratch_size = sizeof g->d->scratch;
    return 1;
}

static void tear_down(rig *g)
{
    hbil_gl_shutdown(&g->mine);
    assert_int_equal(g->d->gl.GetError(), GL_NO_ERROR);
    gls_clear();
    gl_close(g->d);
    free_images(g->inputs);
    free_images(g->outputs);
    assert_int_equal(gls.live_count, 0);
    assert_int_equal(gls.alien, 0);
}

/* The verbs one after the other; ended: which of them failed. */
static hbil_gl_result live(rig *g, float ao[TEXELS], int *ended)
{
    hbil_gl_result result = hbil_gl_init(&g->info, &g->mine);
    *ended = 0;
    if (result != HBIL_GL_OK) return result;
    *ended = 1;
    result = hbil_gl_resize(&g->mine, WIDTH, HEIGHT, g->names);
    if (result != HBIL_GL_OK) return result;
    *ended = 2;
    g->frame.reset = 1;
    result = hbil_gl_run(&g->mine, &g->frame);
    g->frame.reset = 0;
    if (result == HBIL_GL_OK) result = hbil_gl_run(&g->mine, &g->frame);
    if (result != HBIL_GL_OK) return result;
    *ended = 3;
    assert_true(read_outputs(g->d, &g->plan, g->outputs));
    memcpy(ao, g->outputs[hbil_plan_texture(&g->plan, "ao")].data, WIDTH * HEIGHT * sizeof *ao);
    return result;
}

static hbil_gl_result result_of(int call, int ended)
{
    if (call == GLS_GetShaderiv || call == GLS_GetProgramiv) return HBIL_GL_E_COMPILE;
    if (call == GLS_CheckFramebufferStatus) return HBIL_GL_E_TEXTURE;
    (void)ended;
    return HBIL_GL_E_MEMORY;
}

static int has_fix(const char *message)
{
    static const char *const fixes[] = { "free", "make", "update", "Update", "ask for", "needs EXT_", "has to", "have to", "memory" };
    size_t i;
    for (i = 0; i < sizeof fixes / sizeof *fixes; ++i)
        if (strstr(message, fixes[i])) return 1;
    return 0;
}

static void fault_backend(rig *g, const float *want, int call, int at)
{
    const int before = gls.live_count;
    float ao[TEXELS] = { 0 };
    int ended;
    hbil_gl_result got;
    gls_clear();
    gls.call = call;
    gls.at = at;
    got = live(g, ao, &ended);
    if (gls.failed != 1) fail_msg("call %d of %s was not reached", at, gls_names[call]);
    if (got != result_of(call, ended))
        fail_msg("call %d of %s: result %d, \"%s\"", at, gls_names[call], (int)got, g->mine.message);
    if (strlen(g->mine.message) < 24 || !has_fix(g->mine.message)) fail_msg("%s: no cause and fix: \"%s\"", gls_names[call], g->mine.message);
    if (ended == 0) assert_int_equal(gls.live_count, before); /* init: nothing stays behind */
    gls_clear();
    if (ended > 0) { /* mended in place */
        if (ended == 1) assert_int_equal(hbil_gl_run(&g->mine, &g->frame), HBIL_GL_E_ARG);
        assert_int_equal(hbil_gl_resize(&g->mine, WIDTH, HEIGHT, g->names), HBIL_GL_OK);
        assert_int_equal(hbil_gl_run(&g->mine, &g->frame), HBIL_GL_OK);
    }
    hbil_gl_shutdown(&g->mine);
    hbil_gl_shutdown(&g->mine);
    assert_int_equal(gls.live_count, before);
    assert_int_equal(gls.alien, 0);
    assert_int_equal(live(g, ao, &ended), HBIL_GL_OK);
    assert_memory_equal(ao, want, sizeof ao);
    hbil_gl_shutdown(&g->mine);
    assert_int_equal(g->d->gl.GetError(), GL_NO_ERROR); /* none is left over */
    ++injected;
}

/* The context goes at the n-th call: the verb of then may not notice, the next one does. */
static void lose_context(rig *g, const float *want, int at)
{
    const int before = gls.live_count;
    float ao[TEXELS] = { 0 };
    int ended;
    hbil_gl_result got;
    gls_clear();
    gls.lose_at = at;
    gls.victim = &g->mine;
    got = hbil_gl_init(&g->info, &g->mine);
    if (got == HBIL_GL_OK && gls.lost) assert_int_equal(hbil_gl_resize(&g->mine, WIDTH, HEIGHT, g->names), HBIL_GL_E_CONTEXT);
    else if (got == HBIL_GL_OK) got = hbil_gl_resize(&g->mine, WIDTH, HEIGHT, g->names);
    if (got == HBIL_GL_OK && !gls.lost) got = hbil_gl_run(&g->mine, &g->frame);
    if (got == HBIL_GL_OK && !gls.lost) got = hbil_gl_run(&g->mine, &g->frame);
    if (!gls.lost) fail_msg("call %d was not reached", at);
    if (got == HBIL_GL_OK && g->mine.runnable) {
        assert_int_equal(hbil_gl_run(&g->mine, &g->frame), HBIL_GL_E_CONTEXT);
        assert_non_null(strstr(g->mine.message, "make a new one, and init again"));
        assert_int_equal(hbil_gl_resize(&g->mine, WIDTH, HEIGHT, g->names), HBIL_GL_E_CONTEXT);
    }
    if (strlen(g->mine.message) < 24) fail_msg("call %d: \"%s\"", at, g->mine.message);
    hbil_gl_shutdown(&g->mine);
    gls_clear();
    gls_sweep(before);
    if (in_slice(6)) {
        assert_int_equal(live(g, ao, &ended), HBIL_GL_OK);
        assert_memory_equal(ao, want, sizeof ao);
        hbil_gl_shutdown(&g->mine);
    }
    ++injected;
}

static const struct { const char *target, *config; } kinds[] = {
    { "gl", SMALL "temporal=yes" }, { "gl", SMALL "temporal=yes stage=fragment" },
    { "gles", SMALL "temporal=yes" }, { "gles", SMALL "temporal=yes stage=fragment" } };
enum { KIND_COUNT = sizeof kinds / sizeof *kinds };

static void the_backend_reports_every_call_that_fails(void **state)
{
    int k;
    (void)state;
    for (k = 0; k < KIND_COUNT; ++k) {
        float want[TEXELS] = { 0 };
        int calls[GLS_CALLS], call, at, all, ended, functions = 0, before = injected;
        rig g;
        if (!set_up(&g, kinds[k].target, kinds[k].config)) {
            print_message("%s: skipped: %s\n", kinds[k].target, error);
            continue;
        }
        gls_clear();
        assert_int_equal(live(&g, want, &ended), HBIL_GL_OK);
        hbil_gl_shutdown(&g.mine);
        memcpy(calls, gls.calls, sizeof calls);
        for (call = 0; call < GLS_CALLS; ++call) {
            if (gls_how[call] == NEVER || call == GLS_ReadPixels || call == GLS_TexSubImage2D) continue;
            functions += calls[call] > 0;
            for (at = 1; at <= calls[call]; ++at)
                if (call != GLS_GenFramebuffers || at < calls[call]) /* the last one is of read_outputs */
                    if (in_slice(5) || at == 1) fault_backend(&g, want, call, at);
        }
        gls_clear();
        assert_int_equal(live(&g, want, &ended), HBIL_GL_OK);
        all = gls.all - gls.calls[GLS_ReadPixels] - 1; /* without what reads the outputs */
        hbil_gl_shutdown(&g.mine);
        for (at = 1; at <= all; ++at)
            if (in_slice(16)) lose_context(&g, want, at);
        tear_down(&g);
        print_message("%s, %s: %d functions, %d faults\n", kinds[k].target, kinds[k].config + sizeof SMALL - 1, functions, injected - before);
    }
}

static void expect_init(rig *g, hbil_gl_result wanted, const char *part)
{
    const int before = gls.live_count;
    const hbil_gl_result got = hbil_gl_init(&g->info, &g->mine);
    if (got != wanted || !strstr(g->mine.message, part))
        fail_msg("result %d, \"%s\", wanted %d, \"%s\"", (int)got, g->mine.message, (int)wanted, part);
    assert_int_equal(hbil_gl_resize(&g->mine, WIDTH, HEIGHT, g->names), HBIL_GL_E_ARG);
    hbil_gl_shutdown(&g->mine);
    assert_int_equal(gls.live_count, before);
    gls_clear();
    ++injected;
}

static void init_names_the_function_that_is_missing(void **state)
{
#define ROW(when, type, member, name, args) { #when, name },
    static const struct { const char *when, *name; } table[] = { HBIL_GL__FUNCTIONS(ROW) };
    int k;
    (void)state;
    for (k = 0; k < KIND_COUNT; ++k) {
        const int draws = strstr(kinds[k].config, "fragment") != NULL, es = strcmp(kinds[k].target, "gles") == 0;
        float ao[TEXELS];
        int ended, refused = 0;
        size_t i;
        rig g;
        if (!set_up(&g, kinds[k].target, kinds[k].config)) continue;
        for (i = 0; i < sizeof table / sizeof *table; ++i) {
            const char *when = table[i].when;
            const int needed = strcmp(when, "ALWAYS") == 0 || (strcmp(when, "COMPUTE") == 0 && !draws) ||
                               (strcmp(when, "DRAW") == 0 && draws) || (strcmp(when, "DESKTOP") == 0 && draws && !es);
            gls.hidden = table[i].name;
            if (needed) expect_init(&g, HBIL_GL_E_FUNCTION, table[i].name);
            else if (strcmp(when, "OPTIONAL") == 0) { /* and it does without */
                assert_int_equal(live(&g, ao, &ended), HBIL_GL_OK);
                hbil_gl_shutdown(&g.mine);
            }
            refused += needed;
        }
        assert_true(refused > 40);
        gls_clear();
        tear_down(&g);
    }
}

static void init_names_what_the_context_lacks(void **state)
{
    static const struct { int kind; const char *version, *part; } versions[] = {
        { 0, "4.2.0 Old", "need 4.3: ask for a 4.3 core context" }, { 0, "3.3 (Core Profile)", "or build the plan with stage=fragment" },
        { 0, "1.4 (2.1.2 NVIDIA)", "need 4.3" }, { 0, "OpenGL ES 3.2 Mesa", "not desktop OpenGL: ask for OpenGL 4.3 core" },
        { 0, "OpenGL ES-CM 1.1", "not desktop OpenGL" }, { 0, "4", "not desktop OpenGL" }, { 0, "", "not desktop OpenGL" },
        { 0, "WebGL 2.0", "not desktop OpenGL" }, { 1, "3.2.0", "these shaders need 3.3" }, { 1, "3", "not desktop OpenGL" },
        { 2, "OpenGL ES 3.0 Mesa", "compute shaders need 3.1" }, { 2, "OpenGL ES 3", "not OpenGL ES" }, { 2, "4.6.0 NVIDIA", "target=gl" },
        { 3, "OpenGL ES 2.0 Mesa", "these shaders need 3.0" } };
    static const struct { int kind; GLenum limit; const char *part; } limits[] = {
        { 0, GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, "texture unit" }, { 0, GL_MAX_IMAGE_UNITS, "image unit" },
        { 0, GL_MAX_UNIFORM_BUFFER_BINDINGS, "uniform block is at binding" }, { 1, GL_MAX_DRAW_BUFFERS, "targets at once, 0 can be used" },
        { 2, GL_MAX_IMAGE_UNITS, "image unit" }, { 3, GL_MAX_DRAW_BUFFERS, "targets at once, 0 can be used" } };
    int k;
    size_t i;
    (void)state;
    for (k = 0; k < KIND_COUNT; ++k) {
        float ao[TEXELS];
        int ended;
        rig g;
        if (!set_up(&g, kinds[k].target, kinds[k].config)) continue;
        for (i = 0; i < sizeof versions / sizeof *versions; ++i) {
            if (versions[i].kind != k) continue;
            gls.version = versions[i].version;
            expect_init(&g, HBIL_GL_E_CONTEXT, versions[i].part);
        }
        for (i = 0; i < sizeof limits / sizeof *limits; ++i) {
            if (limits[i].kind != k) continue;
            gls.limit = limits[i].limit;
            expect_init(&g, HBIL_GL_E_PLAN, limits[i].part);
        }
        gls.version = k < 2 ? "10.0 of the future" : "OpenGL ES 10.1";
        assert_int_equal(live(&g, ao, &ended), HBIL_GL_OK); /* newer than anything */
        hbil_gl_shutdown(&g.mine);
        tear_down(&g);
    }
}

/* No context is current: functions of GL then have no effect, on Mesa as on any driver that is looked up by a loader. */
static void no_current_context_is_noticed(void **state)
{
    float ao[TEXELS];
    int ended;
    rig g;
    (void)state;
    assert_true(set_up(&g, "gl", kinds[0].config));
    assert_int_equal(live(&g, ao, &ended), HBIL_GL_OK);
    if (g.d->osmesa_context) {
        assert_true(g.d->osmesa.MakeCurrent(NULL, NULL, 0, 0, 0));
        assert_int_equal(hbil_gl_run(&g.mine, &g.frame), HBIL_GL_E_CONTEXT);
        assert_int_equal(hbil_gl_resize(&g.mine, WIDTH, HEIGHT, g.names), HBIL_GL_E_CONTEXT);
        assert_true(make_current(g.d));
        assert_int_equal(hbil_gl_resize(&g.mine, WIDTH, HEIGHT, g.names), HBIL_GL_OK);
        assert_int_equal(hbil_gl_run(&g.mine, &g.frame), HBIL_GL_OK);
        injected += 2;
    }
    tear_down(&g);
}

/* ---------------------------------------------------------------------------------------------------------------- the runner */

/* Frames by the functions of a runner, on a device that the shim watches. */
static int run_device(gl_device *d, const hbil_plan *plan, float ao[TEXELS])
{
    static const uint32_t size[2] = { WIDTH, HEIGHT };
    image inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    int f, ok = 1;
    make_inputs(plan, WIDTH, HEIGHT, inputs);
    memset(ao, 0, TEXELS * sizeof *ao);
    for (f = 0; f < FRAMES && ok; ++f) {
        hbil_frame frame = test_frame(&plan->config, WIDTH, HEIGHT);
        frame.index = (uint32_t)f;
        frame.reset = f == 0;
        memset(outputs, 0, sizeof outputs);
        ok = gl_run(d, plan, &frame, size, inputs, outputs, 1, NULL, error, sizeof error);
        if (ok) memcpy(ao, outputs[hbil_plan_texture(plan, "ao")].data, WIDTH * HEIGHT * sizeof *ao);
        free_images(outputs);
    }
    free_images(inputs);
    return ok;
}

static void a_runner_survives_every_call_that_fails(void **state)
{
    const hbil_plan plan = plan_of(SMALL "temporal=yes multisample=yes", "gl");
    float want[TEXELS], ao[TEXELS];
    int calls[GLS_CALLS], call, at, before = injected;
    runner_info about;
    gl_device *d;
    (void)state;
    gls_clear();
    d = (gl_device *)open_device(0, 0, &about, error, sizeof error);
    assert_non_null(d);
    put_shim(d);
    if (!run_device(d, &plan, want)) fail_msg("%s", error);
    memcpy(calls, gls.calls, sizeof calls);
    for (call = 0; call < GLS_CALLS; ++call) {
        if (gls_how[call] == NEVER) continue;
        for (at = 1; at <= calls[call]; ++at) {
            if (!in_slice(3) && at > 1) continue;
            recover(d); /* all is made anew, as in the count */
            gls_clear();
            gls.call = call;
            gls.at = at;
            error[0] = 0;
            if (run_device(d, &plan, ao)) fail_msg("call %d of %s: no error", at, gls_names[call]);
            if (gls.failed != 1) fail_msg("call %d of %s was not reached", at, gls_names[call]);
            if (strlen(error) < 24) fail_msg("%s: \"%s\"", gls_names[call], error);
            gls_clear();
            if (!run_device(d, &plan, ao)) fail_msg("%s, then: %s", gls_names[call], error);
            assert_memory_equal(ao, want, sizeof ao);
            ++injected;
        }
    }
    gl_close(d);
    assert_int_equal(gls.live_count, 0);
    assert_int_equal(gls.alien, 0);
    print_message("runner: %d faults\n", injected - before);
}

static GLboolean never_current(void *context, void *buffer, GLenum type, GLsizei width, GLsizei height)
{
    (void)context, (void)buffer, (void)type, (void)width, (void)height;
    return GL_FALSE;
}

static void a_runner_that_cannot_be_current_says_so(void **state)
{
    const hbil_plan plan = plan_of(SMALL, "gl");
    GLboolean (*real)(void *, void *, GLenum, GLsizei, GLsizei);
    float ao[TEXELS];
    runner_info about;
    gl_device *d;
    (void)state;
    gls_clear();
    d = (gl_device *)open_device(0, 0, &about, error, sizeof error);
    assert_non_null(d);
    real = d->osmesa.MakeCurrent;
    if (d->osmesa_context) {
        d->osmesa.MakeCurrent = never_current;
        assert_false(run_device(d, &plan, ao));
        assert_non_null(strstr(error, "cannot be made current: use a runner on one thread at a time"));
        d->osmesa.MakeCurrent = real;
        ++injected;
    }
    if (!run_device(d, &plan, ao)) fail_msg("%s", error);
    gl_close(d);
}

static void opening_names_what_is_missing(void **state)
{
    const char *before = getenv("HBIL_GL");
    (void)state;
    assert_int_equal(setenv("HBIL_GL", "mesa", 1), 0);
    assert_null(runner_open("gl", 0, error, sizeof error));
    assert_non_null(strstr(error, "HBIL_GL=mesa: osmesa or egl, or leave it unset"));
    if (before) setenv("HBIL_GL", before, 1);
    else unsetenv("HBIL_GL");
    ++injected;
}

static void sizes_may_change_within_a_sequence(void **state)
{
    runner *es = runner_open("gles", 0, error, sizeof error);
    (void)state;
    gls_clear();
    change_sizes("gl");
    if (es) change_sizes("gles");
    runner_close(es);
}

/* ---------------------------------------------------------------------------------------------------------------- threads */

typedef struct job {
    const char *target, *config;
    float       want[TEXELS];
    int         rounds, wrong;
    char        error[512];
} job;

static pthread_mutex_t opening = PTHREAD_MUTEX_INITIALIZER;

/* The ao of a few frames, each with a new start of the backend. */
static int some_rounds(runner *r, const job *j, float ao[TEXELS], char *text, size_t size)
{
    const hbil_plan plan = plan_of(j->config, j->target), other = plan_of(SMALL, j->target);
    image inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    int f, ok = 1;
    make_inputs(&plan, WIDTH, HEIGHT, inputs);
    for (f = 0; f <= FRAMES && ok; ++f) {
        const hbil_plan *now = f == FRAMES ? &other : &plan; /* the last one, so that the next round makes all anew */
        hbil_frame frame = test_frame(&now->config, WIDTH, HEIGHT);
        frame.index = (uint32_t)f;
        ok = runner_run(r, now, &frame, inputs, outputs, 1, NULL, text, size);
        if (ok && f < FRAMES) memcpy(ao, outputs[hbil_plan_texture(now, "ao")].data, WIDTH * HEIGHT * sizeof *ao);
        free_images(outputs);
    }
    free_images(inputs);
    return ok;
}

static void *work(void *user)
{
    job *j = (job *)user;
    float ao[TEXELS];
    runner *r;
    int i;
    memset(ao, 0, sizeof ao);
    pthread_mutex_lock(&opening);
    r = runner_open(j->target, 0, j->error, sizeof j->error);
    pthread_mutex_unlock(&opening);
    for (i = 0; i < j->rounds; ++i)
        if (!r || !some_rounds(r, j, ao, j->error, sizeof j->error) || memcmp(ao, j->want, sizeof ao) != 0) ++j->wrong;
    pthread_mutex_lock(&opening);
    runner_close(r);
    pthread_mutex_unlock(&opening);
    return NULL;
}

static void two_threads_have_a_context_each(void **state)
{
    static job jobs[2] = { { "gl", SMALL "temporal=yes filter=3x3", { 0 }, 0, 0, "" },
                           { "gl", SMALL "temporal=yes estimator=bitmask", { 0 }, 0, 0, "" } };
    pthread_t threads[2];
    int i;
    (void)state;
    gls_clear();
    for (i = 0; i < 2; ++i) {
        runner *r = runner_open(jobs[i].target, 0, error, sizeof error);
        if (!r || !some_rounds(r, &jobs[i], jobs[i].want, error, sizeof error)) fail_msg("%s", error); /* alone */
        runner_close(r);
        jobs[i].rounds = getenv("HBIL_LONG") ? 24 : 4;
    }
    for (i = 0; i < 2; ++i) assert_int_equal(pthread_create(&threads[i], NULL, work, &jobs[i]), 0);
    for (i = 0; i < 2; ++i) pthread_join(threads[i], NULL);
    for (i = 0; i < 2; ++i)
        if (jobs[i].wrong) fail_msg("thread %d: %d rounds differ %s", i, jobs[i].wrong, jobs[i].error);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opening_names_what_is_missing),
        cmocka_unit_test(the_backend_reports_every_call_that_fails),
        cmocka_unit_test(init_names_the_function_that_is_missing),
        cmocka_unit_test(init_names_what_the_context_lacks),
        cmocka_unit_test(no_current_context_is_noticed),
        cmocka_unit_test(a_runner_survives_every_call_that_fails),
        cmocka_unit_test(a_runner_that_cannot_be_current_says_so),
        cmocka_unit_test(sizes_may_change_within_a_sequence),
        cmocka_unit_test(two_threads_have_a_context_each),
    };
    runner *r = runner_open("gl", 0, error, sizeof error);
    int failed;
    if (!r) {
        printf("skipped: %s\n", error);
        return 77;
    }
    printf("%s, %s\n", runner_about(r)->device, runner_about(r)->driver);
    runner_close(r);
    if (getenv("HBIL_SEED")) seed = (uint32_t)strtoul(getenv("HBIL_SEED"), NULL, 10);
    printf("seed %u\n", seed);
    if (getenv("HBIL_ONLY")) cmocka_set_test_filter(getenv("HBIL_ONLY"));
    failed = cmocka_run_group_tests_name("faults_gl", tests, NULL, NULL);
    printf("faults of GL: %d injected, %d tests failed\n", injected, failed);
    return failed;
}
