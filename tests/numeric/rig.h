/* rig.h - run any config on a capture under an environment and get all outputs, for the tests. A failure fails the calling test. */
#ifndef HBIL_TESTS_RIG_H
#define HBIL_TESTS_RIG_H

#include "../../examples/frame/capture.h"
#include "../../examples/frame/environment.h"
#include "../../examples/frame/runner.h"
#include "brute_force.h"

typedef struct rig_light {
    hbil_plan  plan;
    hbil_frame frame;
    image      out[HBIL_MAX_TEXTURES]; /* by plan texture */
} rig_light;

/* Group setup and teardown of cmocka: the backend is HBIL_BACKEND, "vulkan" if that is not set. */
int  rig_open(void **state);
int  rig_close(void **state);

/* Environments: "sky", "color:1,1,1" and so on, as --env has them. */
environment rig_environment(const char *text);
/* The function that environment=hook calls: the captures' sky, its unit that of E/pi or, if `radiance`, of radiance. */
const char *rig_hook(int radiance);

/* The built-in scenes, then the first frame of every capture, by index: its name, NULL when there are no more. F0 and roughness are made
 * up from the albedo where a frame has none. */
const char *rig_load(capture *cap, int index);
/* Every surface sends out radiance 1 and nothing else. */
void        rig_whiten(capture *cap);

/* Run. env may be NULL where the config has no environment. */
void rig_run(const char *config, const capture *cap, const environment *env, rig_light *out);
/* An output; NULL where the plan has none of that name. */
const image *rig_image(const rig_light *light, const char *name);
void rig_free(rig_light *light);

/* The capture as brute_force.h sees it; the images are borrowed. */
bf_scene rig_scene(const capture *cap);
/* Column-major projection of a camera of brute_force.h. The z row is that of linear depth: unused. */
void     rig_project(const bf_camera *camera, float out[16]);

#endif
