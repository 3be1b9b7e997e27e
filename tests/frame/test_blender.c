/* test_blender.c - Blender's multilayer EXR as a capture: names, conventions, what is said where passes are missing.
 * No Blender needed. */
#include <math.h>
#include <unistd.h>

#include <openexr.h>

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../../examples/frame/capture.h"

#define COUNT(a) (sizeof(a) / sizeof *(a))
#define W 5
#define H 3
#define PASSES_MAX 16

/* rows (0.6 0.8 0) (0 0 1) (0.8 -0.6 0): world to view */
#define CAMERA(w) "{\"width\":" w ",\"height\":3,\"near\":0.1,\"far\":100," \
    "\"projection_rows\":[[1.5,0,0,0],[0,2,0,0],[0,0,-1.002002,-0.2002002],[0,0,-1,0]]," \
    "\"view_rows\":[[0.6,0.8,0,1],[0,0,1,-2],[0.8,-0.6,0,-3],[0,0,0,1]]}"

typedef struct pass { const char *name, *channels; float value[3]; } pass;

/* What Blender 3.4 writes; the normal is not of unit length, as where a pixel is the mean of several surfaces. */
static const pass blender_3[] = {
    {"Combined", "RGB", {9, 9, 9}},         {"Depth", "Z", {7}},          {"Normal", "XYZ", {1, 0.5f, 0}},
    {"DiffCol", "RGB", {0.5f, 0.25f, 0}},   {"DiffDir", "RGB", {3, 2, 1}}, {"Emit", "RGB", {4, 5, 6}},
    {"Vector", "XYZ", {1.5f, 0.75f, 0}},    {"DiffInd", "RGB", {1, 2, 3}}, {"AO", "RGB", {0.25f, 1, 1}},
};
static const pass blender_5[] = {
    {"Combined", "RGB", {9, 9, 9}},             {"Depth", "V", {7}},
    {"Normal", "XYZ", {1, 0.5f, 0}},            {"Diffuse Color", "RGB", {0.5f, 0.25f, 0}},
    {"Diffuse Direct", "RGB", {3, 2, 1}},       {"Emission", "RGB", {4, 5, 6}},
    {"Vector", "XYZ", {1.5f, 0.75f, 0}},        {"Diffuse Indirect", "RGB", {1, 2, 3}},
    {"Ambient Occlusion", "RGB", {0.25f, 1, 1}},
};

static char folder[] = "test_blender_XXXXXX"; /* in the working folder, removed at the end */
static char exr[64], json[64], error[1024];

static void write_json(const char *text)
{
    assert_true(text_write(json, text, error, sizeof error));
}

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder)) return -1;
    snprintf(exr, sizeof exr, "%s/frame.exr", folder);
    snprintf(json, sizeof json, "%s/camera.json", folder);
    write_json(CAMERA("5"));
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    remove(exr);
    remove(json);
    return rmdir(folder);
}

static void assert_error_has(const char *part)
{
    if (!strstr(error, part)) fail_msg("error \"%s\" does not say \"%s\"", error, part);
}

/* Passes of up to three view layers, added one layer after the other. */
static struct { image_layer layers[3 * PASSES_MAX]; char names[3 * PASSES_MAX][128]; int count; } file;

/* The passes whose bit in `without` is 0. Pixel 0 is sky, pixel 1 reflects nothing. */
static void add_layer(const char *layer, const pass *passes, size_t count, unsigned without)
{
    size_t k;
    int    p, c;

    for (k = 0; k < count; k++) {
        image_layer *out = &file.layers[file.count];
        const int    channels = (int)strlen(passes[k].channels);

        if (without & 1u << k) continue;
        snprintf(file.names[file.count], sizeof file.names[0], "%s%s", layer, passes[k].name);
        memset(out, 0, sizeof *out);
        out->layer = file.names[file.count++];
        out->channels = passes[k].channels;
        assert_true(image_make(&out->pixels, W, H, channels));
        for (p = 0; p < W * H; p++) {
            const int dark = p == 1 && passes[k].name[0] == 'D' && channels == 3;
            for (c = 0; c < channels; c++) out->pixels.data[p * channels + c] = p == 0 || dark ? 0 : passes[k].value[c];
        }
        if (strcmp(passes[k].name, "Depth") == 0) out->pixels.data[0] = 1e10f;
    }
}

static void write_layers(void)
{
    int i;

    if (!exr_write(exr, file.layers, file.count, error, sizeof error)) fail_msg("%s", error);
    for (i = 0; i < file.count; i++) image_free(&file.layers[i].pixels);
    file.count = 0;
}

static void load(capture *cap)
{
    if (!capture_load(cap, exr, json, error, sizeof error)) fail_msg("%s", error);
}

static void assert_values(const image *img, int pixel, float a, float b, float c)
{
    const float want[3] = {a, b, c};
    int         i;

    assert_non_null(img->data);
    for (i = 0; i < img->channels; i++)
        if (!(fabsf(img->data[pixel * img->channels + i] - want[i]) < 1e-6f))
            fail_msg("channel %d is %g, not %g", i, (double)img->data[pixel * img->channels + i], (double)want[i]);
}

/* ---- what is read ------------------------------------------------------------------------------------------------ */

static void passes_are_read_under_any_name_of_the_view_layer(void **state)
{
    static const char *const layers[] = {"ViewLayer.", "View.Layer 1.", "RenderLayer.", "Depth.", ".", "truth.", ""};
    const float              length = sqrtf(1.25f);
    capture                  cap;
    size_t                   i;

    (void)state;
    for (i = 0; i < 2 * COUNT(layers); i++) {
        add_layer(layers[i / 2], i & 1 ? blender_5 : blender_3, COUNT(blender_3), 0);
        write_layers();
        load(&cap);
        assert_int_equal(cap.width, W);
        assert_int_equal(cap.height, H);
        assert_values(&cap.depth, 0, 1e10f, 0, 0);
        assert_values(&cap.depth, 7, 7, 0, 0);
        assert_values(&cap.normal, 0, 0, 0, 0);                            /* sky: no NaN */
        assert_values(&cap.normal, 7, 1.0f / length, 0, 0.5f / length);    /* world (1, .5, 0) turned, of unit length */
        assert_values(&cap.albedo, 7, 0.5f, 0.25f, 0);
        assert_values(&cap.direct, 7, 1.5f, 0.5f, 0);                      /* reflectance times E/pi */
        assert_values(&cap.direct, 1, 0, 0, 0);
        assert_values(&cap.emission, 7, 4, 5, 6);
        assert_values(&cap.motion, 7, 1.5f, -0.75f, 0);                    /* y down */
        assert_true(cap.view[0] == 0.6f && cap.view[4] == 0.8f && cap.view[14] == -3.0f);
        capture_free(&cap);
    }
}

static void light_of_all_bounces_is_no_truth_but_that_of_the_layer_truth_is(void **state)
{
    capture cap;

    (void)state;
    add_layer("ViewLayer.", blender_3, COUNT(blender_3), 0);
    write_layers();
    load(&cap);
    assert_null(cap.truth_near.data);
    assert_null(cap.truth_ao.data);
    capture_free(&cap);
    add_layer("truth.", blender_3, COUNT(blender_3), 0);
    write_layers();
    load(&cap);
    assert_values(&cap.truth_near, 7, 1, 2, 3);
    assert_values(&cap.truth_ao, 7, 0.25f, 0, 0);
    assert_values(&cap.truth_ao, 1, 0, 0, 0); /* reflects nothing: no truth */
    capture_free(&cap);
}

static void emission_and_motion_may_be_absent(void **state)
{
    capture cap;

    (void)state;
    add_layer("ViewLayer.", blender_3, COUNT(blender_3), 1u << 5 | 1u << 6);
    write_layers();
    load(&cap);
    assert_null(cap.emission.data);
    assert_null(cap.motion.data);
    capture_free(&cap);
}

static void the_fullest_view_layer_is_taken_and_of_several_the_first(void **state)
{
    static const pass other[] = {{"Depth", "Z", {11}}, {"Normal", "XYZ", {1, 0, 0}}, {"DiffCol", "RGB", {1, 1, 1}},
                                 {"DiffDir", "RGB", {1, 1, 1}}, {"Combined", "RGB", {1, 1, 1}}};
    capture           cap;

    (void)state;
    add_layer("A.", other, COUNT(other), 1u << 3);
    add_layer("B.", blender_3, COUNT(blender_3), 0);
    add_layer("C.", other, COUNT(other), 0);
    write_layers();
    load(&cap);
    assert_values(&cap.depth, 7, 7, 0, 0);
    capture_free(&cap);
}

static void our_own_layers_go_first(void **state)
{
    static const pass own[] = {{"depth", "Z", {11}}, {"normal", "XYZ", {0, 0, 1}}, {"albedo", "RGB", {1, 1, 1}},
                               {"direct", "RGB", {2, 2, 2}}};
    capture           cap;

    (void)state;
    add_layer("", own, COUNT(own), 0);
    add_layer("ViewLayer.", blender_3, COUNT(blender_3), 0);
    write_layers();
    load(&cap);
    assert_values(&cap.depth, 7, 11, 0, 0);
    assert_values(&cap.normal, 7, 0, 0, 1);
    assert_values(&cap.direct, 7, 2, 2, 2);
    capture_free(&cap);
}

/* ---- what is refused --------------------------------------------------------------------------------------------- */

static void assert_refused(const char *says)
{
    capture cap;

    assert_false(capture_load(&cap, exr, json, error, sizeof error));
    assert_error_has("frame.exr: ");
    assert_error_has(says);
    assert_null(cap.depth.data);
    assert_false(cap.misfit);
}

static void missing_passes_are_named_with_their_switches(void **state)
{
    static const char *const says[] = {
        "lacks Depth (Data > Z). Switch", "lacks Normal (Data > Normal). Switch",
        "lacks DiffCol (Light > Diffuse > Color). Switch", "lacks DiffDir (Light > Diffuse > Direct). Switch",
    };
    size_t k;

    (void)state;
    for (k = 0; k < COUNT(says); k++) {
        add_layer("View.Layer 1.", blender_3, COUNT(blender_3), 2u << k);
        write_layers();
        assert_refused(says[k]);
        assert_error_has("view layer \"View.Layer 1\" of Blender");
        assert_error_has("View Layer Properties > Passes");
    }
    add_layer("ViewLayer.", blender_3, 1, 0); /* the picture alone */
    write_layers();
    assert_refused("\"ViewLayer\" of Blender lacks Depth (Data > Z), Normal (Data > Normal), DiffCol (");
    error[3] = '!';
    assert_false(capture_load(&(capture){0}, exr, json, error, 3)); /* a small buffer is not overrun */
    assert_int_equal(error[3], '!');
}

static void a_pass_in_part_is_refused(void **state)
{
    static const pass half[] = {{"Normal", "XZ", {0, 1}}};

    (void)state;
    add_layer("ViewLayer.", blender_3, COUNT(blender_3), 1u << 2);
    add_layer("ViewLayer.", half, 1, 0);
    write_layers();
    assert_refused("no channel ViewLayer.Normal.Y");
}

static void files_of_other_programs_are_told_what_they_were_told_before(void **state)
{
    static const pass others[] = {{"Normal", "XYZ", {0, 0, 1}}, {"normal", "XYZ", {0, 0, 1}}, {"Z", "Z", {1}}};

    (void)state;
    add_layer("", others, COUNT(others), 0);
    write_layers();
    assert_refused("no channel depth.Z. Write that pass into the file. Channels in it: Normal.X");
}

static void a_camera_of_another_size_is_a_misfit(void **state)
{
    capture cap;

    (void)state;
    add_layer("ViewLayer.", blender_3, COUNT(blender_3), 0);
    write_layers();
    write_json(CAMERA("6"));
    assert_false(capture_load(&cap, exr, json, error, sizeof error));
    write_json(CAMERA("5"));
    assert_error_has("camera is for 6x3, the frame");
    assert_int_equal(cap.misfit, 1);
    assert_null(cap.motion.data);
}

/* Blender 5 writes a part for each pass, unless told otherwise. */
static void a_file_of_many_parts_is_refused_with_the_switch_for_one(void **state)
{
    static const char *const  parts[] = {"ViewLayer.Combined", "ViewLayer.Depth"}, *const channels[] = {"R", "Z"};
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t             context;
    exr_attr_box2i_t          box;
    exr_attr_v2f_t            centre;
    char                      name[64];
    float                     value = 1;
    int                       k, part;

    (void)state;
    memset(&box, 0, sizeof box); /* one pixel */
    memset(&centre, 0, sizeof centre);
    assert_int_equal(exr_start_write(&context, exr, EXR_WRITE_FILE_DIRECTLY, &settings), 0);
    for (k = 0; k < 2; k++) {
        assert_int_equal(exr_add_part(context, parts[k], EXR_STORAGE_SCANLINE, &part), 0);
        assert_int_equal(exr_initialize_required_attr(context, part, &box, &box, 1, &centre, 1,
                                                      EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_NONE), 0);
        snprintf(name, sizeof name, "%s.%s", parts[k], channels[k]);
        assert_int_equal(exr_add_channel(context, part, name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1), 0);
    }
    assert_int_equal(exr_write_header(context), 0);
    for (k = 0; k < 2; k++) assert_int_equal(exr_write_scanline_chunk(context, k, 0, &value, sizeof value), 0);
    assert_int_equal(exr_finish(&context), 0);
    assert_refused("in the first of its parts. Switch Interleave on");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(passes_are_read_under_any_name_of_the_view_layer),
        cmocka_unit_test(light_of_all_bounces_is_no_truth_but_that_of_the_layer_truth_is),
        cmocka_unit_test(emission_and_motion_may_be_absent),
        cmocka_unit_test(the_fullest_view_layer_is_taken_and_of_several_the_first),
        cmocka_unit_test(our_own_layers_go_first),
        cmocka_unit_test(missing_passes_are_named_with_their_switches),
        cmocka_unit_test(a_pass_in_part_is_refused),
        cmocka_unit_test(files_of_other_programs_are_told_what_they_were_told_before),
        cmocka_unit_test(a_camera_of_another_size_is_a_misfit),
        cmocka_unit_test(a_file_of_many_parts_is_refused_with_the_switch_for_one),
    };

    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
