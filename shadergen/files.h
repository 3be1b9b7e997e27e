/* files.h - outputs made in memory first, then written all or none; inputs read whole. */
#ifndef SHADERGEN_FILES_H
#define SHADERGEN_FILES_H

#include <stddef.h>

/* A file to be. data: malloc'd, files_free frees it. path "-": standard output. */
typedef struct file { char path[1024]; char *data; size_t size; } file;

/* A list that grows. Zero it first. */
typedef struct files { file *items; int count, room; } files;

/* A new entry at the end, zeroed; NULL: out of memory. Earlier pointers into the list are void after it. */
file *files_add(files *list);
void  files_free(files *list);

/* The whole file with a zero behind it; size is without that. "-": standard input. NULL: errno says why. */
char *read_all(const char *path, size_t *size);
/* path: -, a folder with a / at its end, which takes name and suffix, or a file. 0: too long, said on stderr. */
int   file_place(file *f, const char *path, const char *name, const char *suffix);
/* Make the folders of a path, as mkdir -p; the path ends with /. 0: errno says why, said on stderr. */
int   folder_make(const char *path);
/* Write what differs from what is there: all temporary files first, then all renames. A full disk, or a folder in the way,
 * leaves every old file as it was. stale: NULL; or it gets the number of
 * files that differ, each said on stderr, and nothing is written. 0: said on stderr. */
int   files_write(files *list, int *stale);

#endif
