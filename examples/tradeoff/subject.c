/* subject.c - finds frames, reads them, traces scenes. */
#include "subject.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define NUMBERS 1000 /* frame-000 to frame-999 */

static int frame_path(char out[2048], const char *folder, const char *kind, int number)
{
    return snprintf(out, 2048, "%s/%s-%03d.%s", folder, kind, number, strcmp(kind, "camera") == 0 ? "json" : "exr")
           < 2048;
}

static int has_frame(const char *folder, int number)
{
    char path[2048];

    return frame_path(path, folder, "frame", number) && access(path, R_OK) == 0;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(((const subject_name *)a)->name, ((const subject_name *)b)->name);
}

/* Adds the folder if it holds frames. -1: there is no room for it. */
static int add_folder(subject_list *list, const char *folder, const char *name)
{
    subject_name *item = &list->items[list->count];
    int           number = 0;

    while (number < NUMBERS && !has_frame(folder, number)) number++;
    if (number == NUMBERS) return 0;
    if (list->count == SUBJECTS_MAX || strlen(folder) >= sizeof item->folder || strlen(name) >= sizeof item->name)
        return -1;
    strcpy(item->folder, folder);
    strcpy(item->name, name);
    item->first = number;
    for (item->count = 1; has_frame(folder, number + item->count); item->count++) { }
    list->count++;
    return 1;
}

static const char *last_part(const char *path)
{
    const char *slash = strrchr(path, '/');

    return slash ? slash + 1 : path;
}

static int find_frames(settings *s, subject_list *out)
{
    char                 root[1024], path[1024];
    DIR                 *folder;
    const struct dirent *entry;
    size_t               length;
    int                  added;

    snprintf(root, sizeof root, "%s", s->frames);
    for (length = strlen(root); length > 1 && root[length - 1] == '/'; length--) root[length - 1] = 0;
    added = add_folder(out, root, last_part(root));
    folder = added == 0 ? opendir(root) : NULL;
    while (folder && added >= 0 && (entry = readdir(folder)) != NULL)
        if (entry->d_name[0] != '.' && snprintf(path, sizeof path, "%s/%s", root, entry->d_name) < (int)sizeof path)
            added = add_folder(out, path, entry->d_name);
    if (folder) closedir(folder);
    if (added < 0)
        return frame_error(s->error, sizeof s->error, "--frames %s: more than %d folders, or a name that is too long",
                           s->frames, SUBJECTS_MAX);
    if (out->count == 0)
        return frame_error(s->error, sizeof s->error, "--frames %s: neither it nor a folder in it holds frame-NNN.exr",
                           s->frames);
    return 1;
}

static int find_scenes(settings *s, subject_list *out)
{
    const char *p = s->scenes;
    char        name[48];
    int         i, length;

    for (; *p; p += length + (p[length] == ',')) {
        length = (int)strcspn(p, ",");
        snprintf(name, sizeof name, "%.*s", length, p);
        for (i = 0; capture_scene_name(i) && strcmp(capture_scene_name(i), name) != 0; i++) { }
        if (!capture_scene_name(i))
            return frame_error(s->error, sizeof s->error, "--scene %s: no such scene; hbil-tradeoff --help lists them",
                               name);
        if (out->count == SUBJECTS_MAX)
            return frame_error(s->error, sizeof s->error, "more than %d frames", SUBJECTS_MAX);
        memset(&out->items[out->count], 0, sizeof *out->items);
        snprintf(out->items[out->count].name, sizeof out->items->name, "scene:%s", name);
        out->items[out->count++].count = 1;
    }
    return 1;
}

int subject_find(settings *s, subject_list *out)
{
    memset(out, 0, sizeof *out);
    if (s->frames && !find_frames(s, out)) return TRADE_FILES;
    if (s->scenes && !find_scenes(s, out)) return TRADE_USAGE;
    qsort(out->items, (size_t)out->count, sizeof *out->items, compare_names);
    return TRADE_DONE;
}

static const settings *tracing; /* for the callback of capture_scene, which carries no pointer */

static void show_tracing(double done) { progress_show(tracing, done, "tracing the scene"); }

static int load_frames(settings *s, const subject_name *name, subject *out)
{
    char exr[2048], json[2048];
    int  i;

    for (i = 0; i < name->count; i++) {
        frame_path(exr, name->folder, "frame", name->first + i);
        frame_path(json, name->folder, "camera", name->first + i);
        if (!capture_load(&out->frames[i], exr, json, s->error, sizeof s->error))
            return out->frames[i].misfit ? TRADE_MISFIT : TRADE_FILES;
        out->count++;
        if (i > 0 && !out->frames[i].motion.data && !capture_motion(&out->frames[i], &out->frames[i - 1])) break;
    }
    if (out->count == name->count) return TRADE_DONE;
    frame_error(s->error, sizeof s->error, "%s: out of memory", name->name);
    return TRADE_BACKEND;
}

int subject_load(settings *s, const subject_name *name, subject *out)
{
    int code = TRADE_DONE;

    memset(out, 0, sizeof *out);
    snprintf(out->name, sizeof out->name, "%s", name->name);
    out->frames = calloc((size_t)name->count, sizeof *out->frames);
    if (!out->frames) {
        frame_error(s->error, sizeof s->error, "out of memory");
        return TRADE_BACKEND;
    }
    if (name->folder[0]) code = load_frames(s, name, out);
    else {
        tracing = s;
        if (capture_scene(&out->frames[0], strchr(name->name, ':') + 1, s->width, s->height, s->rays, show_tracing,
                          s->error, sizeof s->error))
            out->count = 1;
        else code = TRADE_BACKEND;
        progress_end(s);
    }
    if (code != TRADE_DONE) subject_free(out);
    return code;
}

void subject_free(subject *sub)
{
    int i;

    for (i = 0; i < sub->count; i++) capture_free(&sub->frames[i]);
    free(sub->frames);
    memset(sub, 0, sizeof *sub);
}

const capture *subject_judged(const subject *sub) { return &sub->frames[sub->count - 1]; }
