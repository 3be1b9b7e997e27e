/* test_frame.c - the frame library and hbil-frame: files, conventions, metrics, the built-in scene, exit codes.
 * The group that runs the program needs its path in the environment variable HBIL_FRAME_BIN. */
#include <math.h>
#include <sys/wait.h>
#include <unistd.h>

#include <openexr.h>

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../../examples/frame/capture.h"
#include "../../examples/frame/metric.h"

#define COUNT(a) (sizeof(a) / sizeof *(a))
#define W 21 /* of the test frame: odd, and not a multiple of any block */
#define H 37 /* three ZIP blocks of 16 lines, the last one cut */

static char folder[] = "test_frame_XXXXXX"; /* in the working folder, removed at the end */
static char error[1024];

/* A path in the folder; lives until the fourth call after it. */
static const char *at(const char *name)
{
    static char paths[4][128];
    static int  next;
    char       *path = paths[next = (next + 1) % 4];

    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    char command[64];

    (void)state;
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command) == 0 ? 0 : -1;
}

static void assert_error_has(const char *part)
{
    if (!strstr(error, part)) fail_msg("error \"%s\" does not say \"%s\"", error, part);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static image make_image(int width, int height, int channels)
{
    image  img;
    size_t i;

    assert_true(image_make(&img, width, height, channels));
    for (i = 0; i < (size_t)(width * height * channels); i++) img.data[i] = (float)i * 0.37f - 11.0f;
    return img;
}

static unsigned char *read_bytes(const char *path, size_t *size)
{
    FILE          *file = fopen(path, "rb");
    unsigned char *bytes;

    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    bytes[*size] = 0;
    fclose(file);
    return bytes;
}

static void write_bytes(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");

    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* depth.Z, normal.XYZ and a layer that is absent, as x.exr. */
static void write_sample(image_layer layers[3])
{
    const image none = {0, 0, 0, NULL};

    layers[0].layer = "depth", layers[0].channels = "Z", layers[0].pixels = make_image(W, H, 1), layers[0].required = 1;
    layers[1].layer = "normal", layers[1].channels = "XYZ", layers[1].pixels = make_image(W, H, 3), layers[1].required = 1;
    layers[2].layer = "near", layers[2].channels = "RGB", layers[2].pixels = none, layers[2].required = 0;
    assert_true(exr_write(at("x.exr"), layers, 3, error, sizeof error));
}

static void free_layers(image_layer *layers, int count)
{
    int i;

    for (i = 0; i < count; i++) image_free(&layers[i].pixels);
}

static void exr_round_trip_is_exact(void **state)
{
    image_layer wrote[3], got[3];

    (void)state;
    write_sample(wrote);
    memcpy(got, wrote, sizeof got);
    assert_true(exr_read(at("x.exr"), got, 3, error, sizeof error));
    assert_memory_equal(got[0].pixels.data, wrote[0].pixels.data, W * H * sizeof(float));
    assert_memory_equal(got[1].pixels.data, wrote[1].pixels.data, W * H * 3 * sizeof(float));
    assert_null(got[2].pixels.data);
    free_layers(wrote, 3);
    free_layers(got, 3);
}

static void missing_channel_is_named_with_those_that_exist(void **state)
{
    image_layer layers[3];

    (void)state;
    write_sample(layers);
    free_layers(layers, 3);
    layers[2].required = 1;
    assert_false(exr_read(at("x.exr"), layers, 3, error, sizeof error));
    assert_error_has("x.exr: no channel near.R");
    assert_error_has("depth.Z normal.X normal.Y normal.Z");
    assert_null(layers[0].pixels.data);
    layers[2].required = 0;
    layers[2].layer = "normal", layers[2].channels = "XW"; /* a layer in part is a fault even if it is optional */
    assert_false(exr_read(at("x.exr"), layers, 3, error, sizeof error));
    assert_error_has("no channel normal.W");
}

static void truncated_exr_is_refused_wherever_it_is_cut(void **state)
{
    image_layer    layers[3];
    size_t         size, cut;
    unsigned char *bytes;
    int            i;

    (void)state;
    write_sample(layers);
    free_layers(layers, 3);
    bytes = read_bytes(at("x.exr"), &size);
    for (i = 0; i < 60; i++) {
        cut = i < 10 ? (size_t)i * 37u : size * (size_t)(i - 10) / 50u; /* the header closer than the pixels */
        write_bytes(at("cut.exr"), bytes, cut);
        error[0] = 0;
        if (exr_read(at("cut.exr"), layers, 3, error, sizeof error)) fail_msg("read a file cut at %d of %d", (int)cut, (int)size);
        assert_error_has("cut.exr: ");
        assert_null(layers[0].pixels.data);
    }
    free(bytes);
}

/* Every byte of the header damaged in turn: no crash, no leak; some damage (a comment, a flag) is harmless. */
static void damaged_exr_never_crashes(void **state)
{
    image_layer    layers[3];
    size_t         size, i;
    unsigned char *bytes;

    (void)state;
    write_sample(layers);
    free_layers(layers, 3);
    bytes = read_bytes(at("x.exr"), &size);
    for (i = 4; i < size && i < 700; i++) {
        bytes[i] ^= 0xff;
        write_bytes(at("bad.exr"), bytes, size);
        exr_read(at("bad.exr"), layers, 3, error, sizeof error);
        free_layers(layers, 3);
        bytes[i] ^= 0xff;
    }
    free(bytes);
}

/* Replace 4 bytes that lie `offset` behind `text` in the header of x.exr. */
static void patch_header(const char *text, size_t offset, int32_t value)
{
    size_t         size, i;
    unsigned char *bytes = read_bytes(at("x.exr"), &size);

    for (i = 0; i + offset + 4 < size && strcmp((const char *)bytes + i, text) != 0; i++) { }
    assert_true(i + offset + 4 < size);
    memcpy(bytes + i + offset, &value, 4); /* little-endian, as the format and every machine that runs this */
    write_bytes(at("patched.exr"), bytes, size);
    free(bytes);
}

static void odd_headers_are_explained(void **state)
{
    image_layer layers[3];

    (void)state;
    write_sample(layers);
    free_layers(layers, 3);
    patch_header("depth.Z", sizeof "depth.Z" + 8, 3); /* behind type and linearity: x sampling */
    assert_false(exr_read(at("patched.exr"), layers, 3, error, sizeof error));
    assert_error_has("patched.exr: ");
    patch_header("box2i", sizeof "box2i" + 4 + 8, 20000); /* behind the attribute's size and the minimum: x maximum */
    assert_false(exr_read(at("patched.exr"), layers, 3, error, sizeof error));
    assert_error_has("20001x37");
    write_bytes(at("text.exr"), "no picture", 10);
    assert_false(exr_read(at("text.exr"), layers, 3, error, sizeof error));
    assert_error_has("is not an OpenEXR file");
    assert_false(exr_read(at("none.exr"), layers, 3, error, sizeof error));
    assert_error_has("cannot be opened");
    error[3] = '!';
    assert_false(exr_read(at("none.exr"), layers, 3, error, 3)); /* a small buffer is not overrun */
    assert_int_equal(error[3], '!');
}

/* Write depth.Z with values 0, 1, 2.. in any storage, type and compression, its window beginning at (-5, 7). */
static void write_foreign(exr_storage_t storage, exr_compression_t compression, exr_pixel_type_t type, int width, int height)
{
    exr_attr_box2i_t           box;
    exr_attr_v2f_t             centre;
    exr_context_initializer_t  settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t              context;
    image                      img = make_image(width, height, 1);
    int part, x, y, step_x = width, step_y = 8;

    memset(&centre, 0, sizeof centre);
    box.min.x = -5, box.min.y = 7, box.max.x = width - 6, box.max.y = height + 6;
    for (x = 0; x < width * height; x++) img.data[x] = (float)x;
    assert_int_equal(exr_start_write(&context, at("foreign.exr"), EXR_WRITE_FILE_DIRECTLY, &settings), 0);
    assert_int_equal(exr_add_part(context, "p", storage, &part), 0);
    assert_int_equal(exr_initialize_required_attr(context, part, &box, &box, 1.0f, &centre, 1.0f, EXR_LINEORDER_INCREASING_Y,
                                                  compression), 0);
    if (storage == EXR_STORAGE_TILED)
        assert_int_equal(exr_set_tile_descriptor(context, part, 16, 8, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN), 0);
    assert_int_equal(exr_add_channel(context, part, "depth.Z", type, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1), 0);
    assert_int_equal(exr_write_header(context), 0);
    if (storage == EXR_STORAGE_TILED) step_x = 16;
    else exr_get_scanlines_per_chunk(context, part, &step_y);
    for (y = 0; y < height; y += step_y) {
        for (x = 0; x < width; x += step_x) {
            exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
            exr_chunk_info_t      chunk;
            if (storage == EXR_STORAGE_TILED) exr_write_tile_chunk_info(context, part, x / 16, y / 8, 0, 0, &chunk);
            else exr_write_scanline_chunk_info(context, part, box.min.y + y, &chunk);
            assert_int_equal(exr_encoding_initialize(context, part, &chunk, &encode), 0);
            encode.channels[0].user_bytes_per_element = 4;
            encode.channels[0].user_data_type = EXR_PIXEL_FLOAT;
            encode.channels[0].user_pixel_stride = 4;
            encode.channels[0].user_line_stride = 4 * width;
            encode.channels[0].encode_from_ptr = (const uint8_t *)(img.data + y * width + x);
            assert_int_equal(exr_encoding_choose_default_routines(context, part, &encode), 0);
            assert_int_equal(exr_encoding_run(context, part, &encode), 0);
            exr_encoding_destroy(context, &encode);
        }
    }
    assert_int_equal(exr_finish(&context), 0);
    image_free(&img);
}

static void every_storage_type_and_compression_is_read(void **state)
{
    static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIPS,
                                                     EXR_COMPRESSION_ZIP,
                                                     EXR_COMPRESSION_PIZ};
    static const exr_pixel_type_t  types[] = {EXR_PIXEL_UINT, EXR_PIXEL_HALF, EXR_PIXEL_FLOAT};
    image_layer layer;
    size_t      s, c, t;
    int         i;

    (void)state;
    memset(&layer, 0, sizeof layer);
    layer.layer = "depth", layer.channels = "Z", layer.required = 1;
    for (s = 0; s < 2; s++) {
        for (c = 0; c < COUNT(compressions); c++) {
            for (t = 0; t < COUNT(types); t++) {
                write_foreign(s ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, compressions[c], types[t], W, H);
                if (!exr_read(at("foreign.exr"), &layer, 1, error, sizeof error)) fail_msg("%s", error);
                assert_int_equal(layer.pixels.width, W);
                assert_int_equal(layer.pixels.height, H);
                for (i = 0; i < W * H; i++) assert_true(layer.pixels.data[i] == (float)i); /* < 2048: exact in half too */
                image_free(&layer.pixels);
            }
        }
    }
}

static void a_file_that_cannot_be_written_leaves_nothing(void **state)
{
    image_layer layers[3];
    image       two = make_image(4, 4, 2);
    char        temp[64];

    (void)state;
    write_sample(layers);
    assert_false(exr_write(at("none/x.exr"), layers, 3, error, sizeof error));
    assert_error_has("none/x.exr: cannot be written");
    assert_false(png_write(at("none/x.png"), &layers[1].pixels, 1, error, sizeof error));
    assert_error_has("none/x.png: cannot be written");
    assert_false(png_write(at("two.png"), &two, 1, error, sizeof error));
    assert_error_has("1 or 3 channels");
    assert_false(text_write(folder, "a folder is in the way", error, sizeof error));
    assert_error_has("cannot be replaced");
    snprintf(temp, sizeof temp, "%s.%ld.tmp", folder, (long)getpid());
    assert_int_equal(access(temp, F_OK), -1);
    free_layers(layers, 3);
    image_free(&two);
}

static void png_has_the_size_and_kind_of_the_image(void **state)
{
    image          img = make_image(W, H, 3);
    size_t         size;
    unsigned char *bytes;

    (void)state;
    img.data[0] = NAN;
    img.data[1] = INFINITY;
    assert_true(png_write(at("x.png"), &img, 1, error, sizeof error));
    bytes = read_bytes(at("x.png"), &size);
    assert_memory_equal(bytes, "\x89PNG", 4);
    assert_int_equal(bytes[19], W); /* IHDR: width, height, depth, colour type 2 = RGB */
    assert_int_equal(bytes[23], H);
    assert_int_equal(bytes[24], 8);
    assert_int_equal(bytes[25], 2);
    free(bytes);
    image_free(&img);
}

/* ---- captures ---------------------------------------------------------------------------------------------------- */

#define PERSPECTIVE  "[[1.5,0,0.1,0],[0,2,-0.2,0],[0,0,-1.002002,-0.2002002],[0,0,-1,0]]" /* near 0.1, far 100 */
#define ORTHOGRAPHIC "[[0.5,0,0,0.1],[0,0.4,0,0],[0,0,-0.02002002,-1.002002],[0,0,0,1]]" /* the same */
#define VIEW         "[[1,0,0,0],[0,0,1,-2],[0,-1,0,-3],[0,0,0,1]]"
#define CAMERA(w, h, n, f, p, v) \
    "{\"width\":" w ",\"height\":" h ",\"near\":" n ",\"far\":" f ",\"projection_rows\":" p ",\"view_rows\":" v "}"

static void write_frame(void)
{
    image_layer layers[] = {{"depth", "Z", {0, 0, 0, NULL}, 1}, {"normal", "XYZ", {0, 0, 0, NULL}, 1},
                            {"albedo", "RGB", {0, 0, 0, NULL}, 1}, {"direct", "RGB", {0, 0, 0, NULL}, 1}};
    int i, p;

    for (i = 0; i < 4; i++) layers[i].pixels = make_image(W, H, i ? 3 : 1);
    for (p = 0; p < W * H; p++) { /* a wall at 5 m that faces the camera */
        layers[0].pixels.data[p] = 5.0f;
        for (i = 0; i < 3; i++) {
            layers[1].pixels.data[3 * p + i] = i == 2 ? 1.0f : 0.0f;
            layers[2].pixels.data[3 * p + i] = 0.5f;
            layers[3].pixels.data[3 * p + i] = 1.0f;
        }
    }
    assert_true(exr_write(at("frame.exr"), layers, 4, error, sizeof error));
    free_layers(layers, 4);
    write_bytes(at("camera.json"), CAMERA("21", "37", "0.1", "100", PERSPECTIVE, VIEW),
                strlen(CAMERA("21", "37", "0.1", "100", PERSPECTIVE, VIEW)));
}

static void capture_is_loaded_with_the_y_row_turned(void **state)
{
    capture cap;

    (void)state;
    write_frame();
    if (!capture_load(&cap, at("frame.exr"), at("camera.json"), error, sizeof error)) fail_msg("%s", error);
    assert_int_equal(cap.width, W);
    assert_int_equal(cap.height, H);
    assert_false(cap.orthographic);
    assert_true(cap.projection[0] == 1.5f && cap.projection[5] == -2.0f && cap.projection[8] == 0.1f && cap.projection[9] == 0.2f);
    assert_true(cap.projection[11] == -1.0f && cap.view[6] == -1.0f && cap.view[14] == -3.0f);
    assert_null(cap.truth_ao.data);
    assert_null(cap.emission.data);
    capture_free(&cap);
}

static void odd_cameras_are_explained(void **state)
{
    static const struct { const char *json, *says; int misfit; } cases[] = {
        {CAMERA("64", "36", "0.1", "100", PERSPECTIVE, VIEW), "camera is for 64x36, the frame", 1},
        {"{\"width\":21,\n\"height\":}", "is not valid JSON (line 2)", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, VIEW) " more", "is not valid JSON", 0},
        {"[1, 2]", "\"width\" is missing", 0},
        {CAMERA("\"21\"", "37", "0.1", "100", PERSPECTIVE, VIEW), "\"width\" is not one", 0},
        {CAMERA("21", "37", "0.1", "1e999", PERSPECTIVE, VIEW), "\"far\" is not one", 0},
        {CAMERA("21", "37", "0.1", "100", "[[1,0,0,0],[0,1,0,0],[0,0,1,0]]", VIEW), "\"projection_rows\" is not one", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, "[[1,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), "row 0 of \"view_rows\"", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, "[[1,0,0,0],[0,1,0,1e999],[0,0,1,0],[0,0,0,1]]"), "row 1, column 3", 0},
        {CAMERA("21", "37", "0.1", "100", "[[1,0,0,0],[0,1,0,0],[0,0,-1,-0.2],[0,0,1,0]]", VIEW), "neither perspective", 0},
        {CAMERA("21", "37", "0.1", "100", "[[1,0.5,0,0],[0,2,0,0],[0,0,-1.002002,-0.2002002],[0,0,-1,0]]", VIEW), "has a shear", 0},
        {CAMERA("21", "37", "0.1", "100", "[[1,0,0,0],[0,-2,0,0],[0,0,-1.002002,-0.2002002],[0,0,-1,0]]", VIEW),
         "has a shear, a mirror", 0},
        {CAMERA("21", "37", "100", "0.1", PERSPECTIVE, VIEW), "must be 0 < near < far", 0},
        {CAMERA("21", "37", "0.2", "100", PERSPECTIVE, VIEW), "does not map \"near\" 0.2", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, "[[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"), "is not rigid", 0},
        {CAMERA("21", "37", "0.1", "100", PERSPECTIVE, "[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]"), "is not rigid", 0},
    };
    capture cap;
    size_t  i;

    (void)state;
    write_frame();
    for (i = 0; i < COUNT(cases); i++) {
        write_bytes(at("odd.json"), cases[i].json, strlen(cases[i].json));
        assert_false(capture_load(&cap, at("frame.exr"), at("odd.json"), error, sizeof error));
        assert_error_has("odd.json: ");
        assert_error_has(cases[i].says);
        assert_int_equal(cap.misfit, cases[i].misfit);
        assert_null(cap.depth.data);
    }
    assert_false(capture_load(&cap, at("frame.exr"), at("none.json"), error, sizeof error));
    assert_error_has("none.json: cannot be opened");
}

/* ---- conventions ------------------------------------------------------------------------------------------------- */

#define NEAR_Z 0.25f
#define FAR_Z  200.0f

/* A column of depths from near to far in equal ratios, the last pixel sky; off-centre, seen from a turned camera. */
static capture make_capture(int orthographic)
{
    capture cap;
    int     i;

    memset(&cap, 0, sizeof cap);
    cap.width = 1;
    cap.height = H;
    cap.orthographic = orthographic;
    cap.near_z = NEAR_Z;
    cap.far_z = FAR_Z;
    cap.depth = make_image(1, H, 1);
    cap.normal = make_image(1, H, 3);
    cap.albedo = make_image(1, H, 3);
    cap.direct = make_image(1, H, 3);
    for (i = 0; i < H; i++) {
        float x = 0.1f * (float)i, *n = cap.normal.data + 3 * i;
        cap.depth.data[i] = i == H - 1 ? 1e10f : NEAR_Z * powf(FAR_Z / NEAR_Z, (float)i / (H - 2));
        n[0] = sinf(x) * 0.6f, n[1] = cosf(x) * 0.6f, n[2] = 0.8f;
    }
    cap.depth.data[H - 2] = FAR_Z;
    cap.projection[0] = 1.3f, cap.projection[5] = -2.1f;
    cap.projection[orthographic ? 12 : 8] = 0.1f, cap.projection[orthographic ? 13 : 9] = -0.2f;
    cap.projection[orthographic ? 15 : 11] = orthographic ? 1.0f : -1.0f;
    cap.projection[10] = orthographic ? -2.0f / (FAR_Z - NEAR_Z) : -(FAR_Z + NEAR_Z) / (FAR_Z - NEAR_Z);
    cap.projection[14] = orthographic ? -(FAR_Z + NEAR_Z) / (FAR_Z - NEAR_Z) : -2.0f * FAR_Z * NEAR_Z / (FAR_Z - NEAR_Z);
    /* rows (0.6 0.8 0) (0 0 1) (0.8 -0.6 0): a rotation, written in columns */
    cap.view[0] = 0.6f, cap.view[2] = 0.8f, cap.view[4] = 0.8f, cap.view[6] = -0.6f, cap.view[9] = 1.0f, cap.view[15] = 1.0f;
    return cap;
}

static hbil_plan make_plan(const char *text)
{
    hbil_config config = {0};
    hbil_plan   plan;

    assert_int_equal(hbil_config_parse(&config, text, strlen(text), NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&config, &plan, NULL), HBIL_OK);
    return plan;
}

static void free_inputs(image *inputs)
{
    int i;

    for (i = 0; i < HBIL_MAX_TEXTURES; i++) image_free(&inputs[i]);
}

/* Device depth back to metres by the frame's own matrix, in double, and compared within what rounding to float can do.
 *
 * d is stored with a relative error of at most e = 2^-24 (round to nearest). With s = ndc units per unit of d (1, GL: 2):
 *   perspective   ndc = b / z - |..|, so dz / z = z * s * dd / b <= z * s * d * e / b. Forward, d <= 1: the error grows
 *                 with z / near. Reversed, d = b / (s z) - const, so d * s * z / b <= 1: never more than e.
 *   orthographic  ndc is linear in z: dz = s * dd / |a| <= s * d * e / |a| at any z.
 * The planes themselves: the matrix is rounded to float too, so a depth on a plane may fall outside [0, 1] and is clamped;
 * the entries' own error, (|a| + |b| / z) e, comes on top there.
 * Second-order terms and the double arithmetic of this check: one part in a thousand more, and 1e-12. */
static void check_depths(const capture *cap, const hbil_plan *plan, const hbil_frame *frame, const image *depth)
{
    const double a = (double)frame->projection[10], b = (double)frame->projection[14], e = 1.0 / 16777216.0;
    const int    gl = plan->config.clip == HBIL_CLIP_GL, reversed = plan->config.depth_direction == HBIL_DEPTH_DIRECTION_REVERSED;
    const double s = gl ? 2.0 : 1.0;
    int i;

    for (i = 0; i < H - 1; i++) {
        const double z = (double)cap->depth.data[i], d = (double)depth->data[i], ndc = gl ? 2.0 * d - 1.0 : d;
        const double back = cap->orthographic ? (b - ndc) / a : b / (ndc + a);
        const int    clamped = d <= 0.0 || d >= 1.0;
        const double bound = cap->orthographic ? (s * d + clamped * (fabs(a) * z + fabs(b))) * e / fabs(a)
                                               : (s * d + clamped * (fabs(a) + fabs(b) / z)) * e * z * z / fabs(b);

        assert_true(d >= 0.0 && d <= 1.0);
        if (!(fabs(back - z) <= bound * 1.001 + 1e-12 * z)) fail_msg("depth %.9g came back as %.9g, allowed %.3g", z, back, bound);
        if (reversed && !cap->orthographic && !clamped) assert_true(fabs(back - z) <= z * e * 1.001 + 1e-12 * z);
    }
    assert_true(depth->data[H - 1] == (reversed ? 0.0f : 1.0f));                      /* sky: exactly the clear value */
    assert_true(fabsf(depth->data[0] - (reversed ? 1.0f : 0.0f)) < 1e-6f);            /* the near plane */
    if (plan->config.depth_far == HBIL_DEPTH_FAR_FINITE) assert_true(fabsf(depth->data[H - 2] - (reversed ? 0.0f : 1.0f)) < 1e-6f);
}

static void every_depth_convention_round_trips(void **state)
{
    int k;

    (void)state;
    for (k = 0; k < 12; k++) {
        const int  orthographic = k >= 8;
        char       text[160];
        capture    cap = make_capture(orthographic);
        image      inputs[HBIL_MAX_TEXTURES];
        hbil_plan  plan;
        hbil_frame frame;
        int        c;

        snprintf(text, sizeof text, "depth=device projection=%s depth_direction=%s clip=%s depth_far=%s",
                 orthographic ? "orthographic" : "perspective", k & 1 ? "reversed" : "forward", k & 2 ? "gl" : "vulkan",
                 k & 4 ? "infinite" : "finite");
        plan = make_plan(text);
        if (!capture_encode(&cap, &plan, &frame, inputs, error, sizeof error)) fail_msg("%s: %s", text, error);
        check_depths(&cap, &plan, &frame, &inputs[hbil_plan_texture(&plan, "depth")]);
        for (c = 0; c < 16; c++) /* all but the depth row is the capture's own, off-centre terms included */
            if (c != 10 && c != 14) assert_true(frame.projection[c] == cap.projection[c]);
        if ((k & 7) == 2) { /* GL, forward, finite: what the capture came with */
            assert_true(fabsf(frame.projection[10] - cap.projection[10]) < 1e-6f);
            assert_true(fabsf(frame.projection[14] - cap.projection[14]) < 1e-6f);
        }
        assert_int_equal(frame.width, 1);
        assert_int_equal(frame.height, H);
        free_inputs(inputs);
        capture_free(&cap);
    }
}

static void normals_and_inputs_are_as_the_config_asks(void **state)
{
    capture    cap = make_capture(0);
    hbil_plan  plan = make_plan("normals=world");
    hbil_frame frame;
    image      inputs[HBIL_MAX_TEXTURES];
    int        i, r;

    (void)state;
    assert_true(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    for (i = 0; i < H; i++) {
        const float *w = inputs[hbil_plan_texture(&plan, "normal")].data + 3 * i, *m = frame.view;
        for (r = 0; r < 3; r++) /* turned back by the view matrix it is the view normal again */
            assert_true(fabsf(m[r] * w[0] + m[4 + r] * w[1] + m[8 + r] * w[2] - cap.normal.data[3 * i + r]) < 1e-6f);
    }
    assert_memory_equal(inputs[hbil_plan_texture(&plan, "depth")].data, cap.depth.data, H * sizeof(float));
    assert_memory_equal(inputs[hbil_plan_texture(&plan, "radiance")].data, cap.direct.data, 3 * H * sizeof(float));
    assert_memory_equal(inputs[hbil_plan_texture(&plan, "direct")].data, cap.direct.data, 3 * H * sizeof(float));
    assert_memory_equal(inputs[hbil_plan_texture(&plan, "albedo")].data, cap.albedo.data, 3 * H * sizeof(float));
    free_inputs(inputs);

    plan = make_plan("normals=depth outputs=ao");
    assert_true(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) assert_int_equal(inputs[i].data != NULL, i == hbil_plan_texture(&plan, "depth"));
    free_inputs(inputs);
    capture_free(&cap);
}

static void a_plan_that_does_not_fit_the_capture_is_explained(void **state)
{
    capture    cap = make_capture(0);
    hbil_plan  plan = make_plan("projection=orthographic");
    hbil_frame frame;
    image      inputs[HBIL_MAX_TEXTURES];
    int        i;

    (void)state;
    assert_false(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    assert_error_has("option projection: orthographic, but the frame's camera is perspective. Set projection=perspective");
    plan = make_plan("width=64 height=64");
    assert_false(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    assert_error_has("options width, height: 64x64 baked, but the frame is 1x37");
    plan = make_plan("");
    strcpy(plan.textures[hbil_plan_texture(&plan, "albedo")].name, "motion");
    assert_false(capture_encode(&cap, &plan, &frame, inputs, error, sizeof error));
    assert_error_has("the input motion");
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) assert_null(inputs[i].data);
    capture_free(&cap);
}

/* ---- metrics ----------------------------------------------------------------------------------------------------- */

/* Five pixels: plain, plain, sky, emitter, black but lit surface (albedo 0, truth_ao not). */
static void metrics_match_numbers_worked_out_by_hand(void **state)
{
    capture cap;
    image   result = make_image(5, 1, 1), truth = make_image(5, 1, 1), vectors = make_image(5, 1, 3), other = make_image(5, 1, 3);
    metric  m;
    int     i;

    (void)state;
    memset(&cap, 0, sizeof cap);
    cap.depth = make_image(5, 1, 1);
    cap.albedo = make_image(5, 1, 3);
    cap.truth_ao = make_image(5, 1, 1);
    for (i = 0; i < 5; i++) {
        cap.depth.data[i] = i == 2 ? 1e10f : 3.0f;
        cap.albedo.data[3 * i] = cap.albedo.data[3 * i + 1] = cap.albedo.data[3 * i + 2] = i < 2 ? 0.5f : 0.0f;
        cap.truth_ao.data[i] = i == 4 ? 0.25f : 0.0f;
        assert_int_equal(metric_counts(&cap, (size_t)i), i != 2 && i != 3);
        truth.data[i] = 0.5f;
        result.data[i] = 0.5f;
    }
    result.data[0] = 0.75f, result.data[1] = -0.5f, result.data[2] = 100.0f, result.data[3] = NAN, result.data[4] = 0.5f;
    m = metric_measure(&result, &truth, &cap);
    assert_int_equal(m.nan, 1);
    assert_int_equal(m.inf, 0);
    assert_int_equal(m.negative, 1);
    assert_true(m.min == -0.5 && m.max == 100.0 && fabs(m.mean - 100.75 / 4.0) < 1e-12);
    assert_int_equal(m.compared, 3); /* differences 0.25, -1, 0 */
    assert_true(fabs(m.bias - -0.75 / 3.0) < 1e-12 && fabs(m.rmse - sqrt(1.0625 / 3.0)) < 1e-12);

    result.data[1] = -INFINITY;
    m = metric_measure(&result, &truth, &cap);
    assert_int_equal(m.inf, 1);
    assert_int_equal(m.compared, 2);
    assert_true(fabs(m.bias - 0.125) < 1e-12);
    assert_int_equal(metric_measure(&result, &cap.truth_near, &cap).compared, 0); /* absent */
    assert_int_equal(metric_measure(&vectors, &truth, &cap).compared, 0);         /* other shape */
    other.data[0] += 3.0f; /* one of the 3 x 3 values that are compared */
    m = metric_measure(&other, &vectors, &cap);
    assert_true(m.compared == 3 && fabs(m.bias - 3.0 / 9.0) < 1e-12 && fabs(m.rmse - 1.0) < 1e-12);
    image_free(&result);
    image_free(&truth);
    image_free(&vectors);
    image_free(&other);
    capture_free(&cap);
}

/* ---- the built-in scene ------------------------------------------------------------------------------------------ */

#define SCENE_W 96
#define SCENE_H 96
#define RAYS    64

static double last_progress;

static void check_progress(double done)
{
    assert_true(done >= last_progress && done <= 1.0);
    last_progress = done;
}

static void scene_has_the_same_bytes_every_time(void **state)
{
    capture a, b;

    (void)state;
    last_progress = 0.0;
    assert_true(capture_scene(&a, "cornell", 40, 23, 8, check_progress, error, sizeof error));
    assert_true(last_progress == 1.0);
    assert_true(capture_scene(&b, "cornell", 40, 23, 8, NULL, error, sizeof error));
    assert_memory_equal(a.depth.data, b.depth.data, 40 * 23 * sizeof(float));
    assert_memory_equal(a.normal.data, b.normal.data, 40 * 23 * 3 * sizeof(float));
    assert_memory_equal(a.direct.data, b.direct.data, 40 * 23 * 3 * sizeof(float));
    assert_memory_equal(a.truth_ao.data, b.truth_ao.data, 40 * 23 * sizeof(float));
    assert_memory_equal(a.truth_near.data, b.truth_near.data, 40 * 23 * 3 * sizeof(float));
    capture_free(&a);
    capture_free(&b);
    assert_true(capture_scene(&a, "cornell", 1, 1, 0, NULL, error, sizeof error));
    assert_null(a.truth_ao.data);
    capture_free(&a);
    assert_false(capture_scene(&a, "sponza", 8, 8, 1, NULL, error, sizeof error));
    assert_error_has("There is: cornell");
    assert_false(capture_scene(&a, "cornell", 8, 20000, 1, NULL, error, sizeof error));
    assert_error_has("[1, 16384]");
}

/* Lambert's formula: cosine-weighted part of the hemisphere around n at p that a polygon covers, seen from its front. */
static double polygon_view(const double p[3], const double n[3], const double corner[4][3])
{
    double r[4][3], sum = 0.0, length, cross[3], dot;
    int    i, j, c;

    for (i = 0; i < 4; i++) {
        for (c = 0; c < 3; c++) r[i][c] = corner[i][c] - p[c];
        length = sqrt(r[i][0] * r[i][0] + r[i][1] * r[i][1] + r[i][2] * r[i][2]);
        for (c = 0; c < 3; c++) r[i][c] /= length;
    }
    for (i = 0; i < 4; i++) {
        j = (i + 1) % 4;
        for (c = 0; c < 3; c++) cross[c] = r[i][(c + 1) % 3] * r[j][(c + 2) % 3] - r[i][(c + 2) % 3] * r[j][(c + 1) % 3];
        dot = r[i][0] * r[j][0] + r[i][1] * r[j][1] + r[i][2] * r[j][2];
        length = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
        sum += acos(dot) * (cross[0] * n[0] + cross[1] * n[1] + cross[2] * n[2]) / length;
    }
    return fabs(sum) / (2.0 * 3.14159265358979);
}

/* World position (x right, y away, z up; m) of a pixel, through the capture's own matrices. */
static void world_of(const capture *cap, int x, int y, double out[3])
{
    const double z = (double)cap->depth.data[y * cap->width + x];
    double       v[3];
    int          r, c;

    v[0] = z * (2.0 * (x + 0.5) / cap->width - 1.0) / (double)cap->projection[0];
    v[1] = z * (2.0 * (y + 0.5) / cap->height - 1.0) / (double)cap->projection[5];
    v[2] = -z;
    for (c = 0; c < 3; c++)
        for (r = 0, out[c] = 0.0; r < 3; r++) out[c] += (double)cap->view[4 * c + r] * (v[r] - (double)cap->view[12 + r]);
}

/* The ceiling within 1.5 m of the open front looks out of it over both blocks, so it is exactly the front's form factor that is
 * visible. A pixel's mean of RAYS rays has a deviation of at most 0.5 / sqrt(RAYS), pixels are independent: five sigmas. */
static void scene_ao_of_the_ceiling_is_the_form_factor_of_the_open_front(void **state)
{
    static const double front[4][3] = {{-2.75, 0, 0}, {2.78, 0, 0}, {2.78, 0, 5.488}, {-2.78, 0, 5.488}}, down[3] = {0, 0, -1};
    capture cap;
    double  sum = 0.0, p[3];
    int     x, y, count = 0;

    (void)state;
    assert_true(capture_scene(&cap, "cornell", SCENE_W, SCENE_H, RAYS, NULL, error, sizeof error));
    for (y = 0; y < SCENE_H / 2; y++) {
        for (x = 0; x < SCENE_W; x++) {
            const size_t i = (size_t)(y * SCENE_W + x);
            if (!metric_counts(&cap, i) || cap.normal.data[3 * i + 1] > -0.99f) continue;
            world_of(&cap, x, y, p);
            assert_true(fabs(p[2] - 5.488) < 1e-3);
            if (p[1] > 1.5) continue;
            sum += (double)cap.truth_ao.data[i] - polygon_view(p, down, front);
            count++;
        }
    }
    assert_true(count > 200);
    if (!(fabs(sum / count) < 5.0 * 0.5 / sqrt((double)RAYS * count))) fail_msg("mean error %g over %d pixels", sum / count, count);
    capture_free(&cap);
}

/* The back wall above 4 m sees the whole lamp: direct = albedo * lamp radiance * form factor, to the error of 256 sample points. */
static void scene_direct_light_is_the_form_factor_of_the_lamp(void **state)
{
    static const double lamp[4][3] = {{0.65, 2.27, 5.487}, {-0.65, 2.27, 5.487}, {-0.65, 3.32, 5.487}, {0.65, 3.32, 5.487}};
    static const double forward[3] = {0, -1, 0}, colour[3] = {17.0 * 0.725, 12.0 * 0.71, 4.0 * 0.68};
    capture cap;
    double  p[3], bright = 0.0;
    int     x, y, c, count = 0;

    (void)state;
    assert_true(capture_scene(&cap, "cornell", SCENE_W, SCENE_H, RAYS, NULL, error, sizeof error));
    for (y = 0; y < SCENE_H; y++) {
        for (x = 0; x < SCENE_W; x++) {
            const size_t i = (size_t)(y * SCENE_W + x);
            for (c = 0; c < 3; c++) bright = fmax(bright, (double)cap.direct.data[3 * i + (size_t)c]);
            if (cap.normal.data[3 * i + 1] < -0.99f) assert_true(cap.direct.data[3 * i] == 0.0f); /* the ceiling: behind the lamp */
            if (cap.normal.data[3 * i + 2] < 0.999f) continue;
            world_of(&cap, x, y, p);
            if (p[2] < 4.0 || p[1] < 5.0) continue;
            for (c = 0; c < 3; c++) {
                const double want = colour[c] * polygon_view(p, forward, lamp), got = (double)cap.direct.data[3 * i + (size_t)c];
                /* The lamp's plane is 90 degrees to the wall: at grazing angles close to the ceiling relative errors grow. */
                if (!(fabs(got - want) < 0.01 * want + 1e-4)) fail_msg("direct %g, form factor says %g at height %g", got, want,
                                                                       p[2]);
            }
            count++;
        }
    }
    assert_true(count > 100);
    for (c = 0; c < SCENE_W * SCENE_H; c++) /* what is not open is at most as bright as the brightest surface */
        for (x = 0; x < 3; x++)
            assert_true((double)cap.truth_near.data[3 * c + x] <= bright * (1.0 - (double)cap.truth_ao.data[c]) * 1.1 + 1e-6);
    capture_free(&cap);
}

/* ---- the program ------------------------------------------------------------------------------------------------- */

/* Runs hbil-frame with arguments in which @ is the folder; its exit code. What it says on stderr is put into error[]. */
static int run_program(const char *arguments)
{
    char           command[1024] = "\"$HBIL_FRAME_BIN\" ";
    size_t         used = strlen(command), size;
    unsigned char *said;
    int            status;

    for (; *arguments && used + 64 < sizeof command; arguments++)
        used += (size_t)snprintf(command + used, sizeof command - used, *arguments == '@' ? "%s" : "%.1s",
                                 *arguments == '@' ? folder : arguments);
    snprintf(command + used, sizeof command - used, " >%s/stdout 2>%s/stderr", folder, folder);
    status = system(command);
    assert_true(WIFEXITED(status));
    said = read_bytes(at("stderr"), &size);
    snprintf(error, sizeof error, "%s", (const char *)said);
    free(said);
    return WEXITSTATUS(status);
}

static void exit_codes_are_as_the_help_says(void **state)
{
    static const struct { const char *arguments; int code; const char *says; } cases[] = {
        {"--help", 0, ""},
        {"--version", 0, ""},
        {"", 2, "give either --frame"},
        {"--scene cornell --frame @/frame.exr", 2, "give either --frame"},
        {"--frame @/frame.exr", 2, "--camera"},
        {"--scene sponza", 2, "must be cornell"},
        {"--scene cornell --size 0x9", 2, "WxH"},
        {"--scene cornell --size 64x64x64", 2, "WxH"},
        {"--scene cornell --rays -1", 2, "--rays -1"},
        {"--scene cornell --repeat 0", 2, "--repeat 0"},
        {"--scene cornell --backend metal", 2, "must be vulkan or gl"},
        {"--scene cornell --set", 2, "--set: "},
        {"--scene cornell --fast", 2, "--fast: unknown"},
        {"--frame @/frame.exr --camera @/camera.json --rays 3", 2, "belong to --scene"},
        {"--scene cornell --set slices=99,reech=2", 1, "did you mean reach"},
        {"--scene cornell --set reech=2 --set slices=99", 1, "slices=99"},
        {"--scene cornell --set slices", 1, "slices"},
        {"--scene cornell --preset qality", 1, "quality"},
        {"--scene cornell --set target=gl", 1, "option target"},
        {"--frame @/none.exr --camera @/camera.json", 3, "none.exr: cannot be opened"},
        {"--frame @/camera.json --camera @/camera.json", 3, "is not an OpenEXR file"},
        {"--frame @/frame.exr --camera @/frame.exr", 3, "is not valid JSON"},
        {"--scene cornell --out @/none/x.exr", 3, "is missing"},
        {"--scene cornell --out @", 3, "is a folder"},
        {"--scene cornell --png @/camera.json", 3, "is a file, not a folder"},
        {"--frame @/frame.exr --camera @/small.json", 4, "camera is for 20x37"},
        {"--frame @/frame.exr --camera @/camera.json --set projection=orthographic", 4, "projection=perspective"},
        {"--frame @/frame.exr --camera @/camera.json --set width=20,height=37", 4, "the frame is 21x37"},
    };
    size_t i;
    int    code;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) {
        print_message("skipped: HBIL_FRAME_BIN is not set\n");
        skip();
    }
    write_frame();
    write_bytes(at("small.json"), CAMERA("20", "37", "0.1", "100", PERSPECTIVE, VIEW),
                strlen(CAMERA("20", "37", "0.1", "100", PERSPECTIVE, VIEW)));
    for (i = 0; i < COUNT(cases); i++) {
        code = run_program(cases[i].arguments);
        if (code != cases[i].code) fail_msg("hbil-frame %s: exit %d, not %d: %s", cases[i].arguments, code, cases[i].code, error);
        assert_error_has(cases[i].says);
    }
}

static void a_fault_leaves_the_output_file_alone(void **state)
{
    size_t         size;
    unsigned char *bytes;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) skip();
    write_frame();
    write_bytes(at("kept.exr"), "kept", 4);
    assert_int_equal(run_program("--frame @/frame.exr --camera @/camera.json --set projection=orthographic --out @/kept.exr"), 4);
    bytes = read_bytes(at("kept.exr"), &size);
    assert_int_equal(size, 4);
    free(bytes);
}

/* A wall that faces the camera and nothing else: fully open, no near light, composite = direct. */
static void check_wall(const char *backend, const char *camera, const char *set, int *ran)
{
    image_layer layers[] = {{"ao", "Y", {0, 0, 0, NULL}, 1}, {"composite", "RGB", {0, 0, 0, NULL}, 1},
                            {"near", "RGB", {0, 0, 0, NULL}, 0}};
    char        arguments[320];
    int         i, code;

    snprintf(arguments, sizeof arguments, "--frame @/frame.exr --camera @/%s --backend %s --set outputs=ao+composite --set %s"
             " --out @/out.exr --png @/png/ --report @/out.json --repeat 3", camera, backend, set);
    code = run_program(arguments);
    if (code == 5) print_message("no %s here: %s", backend, error);
    if (code == 5) return;
    if (code != 0) fail_msg("%s: exit %d: %s", arguments, code, error);
    *ran = 1;
    if (!exr_read(at("out.exr"), layers, 3, error, sizeof error)) fail_msg("%s", error);
    for (i = 0; i < W * H; i++) assert_true(fabsf(layers[0].pixels.data[i] - 1.0f) < 1e-3f);
    for (i = 0; i < 3 * W * H; i++) assert_true(fabsf(layers[1].pixels.data[i] - 1.0f) < 1e-3f);
    assert_null(layers[2].pixels.data); /* near was not asked for */
    free_layers(layers, 3);
}

static void a_flat_wall_is_open_and_lit_by_direct_light_alone(void **state)
{
    static const char *const backends[] = {"vulkan", "gl"}, *const cameras[] = {"camera.json", "orthographic.json"};
    static const char *const sets[] = {"depth=linear", "depth=device,normals=world",
                                       "depth=device,depth_direction=reversed,clip=gl"};
    const char    *orthographic = CAMERA("21", "37", "0.1", "100", ORTHOGRAPHIC, VIEW);
    size_t         b, c, k, size;
    unsigned char *report;
    int            ran = 0;

    (void)state;
    if (!getenv("HBIL_FRAME_BIN")) skip();
    write_frame();
    write_bytes(at("orthographic.json"), orthographic, strlen(orthographic));
    for (b = 0; b < COUNT(backends); b++)
        for (c = 0; c < COUNT(cameras); c++)
            for (k = 0; k < COUNT(sets); k++) check_wall(backends[b], cameras[c], sets[k], &ran);
    if (!ran) skip();
    report = read_bytes(at("out.json"), &size);
    assert_non_null(strstr((const char *)report, "\"config_hash\""));
    assert_non_null(strstr((const char *)report, "\"march\""));
    free(report);
    assert_int_equal(access(at("png/before.png"), R_OK) | access(at("png/after.png"), R_OK) | access(at("png/ao.png"), R_OK), 0);
    assert_int_not_equal(access(at("png/near.png"), F_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exr_round_trip_is_exact),
        cmocka_unit_test(missing_channel_is_named_with_those_that_exist),
        cmocka_unit_test(truncated_exr_is_refused_wherever_it_is_cut),
        cmocka_unit_test(damaged_exr_never_crashes),
        cmocka_unit_test(odd_headers_are_explained),
        cmocka_unit_test(every_storage_type_and_compression_is_read),
        cmocka_unit_test(a_file_that_cannot_be_written_leaves_nothing),
        cmocka_unit_test(png_has_the_size_and_kind_of_the_image),
        cmocka_unit_test(capture_is_loaded_with_the_y_row_turned),
        cmocka_unit_test(odd_cameras_are_explained),
        cmocka_unit_test(every_depth_convention_round_trips),
        cmocka_unit_test(normals_and_inputs_are_as_the_config_asks),
        cmocka_unit_test(a_plan_that_does_not_fit_the_capture_is_explained),
        cmocka_unit_test(metrics_match_numbers_worked_out_by_hand),
        cmocka_unit_test(scene_has_the_same_bytes_every_time),
        cmocka_unit_test(scene_ao_of_the_ceiling_is_the_form_factor_of_the_open_front),
        cmocka_unit_test(scene_direct_light_is_the_form_factor_of_the_lamp),
        cmocka_unit_test(exit_codes_are_as_the_help_says),
        cmocka_unit_test(a_fault_leaves_the_output_file_alone),
        cmocka_unit_test(a_flat_wall_is_open_and_lit_by_direct_light_alone),
    };
    return cmocka_run_group_tests_name("frame", tests, make_folder, remove_folder);
}
