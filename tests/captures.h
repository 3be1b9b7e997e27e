/* captures.h - the frames in the folder HBIL_CAPTURES: every subfolder with frame-NNN.exr and camera-NNN.json. */
#ifndef HBIL_TEST_CAPTURES_H
#define HBIL_TEST_CAPTURES_H

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../examples/frame/capture.h"

#define CAPTURES_MAX 32

typedef struct capture_names { int count; char name[CAPTURES_MAX][64]; } capture_names;

static inline int captures_has(const char *name, int frame)
{
    const char *root = getenv("HBIL_CAPTURES");
    char path[1024];
    FILE *f;
    snprintf(path, sizeof path, "%s/%s/frame-%03d.exr", root ? root : "", name, frame);
    f = fopen(path, "rb");
    if (f) fclose(f);
    return f != NULL;
}

static inline int captures_order(const void *a, const void *b) { return strcmp((const char *)a, (const char *)b); }

/* The subfolders, sorted; none where HBIL_CAPTURES is not set. */
static inline capture_names captures_list(void)
{
    capture_names list;
    const char *root = getenv("HBIL_CAPTURES");
    DIR *folder = root && *root ? opendir(root) : NULL;
    const struct dirent *entry;
    memset(&list, 0, sizeof list);
    while (folder && list.count < CAPTURES_MAX && (entry = readdir(folder)) != NULL)
        if (strlen(entry->d_name) < sizeof list.name[0] && captures_has(entry->d_name, 0)) strcpy(list.name[list.count++], entry->d_name);
    if (folder) closedir(folder);
    qsort(list.name, (size_t)list.count, sizeof list.name[0], captures_order);
    return list;
}

static inline int captures_load(const char *name, int frame, capture *out, char *error, size_t error_size)
{
    const char *root = getenv("HBIL_CAPTURES");
    char exr[1024], json[1024];
    snprintf(exr, sizeof exr, "%s/%s/frame-%03d.exr", root ? root : "", name, frame);
    snprintf(json, sizeof json, "%s/%s/camera-%03d.json", root ? root : "", name, frame);
    return capture_load(out, exr, json, error, error_size);
}

#endif
