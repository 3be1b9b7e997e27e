/* subject.h - what is lit: captures in folders, built-in scenes, sequences. */
#ifndef HBIL_TRADEOFF_SUBJECT_H
#define HBIL_TRADEOFF_SUBJECT_H

#include "common.h"

#define SUBJECTS_MAX 64

/* Name and place; nothing is read. */
typedef struct subject_name {
    char name[64];      /* of the folder, or "scene:NAME" */
    char folder[1024];  /* "": a scene */
    int  first, count;  /* numbers of its frames */
} subject_name;

typedef struct subject_list { subject_name items[SUBJECTS_MAX]; int count; } subject_list;

/* Its frames in order; the last one is judged, those before it are its history. */
typedef struct subject {
    char     name[64];
    capture *frames;
    int      count;
} subject;

/* All of --frames and --scene, sorted. An exit code; s->error says why there are none. */
int            subject_find(settings *s, subject_list *out);
/* Reads or traces it. An exit code; s->error says why. */
int            subject_load(settings *s, const subject_name *name, subject *out);
void           subject_free(subject *sub);
const capture *subject_judged(const subject *sub);

#endif
