/* rhi.h - a stand-in for the RHI of an engine. Executes nothing: prints each call and checks it against those before,
 * over frames. For one file of one program. */
#ifndef OWN_ENGINE_RHI_H
#define OWN_ENGINE_RHI_H

#include "../../hbil.h"
#include <stdio.h>
#include <string.h>

enum { SAMPLE = HBIL_ACCESS_SAMPLE, WRITE = HBIL_ACCESS_WRITE };
enum { READ_AFTER_WRITE = 1, WRITE_AFTER_WRITE = 2, WRITE_AFTER_READ = 4 };

typedef struct rhi_image {
    char name[20];
    int  life, mips, written;   /* written: in which frame, last; the first frame is 1 */
    int  now;                   /* accesses by what is being bound */
    int  unsafe;                /* READ_AFTER_WRITE ... that no barrier has made safe */
} rhi_image;

static struct rhi {
    rhi_image images[2 * HBIL_MAX_TEXTURES + 1];    /* 0: none */
    struct { char name[20]; int bindings; } pipelines[HBIL_MAX_PASSES + 1]; /* 0: none. what the text declares */
    int       image_count, pipeline_count, binding_count; /* bindings since the last dispatch */
    uint64_t  slots[3];                             /* taken since then, by access; [0]: uniforms */
    int       frame, reset, checks, faults;
} rhi;

static void rhi_check(int right, const char *name, const char *fault)
{
    ++rhi.checks;
    if (right) return;
    ++rhi.faults;
    printf("  FAULT    %s: %s\n", name, fault);
}

/* A texture that the engine has anyway: G-buffer, light buffers. */
static int engine_texture(const hbil_texture *like)
{
    rhi_image *i = &rhi.images[++rhi.image_count];
    memcpy(i->name, like->name, sizeof i->name);
    i->life = like->life;
    i->mips = like->mips;
    return rhi.image_count;
}

static int rhi_texture(const hbil_texture *like, const uint32_t size[2])
{
    printf("texture    %s %s %ux%u, %u layers\n", like->name, hbil_format_name((hbil_format)like->format),
           (unsigned)size[0], (unsigned)size[1], (unsigned)like->layers);
    rhi_check(size[0] && size[1] && like->layers, like->name, "made without a size");
    rhi_check(like->format > HBIL_FORMAT_ANY && like->format < HBIL_FORMAT_COUNT, like->name, "made without a format");
    return engine_texture(like);
}

static int rhi_pipeline(const char *glsl, const char *name)
{
    int p = ++rhi.pipeline_count;
    snprintf(rhi.pipelines[p].name, sizeof rhi.pipelines[p].name, "%s", name);
    printf("pipeline   %s, %u bytes\n", name, (unsigned)strlen(glsl));
    for (; (glsl = strstr(glsl, "binding = ")) != NULL; ++glsl) ++rhi.pipelines[p].bindings;
    return p;
}

/* The inputs are drawn, the outputs used: all that is the engine's is synchronised by the engine. */
static void rhi_begin_frame(int reset)
{
    int i;
    printf("frame %d%s\n", ++rhi.frame, reset ? ", reset" : "");
    rhi.reset = reset;
    for (i = 1; i <= rhi.image_count; ++i)
        if (rhi.images[i].life <= HBIL_LIFE_OUTPUT) rhi.images[i].unsafe = 0;
}

static const char *rhi_access(int access) { return access == WRITE ? "write" : "read"; }

static void rhi_barrier(int texture, int before, int after)
{
    rhi_image *i = &rhi.images[texture];
    printf("  barrier  %s, %s -> %s\n", i->name, rhi_access(before), rhi_access(after));
    rhi_check(texture > 0, "barrier", "no such texture");
    i->unsafe &= ~(before == SAMPLE ? WRITE_AFTER_READ : after == SAMPLE ? READ_AFTER_WRITE : WRITE_AFTER_WRITE);
}

static void rhi_slot(int slot, int kind, const char *name)
{
    rhi_check(!(rhi.slots[kind] >> slot & 1), name, "slot taken twice");
    rhi.slots[kind] |= (uint64_t)1 << slot;
    ++rhi.binding_count;
}

static void rhi_bind(int slot, int texture, int access, int mip)
{
    rhi_image *i = &rhi.images[texture];
    int oldest = rhi.frame - (i->life == HBIL_LIFE_HISTORY); /* frame whose data may be read */
    printf("  bind     %d %s, texture %d, %s\n", slot, i->name, texture, rhi_access(access));
    rhi_check(texture > 0, "bind", "no such texture");
    rhi_check(mip < i->mips, i->name, "no such level");
    if (access == SAMPLE && i->life != HBIL_LIFE_INPUT && !(i->life == HBIL_LIFE_HISTORY && rhi.reset))
        rhi_check(i->written >= oldest, i->name, "read before it was written");
    rhi_check(!(i->unsafe & (access == SAMPLE ? READ_AFTER_WRITE : WRITE_AFTER_WRITE | WRITE_AFTER_READ)), i->name,
              "no barrier since it was used");
    i->now |= access;
    rhi_check(i->now == access, i->name, "read and written by one dispatch");
    rhi_slot(slot, access, i->name);
}

static void rhi_uniforms(int slot, const void *block, size_t bytes)
{
    printf("  uniforms %d, %u bytes\n", slot, (unsigned)bytes);
    rhi_check(block && bytes, "uniforms", "no data");
    rhi_slot(slot, 0, "uniforms");
}

static void rhi_dispatch(int pipeline, const uint32_t groups[3])
{
    const char *name = rhi.pipelines[pipeline].name;
    rhi_image  *i;
    printf("  dispatch %s, %ux%ux%u groups\n", name, (unsigned)groups[0], (unsigned)groups[1], (unsigned)groups[2]);
    rhi_check(pipeline > 0, "dispatch", "no such pipeline");
    rhi_check(groups[0] && groups[1] && groups[2], name, "no groups");
    rhi_check(rhi.binding_count == rhi.pipelines[pipeline].bindings, name, "not all that its text declares is bound");
    for (i = rhi.images + 1; i <= rhi.images + rhi.image_count; ++i) {
        if (i->now == WRITE) {
            i->written = rhi.frame;
            i->unsafe = READ_AFTER_WRITE | WRITE_AFTER_WRITE;
        } else if (i->now) i->unsafe = (i->unsafe & ~WRITE_AFTER_WRITE) | WRITE_AFTER_READ;
        i->now = 0;
    }
    memset(rhi.slots, 0, sizeof rhi.slots);
    rhi.binding_count = 0;
}

#endif
