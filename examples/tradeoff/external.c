/* external.c - --external on the command line, and what a hand-made plan needs beside its modules. */
#include "external.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../shadergen/cost.h"
#include "csv.h"
#include "module.h"

void externals_help(void)
{
    fputs(
        "  --external E      a compute shader of yours, as a peer: runs like a config, named external:NAME. Vulkan\n"
        "                    only, up to 8. E: spv=FILE,KEY=BINDING,...  BINDING: a number, or set.number; KEY:\n"
        "                    depth normal radiance albedo (read), ao near (written), uniforms (=push: push\n"
        "                    constants), any other name: an image from pass to pass. A further spv= begins the next\n"
        "                    pass. Also name=NAME, depth_format=linear|device|reversed, entry=POINT behind its spv=.\n"
        "                    More in examples/tradeoff/README.md\n",
        stdout);
}

int externals_add(externals *x, settings *s, const char *text)
{
    if (!*text)
        return frame_error(s->error, sizeof s->error, "--external: without its value, as in spv=FILE,depth=0,ao=1");
    if (x->count == EXTERNALS_MAX)
        return frame_error(s->error, sizeof s->error, "--external: more than %d", EXTERNALS_MAX);
    x->list[x->count++].text = text;
    return 1;
}

void externals_free(externals *x)
{
    int      i;
    uint32_t p;

    for (i = 0; i < x->count; i++)
        for (p = 0; p < x->list[i].plan.pass_count; p++) free(x->list[i].words[p]);
}

const external *externals_find(const externals *x, const char *name)
{
    int i;

    for (i = 0; i < x->count; i++)
        if (strcmp(x->list[i].name, name) == 0) return &x->list[i];
    return NULL;
}

/* ---- the description --------------------------------------------------------------------------------------------- */

#define FAIL(s, ...) (frame_error((s)->error, sizeof (s)->error, __VA_ARGS__), TRADE_USAGE)

/* What a name may have: it stands in a cell, in pictures, and on command lines. */
static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";

static int check_name(const external *e, settings *s)
{
    const char  *name = e->name + strlen(CSV_EXTERNAL);
    const size_t length = strlen(name);

    if (length > 0 && length <= 40 && !name[strspn(name, letters)]) return TRADE_DONE;
    return FAIL(s, "--external: the name '%s' must have 1 to 40 letters, digits, and _ . -. Give one with name=", name);
}

static int set_name(external *e, const char *name, size_t length)
{
    snprintf(e->name, sizeof e->name, CSV_EXTERNAL "%.*s", (int)length, name);
    return TRADE_DONE;
}

/* That of its first file, if none was given. */
static void name_by_file(external *e, const char *path)
{
    const char *slash = strrchr(path, '/'), *stem = slash ? slash + 1 : path;

    if (!e->name[0]) set_name(e, stem, strcspn(stem, "."));
}

static int set_depth(external *e, settings *s, const char *format)
{
    hbil_config *c = &e->plan.config;

    c->depth = strcmp(format, "linear") == 0 ? HBIL_DEPTH_LINEAR : HBIL_DEPTH_DEVICE;
    c->depth_direction = strcmp(format, "reversed") == 0 ? HBIL_DEPTH_DIRECTION_REVERSED : HBIL_DEPTH_DIRECTION_FORWARD;
    if (strcmp(format, "linear") == 0 || strcmp(format, "device") == 0 || strcmp(format, "reversed") == 0)
        return TRADE_DONE;
    return FAIL(s, "--external: depth_format=%s: must be linear, device or reversed", format);
}

static int add_key(module_text *pass, settings *s, const char *name, char *value)
{
    module_key *k = &pass->keys[pass->count];
    char       *dot = strchr(value, '.');

    if (!pass->path) return FAIL(s, "--external: %s=%s before any spv=FILE that it could belong to", name, value);
    if (pass->count == (int)(sizeof pass->keys / sizeof *pass->keys))
        return FAIL(s, "--external, %s: more than %d bindings", pass->path, pass->count);
    if (strlen(name) >= sizeof k->name)
        return FAIL(s, "--external: the name %s is longer than %d letters", name, (int)sizeof k->name - 1);
    pass->count++;
    strcpy(k->name, name);
    k->set = k->binding = 0;
    if (strcmp(name, "uniforms") == 0 && strcmp(value, "push") == 0) return k->set = -1, TRADE_DONE;
    if (dot) *dot = 0;
    if ((!dot || read_int(value, 0, 31, &k->set)) && read_int(dot ? dot + 1 : value, 0, 1 << 20, &k->binding))
        return TRADE_DONE;
    return FAIL(s, "--external: %s=%s%s%s: must be a binding, as in %s=3 or, in another set than 0, %s=1.3%s", name,
                value, dot ? "." : "", dot ? dot + 1 : "", name, name,
                strcmp(name, "uniforms") == 0 ? "; or uniforms=push" : "");
}

static int take(external *e, module_text *pass, settings *s, const char *name, char *value)
{
    int code = TRADE_DONE;

    if (strcmp(name, "name") == 0) return set_name(e, value, strlen(value));
    if (strcmp(name, "depth_format") == 0) return set_depth(e, s, value);
    if (strcmp(name, "entry") == 0 && pass->path) return pass->entry = value, TRADE_DONE;
    if (strcmp(name, "spv") != 0) return add_key(pass, s, name, value);
    if (pass->path) code = module_append(e, pass, s); /* it is complete */
    memset(pass, 0, sizeof *pass);
    pass->path = value;
    name_by_file(e, value);
    return code;
}

/* text is cut up. */
static int read_text(external *e, settings *s, char *text)
{
    module_text pass;
    char       *value, *next;
    int         code = TRADE_DONE;

    memset(&pass, 0, sizeof pass);
    for (; code == TRADE_DONE && text; text = next) {
        next = strchr(text, ',');
        if (next) *next++ = 0;
        value = strchr(text, '=');
        if (!value) return FAIL(s, "--external: %s: must be KEY=VALUE, as in spv=FILE,depth=0,ao=1", text);
        *value++ = 0;
        code = take(e, &pass, s, text, value);
    }
    if (code == TRADE_DONE && !pass.path) return FAIL(s, "--external: no shader: add spv=FILE");
    return code == TRADE_DONE ? module_append(e, &pass, s) : code;
}

/* ---- the plan ---------------------------------------------------------------------------------------------------- */

/* Is it read by any pass? */
static int is_read(const hbil_plan *plan, uint32_t texture)
{
    uint32_t p, b, passes = 0;

    for (p = 0; p < plan->pass_count; p++)
        for (b = 0; b < plan->passes[p].binding_count; b++) passes += plan->passes[p].bindings[b].texture == texture;
    return passes > 1; /* one writes it */
}

/* The rest of the plan: a config that asks for the outputs which are there, and the hash. */
static int finish(external *e, settings *s)
{
    hbil_config *c = &e->plan.config;
    uint64_t     hash;
    uint32_t     i;

    if (check_name(e, s) != TRADE_DONE) return TRADE_USAGE;
    for (i = 0; i < e->plan.texture_count; i++) {
        const hbil_texture *t = &e->plan.textures[i];

        if (t->life == HBIL_LIFE_TRANSIENT && !is_read(&e->plan, i))
            return FAIL(s, "--external: %s is written, but no other pass reads it. Outputs are ao and near", t->name);
        if (t->life == HBIL_LIFE_OUTPUT)
            c->outputs |= strcmp(t->name, "ao") == 0 ? HBIL_OUTPUTS_AO : HBIL_OUTPUTS_NEAR;
    }
    if (!c->outputs) return FAIL(s, "--external: %s writes no output. Name it, as in ao=3 or near=4", e->name);
    c->target = HBIL_TARGET_VULKAN;
    if (hbil_config_resolve(c, c, NULL) != HBIL_OK) return FAIL(s, "--external: %s cannot be planned", e->name);
    hash = hash_bytes(hash_bytes(HASH_BEGIN, e->name, strlen(e->name)), &e->plan, sizeof e->plan);
    for (i = 0; i < e->plan.pass_count; i++) {
        hash = hash_bytes(hash, e->words[i], e->spirv.counts[i] * sizeof *e->words[i]);
        hash = hash_bytes(hash, e->entries[i], strlen(e->entries[i]));
    }
    e->plan.hash = hash;
    return TRADE_DONE;
}

static int open_one(externals *x, settings *s, int index)
{
    external     *e = &x->list[index];
    const size_t  size = strlen(e->text) + 1;
    char         *text = malloc(size);
    int           i, code;

    if (!text) {
        frame_error(s->error, sizeof s->error, "out of memory");
        return TRADE_BACKEND;
    }
    memcpy(text, e->text, size);
    code = read_text(e, s, text);
    free(text);
    if (code == TRADE_DONE) code = finish(e, s);
    for (i = 0; code == TRADE_DONE && i < index; i++)
        if (strcmp(x->list[i].name, e->name) == 0)
            code = FAIL(s, "--external: two are named %s. Tell them apart with name=",
                        e->name + strlen(CSV_EXTERNAL));
    return code;
}

int externals_open(externals *x, settings *s)
{
    int i, code = TRADE_DONE;

    if (x->count > 0 && runner_target(s->backend) != HBIL_TARGET_VULKAN)
        return FAIL(s, "--external: SPIR-V runs with --backend vulkan alone");
    for (i = 0; code == TRADE_DONE && i < x->count; i++) code = open_one(x, s, i);
    return code;
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

/* Of matrices as captures have them: clip x, y of view x, y and z; clip z and w of view z. */
static void invert(const float p[16], float out[16])
{
    const double det = (double)p[10] * (double)p[15] - (double)p[14] * (double)p[11];
    int          i, c;

    memset(out, 0, 16 * sizeof *out);
    out[0] = 1.0f / p[0];
    out[5] = 1.0f / p[5];
    for (c = 0; c < 2; c++) { /* columns of clip z and w */
        float       *to = out + 8 + 4 * c;
        const double z = (c ? -(double)p[14] : (double)p[15]) / det, w = (c ? (double)p[10] : -(double)p[11]) / det;

        for (i = 0; i < 2; i++) to[i] = (float)(-((double)p[8 + i] * z + (double)p[12 + i] * w) / (double)p[5 * i]);
        to[2] = (float)z;
        to[3] = (float)w;
    }
}

void external_fill(const hbil_frame *frame, external_block *out)
{
    memset(out, 0, sizeof *out);
    out->size[0] = (int32_t)frame->width;
    out->size[1] = (int32_t)frame->height;
    out->texel[0] = 1.0f / (float)frame->width;
    out->texel[1] = 1.0f / (float)frame->height;
    memcpy(out->projection, frame->projection, sizeof out->projection);
    memcpy(out->view, frame->view, sizeof out->view);
    invert(frame->projection, out->inverse_projection);
    out->frame = frame->index;
}

int external_cost(const external *e, struct cost_total *out)
{
    cost     one;
    uint32_t p;

    memset(out, 0, sizeof *out);
    for (p = 0; p < e->plan.pass_count; p++) {
        if (e->crowded || !cost_of_words(&e->plan, (int32_t)p, e->words[p], e->spirv.counts[p], &one)) return 0;
        cost_add(&e->plan, (int32_t)p, &one, out);
    }
    return out->unknown == 0;
}
