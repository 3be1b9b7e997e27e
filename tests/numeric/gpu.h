/* gpu.h - run a config on synthetic or captured images and get its outputs, for the tests. A failure fails the calling test. */
#ifndef HBIL_TESTS_GPU_H
#define HBIL_TESTS_GPU_H

#include "../../hbil.h"
#include "../../examples/frame/capture.h"
#include "brute_force.h"

/* What a renderer would hand over. The images are borrowed. */
typedef struct gpu_input {
    hbil_frame frame;
    image      depth, normal, radiance;
    image      albedo, motion; /* where the config asks for them */
} gpu_input;

/* Present where the config asks for the output. */
typedef struct gpu_output { image ao, near, bent; } gpu_output;

/* Group setup and teardown of cmocka: the backend is HBIL_BACKEND, "vulkan" if that is not set. */
int  gpu_open(void **state);
int  gpu_close(void **state);
/* Which of two runners the calls below use: two views, each with its own history. The first one after gpu_open. */
void gpu_view(int index);
/* Seconds since the start of the program. */
double gpu_clock(void);

/* Column-major projection of a camera of brute_force.h (right-handed, -z forward). The z row is that of linear depth: unused. */
void gpu_projection(const bf_camera *camera, float out[16]);
/* Identity view, zero index. */
hbil_frame gpu_frame(const bf_camera *camera);
/* A capture as a renderer would hand it over, behind a frame of the same camera. Its images are borrowed. */
gpu_input gpu_input_of(const capture *cap);
/* The plan that gpu_run makes of a config. */
void gpu_plan(const hbil_config *config, hbil_plan *plan);
/* Run. Dynamic options take the values that config has, so that configs which differ in them share one compiled variant. */
void gpu_run(const hbil_config *config, const gpu_input *in, gpu_output *out);
void gpu_free(gpu_output *out);
/* GLSL text in the place of a pass's own, see runner_text; NULL: none. */
void gpu_text(const char *pass, const char *text);

#endif
