/* blender.h - the render passes of Blender's multilayer EXR, as a capture wants them. */
#ifndef HBIL_FRAME_BLENDER_H
#define HBIL_FRAME_BLENDER_H

#include "capture.h"

enum { BLENDER_FAULT = 0, BLENDER_READ = 1, BLENDER_NOT = 2 };

/* Reads the images of `out`; its view matrix must be there already, as Blender's normals are in world space.
 * BLENDER_NOT: no such file, unreadable, or with a layer depth.Z of our own; nothing is touched.
 * BLENDER_FAULT: error[] names the passes that are missing, and where Blender switches them on. */
int blender_read(capture *out, const char *exr, char *error, size_t error_size);

#endif
