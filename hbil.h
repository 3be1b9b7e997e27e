/* hbil.h - 0.1.0 - horizon-based indirect lighting: writes the shaders, plans the frame.              MIT or public domain
 *
 * From a configuration struct this header writes specialised GLSL compute shaders for screen-space lighting (HBAO, GTAO,
 * HBIL, visibility bitmask: ambient occlusion, near and far light, bent cones, specular occlusion from the depth buffer)
 * and a plan, plain data, that tells any engine which textures to make, which passes to dispatch, with what bindings and
 * barriers.
 *
 *     #define HBIL_IMPLEMENTATION                     // in one C or C++ file
 *     #include "hbil.h"
 *
 *     hbil_config config = {0};                       // zero is the default, everywhere
 *     hbil_plan   plan;
 *     config.outputs = HBIL_OUTPUTS_AO | HBIL_OUTPUTS_NEAR;
 *     config.depth   = HBIL_DEPTH_DEVICE;
 *     if (hbil_plan_build(&config, &plan, NULL) == HBIL_OK)
 *         for (i = 0; i < plan.pass_count; ++i)
 *             hbil_emit_glsl(&plan, i, text, sizeof text, NULL);
 *
 * CONTENTS     search for the anchors
 *   >>does  >>steps  >>switches  >>conventions  >>outputs  >>methods  >>frames  >>promises  >>targets      the manual
 *   >>api                                                                 declarations
 *   >>tables  >>glsl  >>sink  >>words  >>config  >>filter  >>plan  >>emit  >>manifest  >>frame  >>check  >>public   implementation
 *
 * ======================================================================================================================
 * >>does
 *
 *   DOES       write GLSL for Vulkan, OpenGL and OpenGL ES; say what to allocate, bind, wait for and dispatch; pack the uniform block;
 *              read every depth, clip, projection and normal convention; leave out of the shader what the config does not ask
 *              for; refuse combinations that have no meaning.
 *   DOES NOT   call a GPU, allocate, read files, compile SPIR-V (backends/hbil_glslang.h does), trace rays, or see what is off
 *              the screen or behind the first surface: light from there is your probes' work.
 *
 * ======================================================================================================================
 * >>steps
 *
 *   1. hbil_config: zero it, set what you care about. hbil_config_parse reads the same from text, hbil_config_preset from a name.
 *   2. hbil_plan_build. On HBIL_E_CONFIG the diagnostics name each option, its value and the legal range.
 *   3. For each texture of the plan that is TRANSIENT or HISTORY: make it (format, hbil_plan_extent, copies). INPUT and
 *      OUTPUT are yours. For each pass: hbil_emit_glsl, compile, make a pipeline.
 *   4. Each frame: fill hbil_frame, hbil_pack_constants into a uniform buffer, hbil_plan_frame for the group counts. A plan with
 *      HISTORY textures wants last frame's camera, and reset=1 in its first frame.
 *   5. For each pass, in order: wait as its barriers say, bind its bindings by slot, dispatch.
 *   backends/hbil_vk.h and hbil_gl.h do steps 3 to 5 as they stand; backends/hbil_null.h proves a plan that you edited.
 *
 * ======================================================================================================================
 * >>switches   macros
 *
 *   HBIL_IMPLEMENTATION   in exactly one file: the implementation too.
 *   HBIL_API              everywhere, the same: linkage of the functions. default extern; static keeps all of it in one file.
 *
 * ======================================================================================================================
 * >>conventions
 *
 *   texels     row 0 is ndc y = -1, in Vulkan, GL and files alike. Pixel (x, y) has its centre at (x + 0.5, y + 0.5) and
 *              ndc = 2 (pixel centre) / size - 1. If your images are stored the other way up, negate row 1 of the projection.
 *              An engine that renders upside down into textures (D3D's way on GL, OGRE) has such a projection: hand over the one that
 *              it rendered with. A wrong sign shows as a floor that is nearly black.
 *   matrices   column-major floats, column vectors: clip = projection * view * world. m[4 * column + row].
 *   projection perspective (clip w = -z or +z of view space) or orthographic; off-centre, jittered and left-handed are read
 *              from the matrix. view x alone must make clip x, and y clip y. The screen sees 1e-4 to 179.98 degrees, or 1e-6 to 1e9 m.
 *   depth      linear: metres along the view axis, positive in front of the eye. device: the depth buffer's value v in
 *              [0, 1]. With d = v (reversed) or 1 - v (forward): perspective 1/depth = d (1/near - 1/far) + 1/far,
 *              orthographic depth = d (near - far) + far.
 *   sky        linear: depth >= sky_depth, below 1e-9 m (perspective) or NaN. device: v is the clear value 1 (forward) or 0
 *              (reversed). A sky pixel occludes nothing and gives no light; it gets ao, uniform_ao, specular_occlusion and
 *              multi_bounce 1, composite direct, all else 0.
 *   normals    unit, pointing away from the surface, in view or world space, in the channels that normal_encoding says: signed
 *              floats or snorm; 8, 10 or 16-bit unorm; octahedral; x and y of a normal that faces the camera.
 *   radiance   linear, any unit; NaN and negative count as 0, more than 60000 as 60000. Add what glowing surfaces emit, and they
 *              light the room.
 *   irradiance always E/pi, in the unit of the radiance: reflected light is albedo * value, without another pi.
 *   SH         real, orthonormal, of radiance (not convolved). Environments in world space, the output sh in your view space.
 *
 * ======================================================================================================================
 * >>outputs    of the shaders. V(w): visibility of the direction w; n: shading normal; integrals over the hemisphere of n
 *
 *   ao                  (1/pi) int V (n.w) dw with estimator horizon or bitmask; hbao weighs all directions alike, hbao_plus is
 *                       a share of samples. 1 is open. For any samples near + ao = 1 to rounding if all radiance is 1; facing, f0,
 *                       firefly, intensities, ao_exponent and seed_compat leave that on purpose.
 *   uniform_ao          (1/2pi) int V dw.
 *   bent                (1/pi) int V w (n.w) dw in your view space; length 2/3 and direction n when open. Wants slices >= 2.
 *   cone                xyz: bent as a unit vector (n where all is blocked); a: cosine of the half angle whose cone about n has
 *                       this ao, sqrt(1 - ao).
 *   near                (1/pi) int (1 - V) L (n.w) dw, L the radiance of what blocks. Times 1 - F0 with the option f0.
 *   sh                  layer k of Y00, Y1-1, Y10, Y11 in your view space: rgb int (1 - V) L Yk dw, a int V Yk dw. near_intensity
 *                       counts, F0 and ao_exponent do not.
 *   far                 (1/pi) int V L (n.w) dw, L the environment. far_visibility says how V meets L:
 *       bent            exact in bands 0 and 1 of SH, band 2 through the cone; of other environments ao * value(bent direction)
 *       ao, direction   ao * value of an open surface that faces n, or the bent direction
 *       cone            an open cone about the bent direction
 *       free_bits       radiance by the middle of each group of 8 sectors: several gaps keep their own light. ao_exponent does
 *                       not count here
 *   irradiance          near + far.
 *   specular_occlusion  share of the specular lobe that the cone leaves; 1 where nothing is hidden. Lobes rougher than .5 go over to
 *                       ao.
 *   multi_bounce        rgb: ao after all bounces between surfaces of the pixel's albedo. Instead of near light, never with it.
 *   composite           direct + albedo * (near + far).
 *
 * ======================================================================================================================
 * >>methods    which options make which method of the field; presets of the same names carry the articles' values
 *
 *   ours          march=sweep sweep_stride filter: the whole screen, see below. march=both estimator=bitmask occluder=thick
 *                 reach: thickness nearby, the sweep beyond.
 *   HBAO, HBAO+   estimator=hbao or hbao_plus, reach, attenuation, angle_bias.
 *   GTAO          estimator=horizon occluder=heuristic reach falloff; outputs multi_bounce and specular_occlusion.
 *   HBIL          estimator=horizon; near, cone; facing, f0; environment=sh far_visibility=cone.
 *   bitmask       estimator=bitmask occluder=thick thickness; facing=half_space; far_visibility=free_bits.
 *   The arithmetic is right in all of them: slices uniform around the local view vector, projected normals not normalised, exact
 *   sectors. seed_compat brings back what the articles did instead, to see the difference.
 *   Two marches. sampled takes slices * steps * 2 depths per pixel, and misses what lies between them; mips=spread makes them coarser
 *   with their distance, interleave=yes turns waves the same way: half the time, less error. sweep walks along every line of the
 *   screen, both ways, and keeps the hull of what it passed: each pixel gets its exact horizon over the whole screen for one
 *   depth load and about two hull steps a side, and the mean radiance of what stands below it. Solid height field only: no reach, falloff,
 *   thickness. Its directions are the same everywhere; sweep_stride=3 gives the pixels of each 3x3 block others, which filter=3x3 gathers.
 *   The sweep's walks are serial: a GPU has (width + height) * slices of them in flight, and two r32ui layers a
 *   slice to hold, four with light.
 *   Costs: a sample is one depth load; near light adds one of radiance per rise (and one normal with facing), sh four accumulators per
 *   channel, bent and sh of a bitmask an inverse per run of sectors, far light of SH nothing but arithmetic in its own pass.
 *
 * ======================================================================================================================
 * >>frames    what a march becomes over pixels and frames. Each option works without the others; all off leave the bare march
 *
 *   downscale     2 or 4: one pixel is marched for each block. Where the middle of a block is plane, that plane is taken exactly at
 *                 the middle; elsewhere blocks take the nearest and the farthest surface in turns. Each pixel then interpolates
 *                 the four around it that are near its tangent plane and of like normal. Sizes need not divide.
 *   filter        3x3 or 5x5 neighbours of the same surface; filter_passes 2 and 3 with gaps of 1 and 3 pixels (a-trous). All outputs
 *                 alike. With one slice the sums are filtered and divided afterwards. With temporal=yes it narrows as frames add up.
 *   temporal      running mean over at most `history` frames, per pixel and surface. rectify holds it to what this frame's 3x3
 *                 pixels could have made. A pixel whose surface was not seen begins anew. Noise advances with frame.index: hilbert_r2
 *                 repeats after 2^27 frames, ign after 61, which no jitter of 8, 16 or 32 divides.
 *   bounces       recursive: the march's radiance is u_radiance + albedo * last frame's near and far light. albedo * near_intensity counts
 *                 as .95 at most: light dies out. Give facing=half_space or filter with it: light of surfaces that face away adds up.
 *   reproject     camera: where both cameras say; nothing else may move. gather: where u_motion says. scatter: last frame's pixels are
 *                 projected into this frame, the nearest stays (imageAtomicMin); holes get no history, and light from coarser levels.
 *                 In all of them a pixel of last frame counts if it lies within 1 % of its depth of the tangent plane.
 *   storage       half: rgba16f between passes and frames. arithmetic=half: mediump in filter and upsampling.
 *   history       is yours to reset: frame.reset at a cut. The backends do so after a resize. Several views: one instance of a backend
 *                 each. Dynamic resolution: textures of the largest size, frame.width and .height per frame, last_width and
 *                 last_height beside them. Depths and light in it that are no finite numbers count as absent.
 *   order         prepare, shrink, scatter, claim, push, push_2, reproject, mips, sweep, march, temporal, filter, filter_2, filter_3, upsample,
 *                 light: those that the config needs.
 *
 * ======================================================================================================================
 * >>promises
 *
 *   memory     none is taken. Everything lives in your structs and buffers; a plan is plain data below 8 KB, without pointers.
 *   threads    every function may run on any number of threads at once, on different outputs. There is no global state.
 *   text       same config, same bytes: on every compiler, platform and locale, in every run. Equal hash, equal text (your hook's
 *              own text apart).
 *   errors     collected, not the first one only; each names the option and the legal range. Input never trips an assertion.
 *   versions   source-compatible within a major version; a new member at zero changes nothing. Emitted text may change with
 *              any version: CHANGELOG.md says so under EMIT, and HBIL_VERSION is part of the hash.
 *   warnings   none, as C99, C11, C++11, C++20 under the flags of CMakeLists.txt.
 *
 * ======================================================================================================================
 * >>targets
 *
 *                vulkan             gl                 gles                 gl, stage=fragment    gles, stage=fragment
 *   text         GLSL 450           GLSL 430 core      ESSL 310             GLSL 330 core         ESSL 300
 *   needs        Vulkan 1.0,        OpenGL 4.3         OpenGL ES 3.1        OpenGL 3.3            OpenGL ES 3.0,
 *                no feature                                                                       EXT_color_buffer_float
 *   outputs      storage images, of which a device     the same; made by    render targets, a layer each:
 *                has at least 4     has at least 8     glTexStorage; 4      8                     4: more is refused
 *   backend      hbil_vk.h          hbil_gl.h          hbil_gl.h            hbil_gl.h             hbil_gl.h
 *   tested on    lavapipe           OSMesa, EGL        EGL                  OSMesa                EGL      all Mesa 22.3
 *   real GPU     untested           untested           untested             untested              untested
 *
 *   HLSL and MSL     shadergen makes them from the text for vulkan; hbil_plan_register tells where they bind.
 *   stage=fragment   a pass draws the three vertices of hbil_emit_vertex over its targets: bindings that are written, a location for each
 *                    layer, viewport hbil_dispatch.groups. No blending, no tests, no depth. Samplers and the block HbilFrame go by their
 *                    names. Not with march=sweep or both, reproject=scatter. Same numbers as compute shaders.
 *   march=sweep      writes r32ui images of 2 * slices layers and reads its own texels back. Mesa's software rasterisers stop a shader
 *                    after 65535 loop iterations: lines up to about 13000 pixels there.
 *   reproject=scatter imageAtomicMin on r32ui images; in ES 3.1 GL_OES_shader_image_atomic.
 *   temporal=yes     with all outputs of a bitmask writes 8 images in a pass, 3 with the defaults.
 */

/* ======================================================================
 * >>api        declarations
 * ====================================================================== */

#ifndef HBIL_H
#define HBIL_H

#include <stddef.h>
#include <stdint.h>

#define HBIL_VERSION_MAJOR 0
#define HBIL_VERSION_MINOR 1
#define HBIL_VERSION_PATCH 0
#define HBIL_VERSION (HBIL_VERSION_MAJOR * 10000 + HBIL_VERSION_MINOR * 100 + HBIL_VERSION_PATCH)

#ifndef HBIL_API
#define HBIL_API extern
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Result of every call that can fail. This list makes the enum and the names. */
#define HBIL_RESULTS(X)                                             \
    X(OK,       "success")                                          \
    X(E_ARG,    "null pointer or index out of range")               \
    X(E_CONFIG, "config rejected, see the diagnostics")             \
    X(E_FRAME,  "frame does not fit the plan, see the diagnostics") \
    X(E_SPACE,  "buffer too small, *need tells the size")           \
    X(E_HOOK,   "the pass needs your hook text, or it lacks the function")
#define HBIL__RESULT_ENUM(name, text) HBIL_##name,
typedef enum hbil_result { HBIL_RESULTS(HBIL__RESULT_ENUM) HBIL_RESULT_COUNT } hbil_result;

/* <<gen enums      written by `cmake --build build --target embed` from the tables: do not edit */
typedef enum hbil_target { HBIL_TARGET_VULKAN = 1, HBIL_TARGET_GL, HBIL_TARGET_GLES } hbil_target;
typedef enum hbil_stage { HBIL_STAGE_COMPUTE = 1, HBIL_STAGE_FRAGMENT } hbil_stage;
typedef enum hbil_outputs { HBIL_OUTPUTS_AO = 0x1, HBIL_OUTPUTS_UNIFORM_AO = 0x2, HBIL_OUTPUTS_BENT = 0x4, HBIL_OUTPUTS_CONE = 0x8,
    HBIL_OUTPUTS_NEAR = 0x10, HBIL_OUTPUTS_SH = 0x20, HBIL_OUTPUTS_FAR = 0x40, HBIL_OUTPUTS_IRRADIANCE = 0x80,
    HBIL_OUTPUTS_SPECULAR_OCCLUSION = 0x100, HBIL_OUTPUTS_MULTI_BOUNCE = 0x200, HBIL_OUTPUTS_COMPOSITE = 0x400 } hbil_outputs;
typedef enum hbil_estimator { HBIL_ESTIMATOR_HORIZON = 1, HBIL_ESTIMATOR_BITMASK, HBIL_ESTIMATOR_HBAO, HBIL_ESTIMATOR_HBAO_PLUS } hbil_estimator;
typedef enum hbil_march { HBIL_MARCH_SAMPLED = 1, HBIL_MARCH_SWEEP, HBIL_MARCH_BOTH } hbil_march;
typedef enum hbil_sampling { HBIL_SAMPLING_NEAREST = 1, HBIL_SAMPLING_BILINEAR } hbil_sampling;
typedef enum hbil_spacing { HBIL_SPACING_POWER = 1, HBIL_SPACING_GEOMETRIC } hbil_spacing;
typedef enum hbil_attenuation { HBIL_ATTENUATION_QUADRATIC = 1, HBIL_ATTENUATION_LINEAR } hbil_attenuation;
typedef enum hbil_occluder { HBIL_OCCLUDER_HEIGHT_FIELD = 1, HBIL_OCCLUDER_THICK, HBIL_OCCLUDER_HEURISTIC } hbil_occluder;
typedef enum hbil_noise { HBIL_NOISE_NONE = 1, HBIL_NOISE_IGN, HBIL_NOISE_HILBERT_R2 } hbil_noise;
typedef enum hbil_mips { HBIL_MIPS_NONE = 1, HBIL_MIPS_MEAN, HBIL_MIPS_SPREAD, HBIL_MIPS_WEIGHTED,
    HBIL_MIPS_NEAREST } hbil_mips;
typedef enum hbil_interleave { HBIL_INTERLEAVE_NO = 1, HBIL_INTERLEAVE_YES } hbil_interleave;
typedef enum hbil_gather { HBIL_GATHER_RISE = 1, HBIL_GATHER_PACKED, HBIL_GATHER_SIDE } hbil_gather;
typedef enum hbil_filter { HBIL_FILTER_NONE = 1, HBIL_FILTER_3X3, HBIL_FILTER_5X5 } hbil_filter;
typedef enum hbil_temporal { HBIL_TEMPORAL_NO = 1, HBIL_TEMPORAL_YES } hbil_temporal;
typedef enum hbil_rectify { HBIL_RECTIFY_VARIANCE = 1, HBIL_RECTIFY_RANGE, HBIL_RECTIFY_NONE } hbil_rectify;
typedef enum hbil_bounces { HBIL_BOUNCES_ONE = 1, HBIL_BOUNCES_RECURSIVE } hbil_bounces;
typedef enum hbil_reproject { HBIL_REPROJECT_CAMERA = 1, HBIL_REPROJECT_GATHER, HBIL_REPROJECT_SCATTER } hbil_reproject;
typedef enum hbil_arithmetic { HBIL_ARITHMETIC_FULL = 1, HBIL_ARITHMETIC_HALF } hbil_arithmetic;
typedef enum hbil_facing { HBIL_FACING_NONE = 1, HBIL_FACING_FILTER, HBIL_FACING_HALF_SPACE } hbil_facing;
typedef enum hbil_environment { HBIL_ENVIRONMENT_NONE = 1, HBIL_ENVIRONMENT_CONSTANT, HBIL_ENVIRONMENT_SH, HBIL_ENVIRONMENT_CUBE,
    HBIL_ENVIRONMENT_PROBES, HBIL_ENVIRONMENT_HOOK } hbil_environment;
typedef enum hbil_far_visibility { HBIL_FAR_VISIBILITY_BENT = 1, HBIL_FAR_VISIBILITY_AO, HBIL_FAR_VISIBILITY_DIRECTION, HBIL_FAR_VISIBILITY_CONE,
    HBIL_FAR_VISIBILITY_FREE_BITS } hbil_far_visibility;
typedef enum hbil_f0 { HBIL_F0_NONE = 1, HBIL_F0_SCALAR, HBIL_F0_RGB } hbil_f0;
typedef enum hbil_bounce { HBIL_BOUNCE_CLOSED = 1, HBIL_BOUNCE_CUBIC } hbil_bounce;
typedef enum hbil_projection { HBIL_PROJECTION_PERSPECTIVE = 1, HBIL_PROJECTION_ORTHOGRAPHIC } hbil_projection;
typedef enum hbil_depth { HBIL_DEPTH_LINEAR = 1, HBIL_DEPTH_DEVICE } hbil_depth;
typedef enum hbil_depth_direction { HBIL_DEPTH_DIRECTION_FORWARD = 1, HBIL_DEPTH_DIRECTION_REVERSED } hbil_depth_direction;
typedef enum hbil_depth_far { HBIL_DEPTH_FAR_FINITE = 1, HBIL_DEPTH_FAR_INFINITE } hbil_depth_far;
typedef enum hbil_clip { HBIL_CLIP_VULKAN = 1, HBIL_CLIP_GL } hbil_clip;
typedef enum hbil_normals { HBIL_NORMALS_VIEW = 1, HBIL_NORMALS_WORLD, HBIL_NORMALS_DEPTH } hbil_normals;
typedef enum hbil_normal_encoding { HBIL_NORMAL_ENCODING_XYZ = 1, HBIL_NORMAL_ENCODING_XYZ_UNORM, HBIL_NORMAL_ENCODING_OCTAHEDRAL, HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM,
    HBIL_NORMAL_ENCODING_OCTAHEDRAL_888, HBIL_NORMAL_ENCODING_XY, HBIL_NORMAL_ENCODING_XY_UNORM } hbil_normal_encoding;
typedef enum hbil_multisample { HBIL_MULTISAMPLE_NO = 1, HBIL_MULTISAMPLE_YES } hbil_multisample;
typedef enum hbil_seed_compat { HBIL_SEED_COMPAT_SCREEN_AZIMUTH = 0x1, HBIL_SEED_COMPAT_SLICE_MEAN = 0x2, HBIL_SEED_COMPAT_NOISE_2PI = 0x4, HBIL_SEED_COMPAT_UNIFORM_BENT = 0x8,
    HBIL_SEED_COMPAT_CONE_RELATION = 0x10, HBIL_SEED_COMPAT_F0_AO = 0x20 } hbil_seed_compat;
typedef enum hbil_storage { HBIL_STORAGE_FULL = 1, HBIL_STORAGE_HALF } hbil_storage;
typedef enum hbil_dynamic { HBIL_DYNAMIC_SLICES = 0x1, HBIL_DYNAMIC_STEPS = 0x2, HBIL_DYNAMIC_EXPONENT = 0x4, HBIL_DYNAMIC_REACH = 0x8,
    HBIL_DYNAMIC_FALLOFF = 0x10, HBIL_DYNAMIC_THICKNESS = 0x20, HBIL_DYNAMIC_DECAY = 0x40, HBIL_DYNAMIC_BIAS = 0x80,
    HBIL_DYNAMIC_ANGLE_BIAS = 0x100, HBIL_DYNAMIC_MULTIPLIER = 0x200, HBIL_DYNAMIC_PULL = 0x400, HBIL_DYNAMIC_HISTORY = 0x800,
    HBIL_DYNAMIC_FIREFLY = 0x1000, HBIL_DYNAMIC_NEAR_INTENSITY = 0x2000, HBIL_DYNAMIC_FAR_INTENSITY = 0x4000, HBIL_DYNAMIC_AO_EXPONENT = 0x8000,
    HBIL_DYNAMIC_ROUGHNESS = 0x10000, HBIL_DYNAMIC_SKY_DEPTH = 0x20000 } hbil_dynamic;
typedef enum hbil_format { HBIL_FORMAT_ANY = 1, HBIL_FORMAT_R32F, HBIL_FORMAT_R32UI, HBIL_FORMAT_RGBA32F, HBIL_FORMAT_RGBA16F, HBIL_FORMAT_COUNT } hbil_format;
/* >>gen enums */

/* How a pass touches a texture. SAMPLE: texelFetch through a sampler. WRITE: image store, never read in that pass but
 * for HBIL_ROLE_UPDATE. */
typedef enum hbil_access { HBIL_ACCESS_SAMPLE = 1, HBIL_ACCESS_WRITE = 2 } hbil_access;
/* What the text calls a binding: SAMPLE, WRITE: u_<texture>. UPDATE: that too; written, and read by imageLoad or atomics in the same
 * pass. LAST: u_last_<texture>, sampled, age 1. FROM: u_from, sampled. TO: u_to, written. */
typedef enum hbil_role { HBIL_ROLE_SAMPLE = 1, HBIL_ROLE_WRITE, HBIL_ROLE_UPDATE, HBIL_ROLE_LAST, HBIL_ROLE_FROM,
                         HBIL_ROLE_TO, HBIL_ROLE_COUNT } hbil_role;
/* Whose a texture is. INPUT, OUTPUT: yours. TRANSIENT: garbage between frames, may alias. HISTORY: survives frames. */
typedef enum hbil_life { HBIL_LIFE_INPUT = 1, HBIL_LIFE_OUTPUT, HBIL_LIFE_TRANSIENT, HBIL_LIFE_HISTORY } hbil_life;
/* Type of a member of the uniform block. MAT3 is three vec4 columns (std140); VEC4X3 to VEC4X5 are arrays of vec4. */
typedef enum hbil_type { HBIL_TYPE_INT = 1, HBIL_TYPE_UINT, HBIL_TYPE_FLOAT, HBIL_TYPE_VEC2, HBIL_TYPE_IVEC2,
                         HBIL_TYPE_VEC4, HBIL_TYPE_MAT3, HBIL_TYPE_VEC4X3, HBIL_TYPE_VEC4X4, HBIL_TYPE_VEC4X5 } hbil_type;
/* Shape of a texture. 2D_ARRAY has `layers` layers. CUBE and 3D are read with a linear, clamping sampler at level 0, all others by
 * texelFetch. */
typedef enum hbil_dim { HBIL_DIM_2D = 1, HBIL_DIM_2D_MULTISAMPLE, HBIL_DIM_2D_ARRAY, HBIL_DIM_CUBE, HBIL_DIM_3D } hbil_dim;
/* What the grid of a pass covers. PIXELS: the texels of its domain. LINES: x the longer side of the domain (rounded up to whole
 * strides of a sweep), y its layers. */
typedef enum hbil_grid { HBIL_GRID_PIXELS = 1, HBIL_GRID_LINES } hbil_grid;
typedef enum hbil_kind { HBIL_KIND_CHOICE = 1, HBIL_KIND_SET, HBIL_KIND_INT, HBIL_KIND_FLOAT } hbil_kind;
typedef enum hbil_severity { HBIL_NOTE = 1, HBIL_WARNING, HBIL_ERROR } hbil_severity;

/* What you want. Zero every member, then set what you care about: 0 always means "the default".
 * C: hbil_config c = {0};   C++: hbil_config c = {}; */
typedef struct hbil_config {
    uint32_t guard;         /* leave 0: catches a struct that was not cleared */
    /* <<gen config     written by `cmake --build build --target embed` from the tables: do not edit */
    /* dialect of the emitted text: GLSL 450 for Vulkan, GLSL 430 core for OpenGL, ESSL 310 for OpenGL ES. {vulkan, gl, gles}, default vulkan. baked. source: project */
    int32_t target;
    /* compute shaders; or fragment shaders that draw a triangle over each target, where there are none: GLSL 330 core, ESSL 300. {compute, fragment}, default compute. baked. source: project */
    int32_t stage;
    /* what is computed, all from one march; each is defined under >>outputs in hbil.h. {ao, uniform_ao, bent, cone, near, sh, far, irradiance, specular_occlusion, multi_bounce, composite}, default ao+near+composite. baked. source: project */
    uint32_t outputs;
    /* how a slice sees: highest horizon per side; 32 sectors of equal cosine energy; sin h - sin t; share of raised samples. {horizon, bitmask, hbao, hbao_plus}, default horizon. baked. source: Jimenez 2016, Therrien 2023, Bavoil 2008, NVIDIA HBAO+ */
    int32_t estimator;
    /* where horizons are looked for: samples along each slice; every pixel of it, by one walk along each screen line; samples up to `reach` and the sweep beyond. {sampled, sweep, both}, default sampled. baked. source: project, Timonen 2013 */
    int32_t march;
    /* two-sided slices per pixel, uniform around the local view vector; those of a sweep on the screen, weighted. count, [1, 64], default 3. baked or dynamic. source: Mayaux 2018 sec. 1.2 */
    int32_t slices;
    /* directions that share a slice of the sweep: neighbouring lines take turns, at the price of one; for the filter to gather. count, [1, 8], default 1. baked. source: project */
    int32_t sweep_stride;
    /* depth samples per side of a slice. count, [1, 1024], default 6. baked or dynamic. source: Mayaux 2018 sec. 3.5 */
    int32_t steps;
    /* surface that the samples see: nearest pixel centre, or exactly on the slice, bilinear between four centres. {nearest, bilinear}, default nearest. baked. source: project */
    int32_t sampling;
    /* distances of the samples: 1 + t^exponent (R - 1) pixels, or R^t. {power, geometric}, default power. baked. source: measured on frames */
    int32_t spacing;
    /* convergence exponent: how much the samples crowd around the pixel. 1, [1, 8], default 2. baked or dynamic. source: YPipeline HBIL article */
    float exponent;
    /* world radius of the search; 0 is the whole screen, ended at its border per side. m, [1e-6, 1e9], default 0. baked or dynamic. source: project */
    float reach;
    /* share of the reach over which an occluder fades out. 1, [0.01, 1], default 0.6. baked or dynamic. source: Jimenez 2016, XeGTAO */
    float falloff;
    /* weight of a sample at distance d: 1 - (d / reach)^2, or 1 - d / reach. {quadratic, linear}, default quadratic. baked. source: Bavoil 2008, HBAO + GTAO article */
    int32_t attenuation;
    /* behind what is seen: solid for ever; solid for `thickness` along the sample's own view ray; horizons that sink again. {height_field, thick, heuristic}, default height_field. baked. source: project, Therrien 2023, Jimenez 2016 */
    int32_t occluder;
    /* how far an occluder goes on behind its visible surface. m, [1e-4, 1e4], default 0.5. baked or dynamic. source: Therrien 2023 */
    float thickness;
    /* share by which the horizon sinks towards each lower sample, at 8 steps; other step counts sink as much per side. 1, [0.001, 0.9], default 0.1. baked or dynamic. source: Jimenez 2016 */
    float decay;
    /* sine of the elevation above the tangent plane below which a sample is ignored. 1, [1e-6, 0.5], default 0.001. baked or dynamic. source: Bavoil 2008 */
    float bias;
    /* sine of the elevation above the tangent plane from which occlusion begins. 1, [1e-6, 0.9], default 0.1. baked or dynamic. source: Bavoil 2008 */
    float angle_bias;
    /* obscurance is 2 * multiplier * the mean of the samples, at most 1. 1, [0.01, 16], default 1. baked or dynamic. source: NVIDIA HBAO+ */
    float multiplier;
    /* part of its depth by which the receiver is pulled towards the camera against rounding. 1, [1e-8, 0.01], default 1e-5. baked or dynamic. source: XeGTAO */
    float pull;
    /* rotation of the slices and jitter of the steps: none, interleaved gradient, Hilbert curve + R2. {none, ign, hilbert_r2}, default hilbert_r2. baked. source: Jimenez 2014, Roberts 2018 */
    int32_t noise;
    /* far samples read coarser depth: not; mean nearness; that plus its standard deviation; mean of the nearest surface; nearest pixel. {none, mean, spread, weighted, nearest}, default none. baked. source: XeGTAO, McGuire 2012 */
    int32_t mips;
    /* one noise for each place in blocks of 4x4 pixels, and pixels of equal noise side by side in a wave. {no, yes}, default no. baked. source: Mayaux 2018 sec. 3.3 */
    int32_t interleave;
    /* radiance is read at each rise; the same, packed to 32 bits; once per side, where its horizon is, packed. {rise, packed, side}, default rise. baked. source: project */
    int32_t gather;
    /* mean over the neighbours on the same surface: near the tangent plane and of like normal. {none, 3x3, 5x5}, default none. baked. source: project */
    int32_t filter;
    /* passes of the filter, a-trous: each with gaps twice as wide as the one before. count, [1, 3], default 1. baked. source: Dammertz 2010 */
    int32_t filter_passes;
    /* running mean with the frames before, where the same surface was seen. {no, yes}, default no. baked. source: project, Schied 2017 */
    int32_t temporal;
    /* frames that the running mean remembers, at most. frames, [2, 63], default 16. baked or dynamic. source: DiligentFX */
    int32_t history;
    /* history is held to what this frame sees in 3x3 pixels: mean and deviation; least and greatest value; not. {variance, range, none}, default variance. baked. source: Salvi 2016, Karis 2014 */
    int32_t rectify;
    /* near light is of u_radiance; or also of what the surfaces reflected of last frame's near and far light. {one, recursive}, default one. baked. source: Mayaux 2018 sec. 3.2 */
    int32_t bounces;
    /* where a pixel was last frame: by both cameras; by u_motion; by last frame's pixels, each projected into this one. {camera, gather, scatter}, default camera. baked. source: YPipeline HBIL article, Mayaux 2018 sec. 3.2 */
    int32_t reproject;
    /* march one pixel for each block of 1, 2x2 or 4x4 pixels, and interpolate on the same surface. 1, [1, 4], default 1. baked. source: project, three-gtvbao */
    int32_t downscale;
    /* what filter and interpolation add up: float, or mediump, which devices with half floats make use of. {full, half}, default full. baked. source: project */
    int32_t arithmetic;
    /* light of surfaces that face away: kept; last accepted radiance kept instead; cut off at the plane of the source. {none, filter, half_space}, default none. baked. source: Mayaux 2018 sec. 3.4, GT-VBGI */
    int32_t facing;
    /* largest channel of a radiance, scaled down with its hue kept; 0 is only the limit of 60000 per channel. radiance, [0.001, 60000], default 0. baked or dynamic. source: SSRT3 */
    float firefly;
    /* factor of near light; other than 1 is taste, not physics. 1, [0.01, 100], default 1. baked or dynamic. source: YPipeline HBIL article */
    float near_intensity;
    /* environment behind the visible part: none, one colour, spherical harmonics, cube map, grid of SH probes, your own function. {none, constant, sh, cube, probes, hook}, default none. baked. source: Mayaux 2018 sec. 2.2, YPipeline HBIL article */
    int32_t environment;
    /* highest order of the spherical harmonics: 4 or 9 coefficients. order, [1, 2], default 2. baked. source: Ramamoorthi 2001 */
    int32_t sh_order;
    /* what lets the environment in: bent vector, ao at the normal, ao at the bent direction, bent cone, or sector by sector. {bent, ao, direction, cone, free_bits}, default bent. baked. source: project */
    int32_t far_visibility;
    /* factor of far light; other than 1 is taste, not physics. 1, [0.01, 100], default 1. baked or dynamic. source: YPipeline HBIL article */
    float far_intensity;
    /* factor 1 - F0 of near and far light: none, from the red channel or per channel of u_f0. metals get none. {none, scalar, rgb}, default none. baked. source: Mayaux 2018 sec. 2.3.3 */
    int32_t f0;
    /* power of ao, and so of bent and far light by it; other than 1 is taste, not physics. 1, [0.1, 8], default 1. baked or dynamic. source: YPipeline HBIL article */
    float ao_exponent;
    /* multi-bounce ao of albedo r and visibility v: v / (1 - r (1 - v)), or the cubic fit. {closed, cubic}, default closed. baked. source: project, Jimenez 2016 */
    int32_t bounce;
    /* roughness of every surface; 0 reads it from u_roughness. perceptual, [0.02, 1], default 0. baked or dynamic. source: Jimenez 2016 */
    float roughness;
    /* camera; off-centre and jittered matrices are fine. {perspective, orthographic}, default perspective. baked. source: project */
    int32_t projection;
    /* depth input: view depth in metres, or the depth buffer's value in [0, 1]. {linear, device}, default linear. baked. source: project */
    int32_t depth;
    /* linear depth from which on a pixel is sky. m, [1e-3, 1e15], default 1e9. baked or dynamic. source: project */
    float sky_depth;
    /* depth buffer value of the far end: 1 (forward) or 0 (reversed-Z). {forward, reversed}, default forward. baked. source: project */
    int32_t depth_direction;
    /* far plane of the projection matrix. {finite, infinite}, default finite. baked. source: project */
    int32_t depth_far;
    /* range of the projection's ndc z: [0, 1] (Vulkan, Direct3D, glClipControl) or [-1, 1] (GL). {vulkan, gl}, default vulkan. baked. source: project */
    int32_t clip;
    /* normal input: in view space, in world space, or none: rebuilt from depth. {view, world, depth}, default view. baked. source: project */
    int32_t normals;
    /* channels of u_normal: xyz, octahedral xy, or xy of a normal that faces the camera; signed or [0, 1]; 888 is two 12-bit halves. {xyz, xyz_unorm, octahedral, octahedral_unorm, octahedral_888, xy, xy_unorm}, default xyz. baked. source: Meyer 2010, Mayaux 2018 sec. 3.1 */
    int32_t normal_encoding;
    /* u_depth and u_normal are multisampled textures, of which one sample is read. {no, yes}, default no. baked. source: project */
    int32_t multisample;
    /* sample that is read of a multisampled texture. index, [1, 31], default 0. baked. source: project */
    int32_t sample;
    /* render width baked into the text; 0 keeps the size a uniform. pixels, [1, 16384], default 0. baked. source: project */
    int32_t width;
    /* render height baked into the text, together with width. pixels, [1, 16384], default 0. baked. source: project */
    int32_t height;
    /* arithmetic of older articles: slices uniform on the screen; mean, no ratio; noise * 2 pi; bent vector without the cosine; cos aperture = 1 - ao; F0(ao). {screen_azimuth, slice_mean, noise_2pi, uniform_bent, cone_relation, f0_ao}, default none. baked. source: YPipeline HBIL article, Mayaux 2018 */
    uint32_t seed_compat;
    /* numbers between march, filters and frames: rgba32f, or rgba16f; ao alone is r32f. {full, half}, default full. baked. source: project */
    int32_t storage;
    /* options kept as uniforms that may change from frame to frame; all others are literals in the text. {slices, steps, exponent, reach, falloff, thickness, decay, bias, angle_bias, multiplier, pull, history, firefly, near_intensity, far_intensity, ao_exponent, roughness, sky_depth}, default none. baked. source: project */
    uint32_t dynamic;
    /* >>gen config */
    uint32_t guard_end;     /* leave 0 */
} hbil_config;

/* One row of the option table, for UIs, docs and command lines. All text is static. */
typedef struct hbil_option {
    const char *name, *unit, *choices /* blank-separated */, *applies /* "" or expression */, *meaning, *source;
    hbil_kind   kind;
    uint32_t    dynamic;    /* its HBIL_DYNAMIC_ bit; 0: always baked */
    uint32_t    offset;     /* of the 4-byte member in hbil_config: int32_t CHOICE, INT; uint32_t SET; float FLOAT */
    double      min, max, def;
} hbil_option;

/* One finding about a config or a frame. */
typedef struct hbil_diag {
    hbil_severity severity;
    int32_t       option;   /* index for hbil_option_at, -1: none */
    char          text[200]; /* names the option, its value and the legal range; terminated */
} hbil_diag;

/* Collects findings. The memory is yours; a NULL hbil_diags is fine wherever one is a parameter. */
typedef struct hbil_diags {
    hbil_diag *items;
    int32_t    capacity;
    int32_t    count;       /* findings made; may exceed capacity: the surplus is only counted. Calls add to it */
} hbil_diags;

#define HBIL_MAX_TEXTURES  32
#define HBIL_MAX_PASSES    16
#define HBIL_MAX_BINDINGS  18
#define HBIL_MAX_CONSTANTS 32
#define HBIL_GLSL_MAX      65536 /* bytes of the text of one pass, at most */
#define HBIL_CONSTANTS_MAX 1024  /* bytes of the uniform block, at most */

typedef struct hbil_texture {
    char     name[20];      /* lower snake; the text calls it u_<name> */
    uint16_t format;        /* hbil_format */
    uint16_t life;          /* hbil_life */
    uint16_t div;           /* size = ceil(render size / div) */
    uint16_t mips;          /* >= 1 */
    uint16_t copies;        /* 1; more for HISTORY: in your n-th frame copy (n + copies - age) mod copies */
    uint16_t dim;           /* hbil_dim. CUBE and 3D have a size of your own */
    uint16_t layers;        /* 1; more for 2D_ARRAY */
    uint16_t reserved;
} hbil_texture;

typedef struct hbil_binding {
    uint16_t texture;       /* index into plan.textures */
    uint16_t slot;          /* Vulkan: binding in set 0. GL: texture unit (SAMPLE), image unit (WRITE) or, with stage=fragment,
                               location of a WRITE, as many as it has layers; samplers and block then go by their names */
    uint8_t  access;        /* hbil_access */
    uint8_t  age;           /* 0: this frame's copy, 1: last frame's */
    uint8_t  mip;           /* level written */
    uint8_t  role;          /* hbil_role */
} hbil_binding;

/* Before this pass: earlier accesses of `before` kind to the texture must be finished and visible to `after`.
 * Derived from the bindings, over frames too (a transient is written again while last frame may still read it).
 * Your own textures: barriers inside the plan only; before and after it they are yours to synchronise. */
typedef struct hbil_barrier {
    uint16_t texture;
    uint8_t  before, after; /* hbil_access */
} hbil_barrier;

typedef struct hbil_pass {
    char         name[20];  /* lower snake: file stem, debug label, --pass */
    uint16_t     group[2];  /* workgroup size in x and y, as in the text */
    uint16_t     domain;    /* texture that the grid covers, see grid */
    uint16_t     constants; /* 1: the pass reads the uniform block, at plan.constants_slot */
    uint16_t     hook;      /* 1: the text needs your function, see hbil_emit_glsl_hook */
    uint16_t     grid;      /* hbil_grid */
    uint16_t     binding_count, barrier_count;
    hbil_binding bindings[HBIL_MAX_BINDINGS];
    hbil_barrier barriers[HBIL_MAX_BINDINGS];
} hbil_pass;

/* One member of the uniform block (std140), for engines that fill it themselves and for reflection. */
typedef struct hbil_constant {
    char     name[24];      /* as in the text */
    uint16_t offset;        /* bytes */
    uint16_t type;          /* hbil_type */
    int32_t  option;        /* index of the dynamic option, or -1 */
} hbil_constant;

/* What to make and what to dispatch: plain data, no pointers. Equal configs give memcmp-equal plans: padding is zero. */
typedef struct hbil_plan {
    hbil_config   config;   /* resolved: every member explicit */
    uint64_t      hash;     /* of the version and the canonical config text: equal hash, equal bytes of text */
    uint32_t      constants_size; /* bytes of the uniform block; 0: none */
    uint32_t      constants_slot; /* its binding */
    uint32_t      pass_count, texture_count, constant_count;
    uint32_t      reserved;
    hbil_texture  textures[HBIL_MAX_TEXTURES];
    hbil_pass     passes[HBIL_MAX_PASSES];       /* in execution order */
    hbil_constant constants[HBIL_MAX_CONSTANTS]; /* in memory order */
} hbil_plan;

/* One frame: what changes from frame to frame. Zero it first. */
typedef struct hbil_frame {
    uint32_t guard;         /* leave 0 */
    uint32_t width, height; /* render size in pixels, [1, 16384]; 0 where the config bakes it */
    uint32_t index;         /* frame number: advances the noise */
    float    projection[16];/* view -> clip, column-major, jitter included. Texel row 0 is ndc y = -1 */
    float    view[16];      /* world -> view, column-major, rigid. Read with normals=world, where far light has a direction, and where history is read */
    float    far_color[3];  /* environment=constant: radiance */
    float    far_sh[9][3];  /* environment=sh: radiance by [l*l+l+m], world space. Y00 .282095, Y1-1 Y10 Y11 .488603 y z x,
                               Y2-2 Y2-1 Y21 1.092548 xy yz xz, Y20 .315392 (3zz-1), Y22 .546274 (xx-yy). order 1 reads four */
    float    probe_origin[3], probe_step[3]; /* environment=probes: probe (i, j, k) stands at origin + step * (i, j, k). m, world */
    float    last_projection[16], last_view[16]; /* projection and view of the last frame. Read with bounces=recursive, temporal=yes */
    uint32_t last_width, last_height; /* its render size; 0: as now */
    uint32_t reset;         /* 1: there is no last frame, or it shows something else: the first one, a camera cut */
    const hbil_config *live;/* NULL, or where to read the options that are dynamic; others are ignored. 0: as in the plan */
} hbil_frame;

/* Workgroups; with stage=fragment the pixels of the viewport that a pass draws. */
typedef struct hbil_dispatch { uint32_t groups[3]; } hbil_dispatch;

/* No function below allocates, prints, or touches files, locale or global state; all of them may run at the same time
 * on different outputs. Pointers must not be NULL unless said so. On HBIL_E_ARG outputs are left as they were.
 * buf/cap/need: text functions write at most cap bytes, always terminated if cap > 0, and set *need (may be NULL) to the
 * bytes that the whole text takes, terminator included. buf may be NULL if cap is 0. Too small: HBIL_E_SPACE. */

/* HBIL_VERSION of the implementation; compare with the macro to detect a mixed build. */
HBIL_API uint32_t    hbil_version(void);
/* Static text, never NULL: "unknown" outside the enum. */
HBIL_API const char *hbil_result_name(hbil_result result);
/* The GLSL layout qualifier, "rgba32f"; "any" for HBIL_FORMAT_ANY. */
HBIL_API const char *hbil_format_name(hbil_format format);
/* Bytes per texel; 0 for HBIL_FORMAT_ANY and outside the enum. */
HBIL_API uint32_t    hbil_format_bytes(hbil_format format);

/* The option table. index in [0, hbil_option_count()); NULL outside. */
HBIL_API int32_t            hbil_option_count(void);
HBIL_API const hbil_option *hbil_option_at(int32_t index);
/* Index by name (len bytes), -1 if there is none. *nearest (may be NULL) gets the most similar name's index. */
HBIL_API int32_t            hbil_option_find(const char *name, size_t len, int32_t *nearest);

/* Presets by index, for lists: name and meaning, NULL outside. */
HBIL_API const char *hbil_preset_name(int32_t index);
HBIL_API const char *hbil_preset_meaning(int32_t index);
/* Where its values come from: a line "option=value: source" each. NULL outside. */
HBIL_API const char *hbil_preset_sources(int32_t index);
/* Fill *out with a preset by name; members may be changed afterwards. E_CONFIG: no such preset. */
HBIL_API hbil_result hbil_config_preset(const char *name, hbil_config *out, hbil_diags *diags);
/* Set one option from text: ("reach", "2.5"), ("outputs", "ao+near"), ("slices", "default"). The decimal mark is '.'
 * under any locale. E_CONFIG: unknown name, or a value that does not parse or is out of range; *config is unchanged. */
HBIL_API hbil_result hbil_config_set(hbil_config *config, const char *name, const char *value, hbil_diags *diags);
/* Read name=value pairs, separated by blanks, commas or line ends; # starts a comment. Sets what is right and reports
 * every fault, with its line if there are several. E_CONFIG */
HBIL_API hbil_result hbil_config_parse(hbil_config *config, const char *text, size_t len, hbil_diags *diags);
/* Replace zeros by defaults, check ranges and combinations, reset options that have no effect. Collects every fault
 * before it returns. in may equal out. Idempotent. E_CONFIG */
HBIL_API hbil_result hbil_config_resolve(const hbil_config *in, hbil_config *out, hbil_diags *diags);
/* Canonical text: table order, only what differs from the default, blank-separated, shortest numbers that read back
 * equal. Every option if all != 0. parse(print(c)) resolves to resolve(c). E_SPACE */
HBIL_API hbil_result hbil_config_print(const hbil_config *config, int all, char *buf, size_t cap, size_t *need);
/* Hash of version and canonical text of the resolved config; 0 if it does not resolve. */
HBIL_API uint64_t    hbil_config_hash(const hbil_config *config);

/* Build passes, textures and uniform block. *out is written whole, so plans compare with memcmp. E_CONFIG */
HBIL_API hbil_result hbil_plan_build(const hbil_config *config, hbil_plan *out, hbil_diags *diags);
/* May a plan that was edited, stored or sent be followed: is each count, index and number of it inside its table? E_ARG if not; diags
 * name the place. emit_*, pack_constants and the backends refuse other plans; hbil_null.h proves that a plan is right, too. */
HBIL_API hbil_result hbil_plan_check(const hbil_plan *plan, hbil_diags *diags);
/* Index of a texture or pass by name, -1 if the plan has none. */
HBIL_API int32_t     hbil_plan_texture(const hbil_plan *plan, const char *name);
HBIL_API int32_t     hbil_plan_pass(const hbil_plan *plan, const char *name);
/* Number of a binding among those of its pass with the same access: the register t (SAMPLE) or u (WRITE) of HLSL, and what target=gl
 * calls its unit. The uniform block is b0. MSL: texture(i) for the i-th binding, buffer(0). Samplers, of CUBE and 3D: s and sampler()
 * with the number of their t. -1 outside. */
HBIL_API int32_t     hbil_plan_register(const hbil_plan *plan, int32_t pass, int32_t binding);
/* Size in texels of mip 0 at render size width x height, each in [1, 16384]. */
HBIL_API hbil_result hbil_plan_extent(const hbil_plan *plan, int32_t texture, uint32_t width, uint32_t height, uint32_t out[2]);
/* Bytes of TRANSIENT and HISTORY textures without aliasing; 0 on a bad argument. */
HBIL_API uint64_t    hbil_plan_memory(const hbil_plan *plan, uint32_t width, uint32_t height);
/* Group counts of this frame; out has plan->pass_count entries. */
HBIL_API hbil_result hbil_plan_frame(const hbil_plan *plan, const hbil_frame *frame, hbil_dispatch *out);

/* The GLSL of one pass. Same config, same bytes: on every platform, compiler and locale. E_SPACE */
HBIL_API hbil_result hbil_emit_glsl(const hbil_plan *plan, int32_t pass, char *buf, size_t cap, size_t *need);
/* The same for a pass with .hook = 1 (environment=hook): hook is your GLSL text, terminated, that defines
 *     vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture)
 * position: of the surface, world, m. direction: unit, world, into the middle of the visible part. cos_aperture: cosine of the half
 * angle of the visible cone, 1 with free_bits. Returns what an open surface that faces there would get, as E/pi; with far_visibility=free_bits the
 * radiance from there. It may declare what it needs (bindings in set 1), but no name that begins with hbil_, HBIL_ or u_. Errors of
 * the compiler point into it as source 1. E_HOOK: no such function, #version or main in it, something left open; diags say which.
 * The text is longer than HBIL_GLSL_MAX by that of the hook, and the plan's hash does not know it. */
HBIL_API hbil_result hbil_emit_glsl_hook(const hbil_plan *plan, int32_t pass, const char *hook, char *buf, size_t cap,
                                         size_t *need, hbil_diags *diags);
/* stage=fragment: the vertex shader of all its passes. Draw three vertices without attributes. E_ARG: no such stage. E_SPACE */
HBIL_API hbil_result hbil_emit_vertex(const hbil_plan *plan, char *buf, size_t cap, size_t *need);
/* JSON description of the plan, for engines not written in C. E_SPACE */
HBIL_API hbil_result hbil_emit_manifest(const hbil_plan *plan, char *buf, size_t cap, size_t *need);
/* The uniform block of this frame, laid out as plan->constants says. Checks the frame against the config. *need gets
 * plan->constants_size. E_FRAME, E_SPACE */
HBIL_API hbil_result hbil_pack_constants(const hbil_plan *plan, const hbil_frame *frame, void *buf, size_t cap,
                                         size_t *need, hbil_diags *diags);

#ifdef __cplusplus
}
#endif
#endif /* HBIL_H */

/* ==================================================================================================================
 *                                    API READERS MAY STOP HERE
 * ================================================================================================================== */

#ifdef HBIL_IMPLEMENTATION
#ifndef HBIL_IMPLEMENTED
#define HBIL_IMPLEMENTED

#include <string.h>

/* ======================================================================
 * >>tables     options, formats, textures, passes, bindings, uniforms
 * ====================================================================== */

#define HBIL__COUNT(a) ((int32_t)(sizeof(a) / sizeof((a)[0])))

/* <<gen options    written by `cmake --build build --target embed` from the tables: do not edit */
static const hbil_option hbil__options[] = {
    { "target", "", "vulkan gl gles",
      "",
      "dialect of the emitted text: GLSL 450 for Vulkan, GLSL 430 core for OpenGL, ESSL 310 for OpenGL ES",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, target), 1, 3, 1 },
    { "stage", "", "compute fragment",
      "",
      "compute shaders; or fragment shaders that draw a triangle over each target, where there are none: GLSL 330 core, ESSL 300",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, stage), 1, 2, 1 },
    { "outputs", "", "ao uniform_ao bent cone near sh far irradiance specular_occlusion multi_bounce composite",
      "",
      "what is computed, all from one march; each is defined under >>outputs in hbil.h",
      "project",
      HBIL_KIND_SET, 0, (uint32_t)offsetof(hbil_config, outputs), 0, 2047, 1041 },
    { "estimator", "", "horizon bitmask hbao hbao_plus",
      "",
      "how a slice sees: highest horizon per side; 32 sectors of equal cosine energy; sin h - sin t; share of raised samples",
      "Jimenez 2016, Therrien 2023, Bavoil 2008, NVIDIA HBAO+",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, estimator), 1, 4, 1 },
    { "march", "", "sampled sweep both",
      "",
      "where horizons are looked for: samples along each slice; every pixel of it, by one walk along each screen line; samples up to `reach` and the sweep beyond",
      "project, Timonen 2013",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, march), 1, 3, 1 },
    { "slices", "count", "",
      "",
      "two-sided slices per pixel, uniform around the local view vector; those of a sweep on the screen, weighted",
      "Mayaux 2018 sec. 1.2",
      HBIL_KIND_INT, HBIL_DYNAMIC_SLICES, (uint32_t)offsetof(hbil_config, slices), 1, 64, 3 },
    { "sweep_stride", "count", "",
      "HBIL_SWEPT",
      "directions that share a slice of the sweep: neighbouring lines take turns, at the price of one; for the filter to gather",
      "project",
      HBIL_KIND_INT, 0, (uint32_t)offsetof(hbil_config, sweep_stride), 1, 8, 1 },
    { "steps", "count", "",
      "HBIL_SAMPLED",
      "depth samples per side of a slice",
      "Mayaux 2018 sec. 3.5",
      HBIL_KIND_INT, HBIL_DYNAMIC_STEPS, (uint32_t)offsetof(hbil_config, steps), 1, 1024, 6 },
    { "sampling", "", "nearest bilinear",
      "HBIL_MARCH_SAMPLED",
      "surface that the samples see: nearest pixel centre, or exactly on the slice, bilinear between four centres",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, sampling), 1, 2, 1 },
    { "spacing", "", "power geometric",
      "HBIL_SAMPLED",
      "distances of the samples: 1 + t^exponent (R - 1) pixels, or R^t",
      "measured on frames",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, spacing), 1, 2, 1 },
    { "exponent", "1", "",
      "HBIL_SAMPLED && HBIL_SPACING_POWER",
      "convergence exponent: how much the samples crowd around the pixel",
      "YPipeline HBIL article",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_EXPONENT, (uint32_t)offsetof(hbil_config, exponent), 1, 8, 2 },
    { "reach", "m", "",
      "HBIL_SAMPLED",
      "world radius of the search; 0 is the whole screen, ended at its border per side",
      "project",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_REACH, (uint32_t)offsetof(hbil_config, reach), 1e-6, 1e9, 0 },
    { "falloff", "1", "",
      "HBIL_MARCH_SAMPLED && !HBIL_REACH_0 && HBIL_COSINE",
      "share of the reach over which an occluder fades out",
      "Jimenez 2016, XeGTAO",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_FALLOFF, (uint32_t)offsetof(hbil_config, falloff), 0.01, 1, 0.6 },
    { "attenuation", "", "quadratic linear",
      "!HBIL_REACH_0 && !HBIL_COSINE",
      "weight of a sample at distance d: 1 - (d / reach)^2, or 1 - d / reach",
      "Bavoil 2008, HBAO + GTAO article",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, attenuation), 1, 2, 1 },
    { "occluder", "", "height_field thick heuristic",
      "HBIL_COSINE",
      "behind what is seen: solid for ever; solid for `thickness` along the sample's own view ray; horizons that sink again",
      "project, Therrien 2023, Jimenez 2016",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, occluder), 1, 3, 1 },
    { "thickness", "m", "",
      "HBIL_OCCLUDER_THICK",
      "how far an occluder goes on behind its visible surface",
      "Therrien 2023",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_THICKNESS, (uint32_t)offsetof(hbil_config, thickness), 1e-4, 1e4, 0.5 },
    { "decay", "1", "",
      "HBIL_OCCLUDER_HEURISTIC",
      "share by which the horizon sinks towards each lower sample, at 8 steps; other step counts sink as much per side",
      "Jimenez 2016",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_DECAY, (uint32_t)offsetof(hbil_config, decay), 0.001, 0.9, 0.1 },
    { "bias", "1", "",
      "HBIL_COSINE",
      "sine of the elevation above the tangent plane below which a sample is ignored",
      "Bavoil 2008",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_BIAS, (uint32_t)offsetof(hbil_config, bias), 1e-6, 0.5, 0.001 },
    { "angle_bias", "1", "",
      "!HBIL_COSINE",
      "sine of the elevation above the tangent plane from which occlusion begins",
      "Bavoil 2008",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_ANGLE_BIAS, (uint32_t)offsetof(hbil_config, angle_bias), 1e-6, 0.9, 0.1 },
    { "multiplier", "1", "",
      "HBIL_ESTIMATOR_HBAO_PLUS",
      "obscurance is 2 * multiplier * the mean of the samples, at most 1",
      "NVIDIA HBAO+",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_MULTIPLIER, (uint32_t)offsetof(hbil_config, multiplier), 0.01, 16, 1 },
    { "pull", "1", "",
      "",
      "part of its depth by which the receiver is pulled towards the camera against rounding",
      "XeGTAO",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_PULL, (uint32_t)offsetof(hbil_config, pull), 1e-8, 0.01, 1e-5 },
    { "noise", "", "none ign hilbert_r2",
      "",
      "rotation of the slices and jitter of the steps: none, interleaved gradient, Hilbert curve + R2",
      "Jimenez 2014, Roberts 2018",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, noise), 1, 3, 3 },
    { "mips", "", "none mean spread weighted nearest",
      "HBIL_MARCH_SAMPLED && HBIL_SAMPLING_NEAREST",
      "far samples read coarser depth: not; mean nearness; that plus its standard deviation; mean of the nearest surface; nearest pixel",
      "XeGTAO, McGuire 2012",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, mips), 1, 5, 1 },
    { "interleave", "", "no yes",
      "HBIL_MARCH_SAMPLED && !HBIL_NOISE_NONE",
      "one noise for each place in blocks of 4x4 pixels, and pixels of equal noise side by side in a wave",
      "Mayaux 2018 sec. 3.3",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, interleave), 1, 2, 1 },
    { "gather", "", "rise packed side",
      "HBIL_GATHER && HBIL_MARCH_SAMPLED",
      "radiance is read at each rise; the same, packed to 32 bits; once per side, where its horizon is, packed",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, gather), 1, 3, 1 },
    { "filter", "", "none 3x3 5x5",
      "",
      "mean over the neighbours on the same surface: near the tangent plane and of like normal",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, filter), 1, 3, 1 },
    { "filter_passes", "count", "",
      "!HBIL_FILTER_NONE",
      "passes of the filter, a-trous: each with gaps twice as wide as the one before",
      "Dammertz 2010",
      HBIL_KIND_INT, 0, (uint32_t)offsetof(hbil_config, filter_passes), 1, 3, 1 },
    { "temporal", "", "no yes",
      "",
      "running mean with the frames before, where the same surface was seen",
      "project, Schied 2017",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, temporal), 1, 2, 1 },
    { "history", "frames", "",
      "HBIL_TEMPORAL_YES",
      "frames that the running mean remembers, at most",
      "DiligentFX",
      HBIL_KIND_INT, HBIL_DYNAMIC_HISTORY, (uint32_t)offsetof(hbil_config, history), 2, 63, 16 },
    { "rectify", "", "variance range none",
      "HBIL_TEMPORAL_YES",
      "history is held to what this frame sees in 3x3 pixels: mean and deviation; least and greatest value; not",
      "Salvi 2016, Karis 2014",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, rectify), 1, 3, 1 },
    { "bounces", "", "one recursive",
      "HBIL_NEAR_LIGHT",
      "near light is of u_radiance; or also of what the surfaces reflected of last frame's near and far light",
      "Mayaux 2018 sec. 3.2",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, bounces), 1, 2, 1 },
    { "reproject", "", "camera gather scatter",
      "HBIL_TEMPORAL_YES || HBIL_BOUNCES_RECURSIVE",
      "where a pixel was last frame: by both cameras; by u_motion; by last frame's pixels, each projected into this one",
      "YPipeline HBIL article, Mayaux 2018 sec. 3.2",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, reproject), 1, 3, 1 },
    { "downscale", "1", "",
      "",
      "march one pixel for each block of 1, 2x2 or 4x4 pixels, and interpolate on the same surface",
      "project, three-gtvbao",
      HBIL_KIND_INT, 0, (uint32_t)offsetof(hbil_config, downscale), 1, 4, 1 },
    { "arithmetic", "", "full half",
      "!HBIL_FILTER_NONE || HBIL_COARSE",
      "what filter and interpolation add up: float, or mediump, which devices with half floats make use of",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, arithmetic), 1, 2, 1 },
    { "facing", "", "none filter half_space",
      "HBIL_GATHER",
      "light of surfaces that face away: kept; last accepted radiance kept instead; cut off at the plane of the source",
      "Mayaux 2018 sec. 3.4, GT-VBGI",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, facing), 1, 3, 1 },
    { "firefly", "radiance", "",
      "HBIL_GATHER",
      "largest channel of a radiance, scaled down with its hue kept; 0 is only the limit of 60000 per channel",
      "SSRT3",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_FIREFLY, (uint32_t)offsetof(hbil_config, firefly), 0.001, 60000, 0 },
    { "near_intensity", "1", "",
      "HBIL_GATHER",
      "factor of near light; other than 1 is taste, not physics",
      "YPipeline HBIL article",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_NEAR_INTENSITY, (uint32_t)offsetof(hbil_config, near_intensity), 0.01, 100, 1 },
    { "environment", "", "none constant sh cube probes hook",
      "HBIL_OUTPUTS_FAR || HBIL_OUTPUTS_IRRADIANCE || HBIL_OUTPUTS_COMPOSITE",
      "environment behind the visible part: none, one colour, spherical harmonics, cube map, grid of SH probes, your own function",
      "Mayaux 2018 sec. 2.2, YPipeline HBIL article",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, environment), 1, 6, 1 },
    { "sh_order", "order", "",
      "HBIL_ENVIRONMENT_SH || HBIL_ENVIRONMENT_PROBES",
      "highest order of the spherical harmonics: 4 or 9 coefficients",
      "Ramamoorthi 2001",
      HBIL_KIND_INT, 0, (uint32_t)offsetof(hbil_config, sh_order), 1, 2, 2 },
    { "far_visibility", "", "bent ao direction cone free_bits",
      "HBIL_FAR_LIGHT && !HBIL_ENVIRONMENT_CONSTANT",
      "what lets the environment in: bent vector, ao at the normal, ao at the bent direction, bent cone, or sector by sector",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, far_visibility), 1, 5, 1 },
    { "far_intensity", "1", "",
      "HBIL_FAR_LIGHT",
      "factor of far light; other than 1 is taste, not physics",
      "YPipeline HBIL article",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_FAR_INTENSITY, (uint32_t)offsetof(hbil_config, far_intensity), 0.01, 100, 1 },
    { "f0", "", "none scalar rgb",
      "HBIL_NEAR_LIGHT || HBIL_FAR_LIGHT",
      "factor 1 - F0 of near and far light: none, from the red channel or per channel of u_f0. metals get none",
      "Mayaux 2018 sec. 2.3.3",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, f0), 1, 3, 1 },
    { "ao_exponent", "1", "",
      "HBIL_AO || HBIL_BENT",
      "power of ao, and so of bent and far light by it; other than 1 is taste, not physics",
      "YPipeline HBIL article",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_AO_EXPONENT, (uint32_t)offsetof(hbil_config, ao_exponent), 0.1, 8, 1 },
    { "bounce", "", "closed cubic",
      "HBIL_OUTPUTS_MULTI_BOUNCE",
      "multi-bounce ao of albedo r and visibility v: v / (1 - r (1 - v)), or the cubic fit",
      "project, Jimenez 2016",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, bounce), 1, 2, 1 },
    { "roughness", "perceptual", "",
      "HBIL_OUTPUTS_SPECULAR_OCCLUSION",
      "roughness of every surface; 0 reads it from u_roughness",
      "Jimenez 2016",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_ROUGHNESS, (uint32_t)offsetof(hbil_config, roughness), 0.02, 1, 0 },
    { "projection", "", "perspective orthographic",
      "",
      "camera; off-centre and jittered matrices are fine",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, projection), 1, 2, 1 },
    { "depth", "", "linear device",
      "",
      "depth input: view depth in metres, or the depth buffer's value in [0, 1]",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, depth), 1, 2, 1 },
    { "sky_depth", "m", "",
      "HBIL_DEPTH_LINEAR",
      "linear depth from which on a pixel is sky",
      "project",
      HBIL_KIND_FLOAT, HBIL_DYNAMIC_SKY_DEPTH, (uint32_t)offsetof(hbil_config, sky_depth), 1e-3, 1e15, 1e9 },
    { "depth_direction", "", "forward reversed",
      "HBIL_DEPTH_DEVICE || HBIL_PROJECTION_ORTHOGRAPHIC",
      "depth buffer value of the far end: 1 (forward) or 0 (reversed-Z)",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, depth_direction), 1, 2, 1 },
    { "depth_far", "", "finite infinite",
      "HBIL_DEPTH_DEVICE && HBIL_PROJECTION_PERSPECTIVE",
      "far plane of the projection matrix",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, depth_far), 1, 2, 1 },
    { "clip", "", "vulkan gl",
      "HBIL_DEPTH_DEVICE",
      "range of the projection's ndc z: [0, 1] (Vulkan, Direct3D, glClipControl) or [-1, 1] (GL)",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, clip), 1, 2, 1 },
    { "normals", "", "view world depth",
      "",
      "normal input: in view space, in world space, or none: rebuilt from depth",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, normals), 1, 3, 1 },
    { "normal_encoding", "", "xyz xyz_unorm octahedral octahedral_unorm octahedral_888 xy xy_unorm",
      "!HBIL_NORMALS_DEPTH",
      "channels of u_normal: xyz, octahedral xy, or xy of a normal that faces the camera; signed or [0, 1]; 888 is two 12-bit halves",
      "Meyer 2010, Mayaux 2018 sec. 3.1",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, normal_encoding), 1, 7, 1 },
    { "multisample", "", "no yes",
      "",
      "u_depth and u_normal are multisampled textures, of which one sample is read",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, multisample), 1, 2, 1 },
    { "sample", "index", "",
      "HBIL_MULTISAMPLE_YES",
      "sample that is read of a multisampled texture",
      "project",
      HBIL_KIND_INT, 0, (uint32_t)offsetof(hbil_config, sample), 1, 31, 0 },
    { "width", "pixels", "",
      "",
      "render width baked into the text; 0 keeps the size a uniform",
      "project",
      HBIL_KIND_INT, 0, (uint32_t)offsetof(hbil_config, width), 1, 16384, 0 },
    { "height", "pixels", "",
      "",
      "render height baked into the text, together with width",
      "project",
      HBIL_KIND_INT, 0, (uint32_t)offsetof(hbil_config, height), 1, 16384, 0 },
    { "seed_compat", "", "screen_azimuth slice_mean noise_2pi uniform_bent cone_relation f0_ao",
      "",
      "arithmetic of older articles: slices uniform on the screen; mean, no ratio; noise * 2 pi; bent vector without the cosine; cos aperture = 1 - ao; F0(ao)",
      "YPipeline HBIL article, Mayaux 2018",
      HBIL_KIND_SET, 0, (uint32_t)offsetof(hbil_config, seed_compat), 0, 63, 0 },
    { "storage", "", "full half",
      "HBIL_STAGED && !HBIL_ONLY_AO",
      "numbers between march, filters and frames: rgba32f, or rgba16f; ao alone is r32f",
      "project",
      HBIL_KIND_CHOICE, 0, (uint32_t)offsetof(hbil_config, storage), 1, 2, 1 },
    { "dynamic", "", "slices steps exponent reach falloff thickness decay bias angle_bias multiplier pull history firefly near_intensity far_intensity ao_exponent roughness sky_depth",
      "",
      "options kept as uniforms that may change from frame to frame; all others are literals in the text",
      "project",
      HBIL_KIND_SET, 0, (uint32_t)offsetof(hbil_config, dynamic), 0, 262143, 0 },
};
static const struct { const char *name, *expression; } hbil__symbols[] = {
    { "SWEPT", "HBIL_MARCH_SWEEP || HBIL_MARCH_BOTH" }, /* lines of the whole screen are swept */
    { "SAMPLED", "HBIL_MARCH_SAMPLED || HBIL_MARCH_BOTH" }, /* the march takes samples */
    { "COSINE", "HBIL_ESTIMATOR_HORIZON || HBIL_ESTIMATOR_BITMASK" }, /* cosine-weighted estimators: near + ao = 1 */
    { "NEAR_LIGHT", "HBIL_OUTPUTS_NEAR || ((HBIL_OUTPUTS_IRRADIANCE || HBIL_OUTPUTS_COMPOSITE) && HBIL_COSINE)" }, /* u_near is written */
    { "GATHER", "HBIL_NEAR_LIGHT || HBIL_OUTPUTS_SH" }, /* the march reads radiance */
    { "COARSE", "!HBIL_DOWNSCALE_1" }, /* the march has fewer pixels than the frame */
    { "STAGED", "!HBIL_FILTER_NONE || HBIL_TEMPORAL_YES || HBIL_COARSE" }, /* the march writes u_raw, which later passes make outputs of */
    { "SUMMED", "HBIL_OUTPUTS_IRRADIANCE || HBIL_OUTPUTS_COMPOSITE || HBIL_BOUNCES_RECURSIVE" }, /* near and far light are added up */
    { "MIPS", "!HBIL_MIPS_NONE" }, /* the pass mips is there */
    { "PACKED", "HBIL_GATHER && (HBIL_SWEPT || !HBIL_GATHER_RISE || !HBIL_MIPS_NONE || HBIL_BOUNCES_RECURSIVE || HBIL_COARSE)" }, /* u_view_radiance is written */
    { "MEAN_LIGHT", "HBIL_GATHER && (HBIL_MARCH_SWEEP || HBIL_GATHER_SIDE || HBIL_OCCLUDER_HEURISTIC)" }, /* a side has one radiance, the mean of what it sees */
    { "FAR_LIGHT", "!HBIL_ENVIRONMENT_NONE" }, /* far light is computed */
    { "FAR_SH", "HBIL_ENVIRONMENT_SH || HBIL_ENVIRONMENT_PROBES" }, /* the environment is spherical harmonics */
    { "BAND_2", "HBIL_FAR_SH && HBIL_SH_ORDER_2 && HBIL_FAR_VISIBILITY_BENT" }, /* band 2 comes in through the cone */
    { "FAR_BITS", "HBIL_FAR_LIGHT && HBIL_FAR_VISIBILITY_FREE_BITS" }, /* the march samples the environment, per group of free sectors */
    { "FAR_HERE", "HBIL_FAR_LIGHT && !HBIL_FAR_VISIBILITY_FREE_BITS" }, /* the light pass samples the environment, once */
    { "FAR_BENT", "HBIL_FAR_HERE && !HBIL_ENVIRONMENT_CONSTANT && !HBIL_FAR_VISIBILITY_AO" }, /* far light needs the bent vector */
    { "FITTED", "HBIL_SEED_COMPAT_F0_AO && (HBIL_ENVIRONMENT_CONSTANT || HBIL_FAR_VISIBILITY_AO || HBIL_FAR_VISIBILITY_DIRECTION)" }, /* far light weighs by F0(ao) */
    { "BENT", "HBIL_OUTPUTS_BENT || HBIL_OUTPUTS_CONE || HBIL_OUTPUTS_SPECULAR_OCCLUSION || HBIL_FAR_BENT" }, /* u_bent is written */
    { "LIGHT_AO", "HBIL_OUTPUTS_CONE || HBIL_OUTPUTS_SPECULAR_OCCLUSION || HBIL_OUTPUTS_MULTI_BOUNCE || HBIL_FAR_HERE" }, /* the light pass reads u_ao */
    { "AO", "HBIL_OUTPUTS_AO || HBIL_LIGHT_AO" }, /* u_ao is written */
    { "VISIBILITY", "HBIL_AO || (HBIL_BENT && !HBIL_AO_EXPONENT_1)" }, /* the march needs ao as a number */
    { "RATIO", "HBIL_COSINE && !HBIL_SEED_COMPAT_SLICE_MEAN && (HBIL_VISIBILITY || HBIL_GATHER || HBIL_OUTPUTS_SH || HBIL_FAR_BITS)" }, /* sums are divided by the light of an open sky in the same slices */
    { "SUMS", "HBIL_COSINE && (HBIL_RATIO || HBIL_VISIBILITY)" }, /* light of an open sky and its blocked part are added up */
    { "DEFER", "HBIL_STAGED && HBIL_RATIO && HBIL_SLICES_1" }, /* one slice: the ratio of its sums is biased, so that they are divided after the filters */
    { "LIGHT_LAYER", "HBIL_VISIBILITY || HBIL_NEAR_LIGHT" }, /* layer of a signal: rgb near light, a ao */
    { "BENT_LAYER", "HBIL_BENT || HBIL_DEFER" }, /* layer of a signal: xyz bent vector, a light of an open sky */
    { "FAR_LAYER", "HBIL_FAR_BITS || HBIL_OUTPUTS_UNIFORM_AO" }, /* layer of a signal: rgb far light, a uniform ao */
    { "ONLY_AO", "HBIL_LIGHT_LAYER && !HBIL_NEAR_LIGHT && !HBIL_BENT_LAYER && !HBIL_FAR_LAYER && !HBIL_OUTPUTS_SH" }, /* a signal is one number, and its textures have one channel */
    { "SPANS", "HBIL_BENT || HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH || HBIL_FAR_BITS" }, /* sectors are turned back into directions */
};
static const struct { const char *expression, *why, *fix; } hbil__refused[] = {
    { "HBIL_STAGE_FRAGMENT && HBIL_TARGET_VULKAN",
      "Vulkan always has compute shaders", "target=gl" },
    { "HBIL_STAGE_FRAGMENT && HBIL_SWEPT",
      "a sweep writes along lines; a fragment writes its own pixel only", "march=sampled" },
    { "HBIL_STAGE_FRAGMENT && HBIL_REPROJECT_SCATTER",
      "scattering takes atomics on images, which fragments of GLSL 3.30 do not have", "reproject=gather" },
    { "HBIL_STAGE_FRAGMENT && HBIL_TARGET_GLES && HBIL_MULTISAMPLE_YES",
      "ESSL 3.00 has no multisampled textures", "multisample=no" },
    { "HBIL_SWEPT && !HBIL_COSINE",
      "a sweep finds horizons; hbao and hbao_plus weigh samples", "march=sampled" },
    { "HBIL_MARCH_SWEEP && HBIL_ESTIMATOR_BITMASK",
      "a sweep knows no thickness; the bitmask wants samples nearby", "march=both" },
    { "HBIL_MARCH_BOTH && HBIL_ESTIMATOR_HORIZON",
      "the sweep alone has every horizon; samples nearby give the bitmask its thickness", "estimator=bitmask" },
    { "HBIL_GATHER_SIDE && !(HBIL_ESTIMATOR_HORIZON && HBIL_OCCLUDER_HEIGHT_FIELD)",
      "only the horizon of a height field has one place where a side ends", "gather=packed" },
    { "HBIL_GATHER_SIDE && HBIL_FACING_FILTER",
      "with one radiance per side there is no last one to stand in", "facing=half_space" },
    { "HBIL_MARCH_BOTH && HBIL_REACH_0",
      "samples of the whole screen leave nothing to the sweep", "reach=1" },
    { "HBIL_SWEPT && HBIL_OCCLUDER_HEURISTIC",
      "horizons of a sweep cannot sink", "occluder=height_field" },
    { "HBIL_SWEPT && HBIL_DYNAMIC_SLICES",
      "each slice of a sweep is two layers of a texture, which no uniform can add", "dynamic=none" },
    { "HBIL_DOWNSCALE_3",
      "blocks have 1, 2 or 4 pixels a side", "downscale=2" },
    { "HBIL_OUTPUTS_NEAR && !HBIL_COSINE",
      "near light needs an estimator of cosine-weighted arcs; hbao and hbao_plus have none", "outputs=ao" },
    { "HBIL_OUTPUTS_SH && !HBIL_COSINE",
      "sh of near light needs estimator horizon or bitmask", "outputs=ao" },
    { "(HBIL_OUTPUTS_IRRADIANCE || HBIL_OUTPUTS_COMPOSITE) && !HBIL_COSINE && HBIL_ENVIRONMENT_NONE",
      "hbao and hbao_plus gather no near light, and environment is none: nothing to add up", "outputs=ao" },
    { "HBIL_OUTPUTS_UNIFORM_AO && !HBIL_COSINE",
      "the ao of hbao is uniform already, and hbao_plus has no such measure", "outputs=ao" },
    { "(HBIL_OUTPUTS_BENT || HBIL_OUTPUTS_CONE || HBIL_OUTPUTS_SPECULAR_OCCLUSION) && !HBIL_COSINE",
      "bent vector, cone and specular occlusion need estimator horizon or bitmask", "outputs=ao" },
    { "HBIL_OUTPUTS_MULTI_BOUNCE && HBIL_GATHER",
      "multi_bounce next to near light counts the same energy twice", "outputs=ao+multi_bounce" },
    { "HBIL_OUTPUTS_FAR && HBIL_ENVIRONMENT_NONE",
      "outputs=far without an environment", "environment=sh" },
    { "HBIL_OCCLUDER_THICK && HBIL_ESTIMATOR_HORIZON",
      "one horizon per side cannot hold the gap behind a thin occluder", "estimator=bitmask" },
    { "HBIL_OCCLUDER_HEURISTIC && HBIL_ESTIMATOR_BITMASK",
      "sectors do not sink; the bitmask has thickness itself", "occluder=thick" },
    { "HBIL_FAR_LIGHT && !HBIL_ENVIRONMENT_CONSTANT && !HBIL_COSINE && !HBIL_FAR_VISIBILITY_AO",
      "hbao and hbao_plus have no bent vector", "far_visibility=ao" },
    { "HBIL_FAR_BITS && HBIL_ESTIMATOR_HORIZON",
      "only the bitmask has sectors", "far_visibility=bent" },
    { "HBIL_SEED_COMPAT_UNIFORM_BENT && HBIL_ESTIMATOR_BITMASK && HBIL_BENT",
      "seed_compat=uniform_bent is arithmetic of horizons", "seed_compat=none" },
    { "HBIL_SEED_COMPAT_UNIFORM_BENT && HBIL_FAR_HERE && HBIL_FAR_SH && HBIL_FAR_VISIBILITY_BENT",
      "far light by the bent vector wants it cosine-weighted, which uniform_bent is not", "far_visibility=direction" },
    { "HBIL_COSINE && HBIL_FAR_VISIBILITY_CONE && (HBIL_ENVIRONMENT_CUBE || HBIL_ENVIRONMENT_HOOK)",
      "only spherical harmonics have a closed form for a cone", "far_visibility=bent" },
    { "(HBIL_NORMAL_ENCODING_XY || HBIL_NORMAL_ENCODING_XY_UNORM) && HBIL_NORMALS_WORLD",
      "two channels hold no sign of z: only normals in view space face the camera", "normal_encoding=octahedral" },
};
static const struct { int32_t option; uint32_t bit; const char *applies; } hbil__members[] = {
    { 57, 0x1, "HBIL_MARCH_SAMPLED" }, /* seed_compat=screen_azimuth */
    { 57, 0x2, "HBIL_MARCH_SAMPLED && HBIL_COSINE && (HBIL_VISIBILITY || HBIL_GATHER || HBIL_FAR_BITS)" }, /* seed_compat=slice_mean */
    { 57, 0x4, "HBIL_MARCH_SAMPLED && !HBIL_NOISE_NONE" }, /* seed_compat=noise_2pi */
    { 57, 0x8, "HBIL_BENT" }, /* seed_compat=uniform_bent */
    { 57, 0x10, "HBIL_OUTPUTS_CONE || (HBIL_FAR_HERE && (HBIL_ENVIRONMENT_HOOK || HBIL_FAR_VISIBILITY_CONE || HBIL_BAND_2))" }, /* seed_compat=cone_relation */
    { 57, 0x20, "HBIL_FAR_HERE && (HBIL_ENVIRONMENT_CONSTANT || HBIL_FAR_VISIBILITY_AO || HBIL_FAR_VISIBILITY_DIRECTION)" }, /* seed_compat=f0_ao */
};
static const struct { const char *name, *meaning, *config, *sources; } hbil__presets[] = {
    { "fast", "whole screen at the price of two swept slices; a third of their error, by the filter",
      "march=sweep slices=2 sweep_stride=3 filter=3x3",
      "march=sweep: measured on frames: README, Marches\n"
      "slices=2: project\n"
      "sweep_stride=3: project: each direction is in every 3x3 pixels of the filter\n"
      "filter=3x3: project\n" },
    { "balanced", "twice the slices of fast: what to begin with",
      "march=sweep slices=4 sweep_stride=3 filter=3x3",
      "march=sweep: measured on frames: README, Marches\n"
      "slices=4: project\n"
      "sweep_stride=3: project\n"
      "filter=3x3: project\n" },
    { "quality", "four times the slices of fast",
      "march=sweep slices=8 sweep_stride=3 filter=3x3",
      "march=sweep: measured on frames: README, Marches\n"
      "slices=8: project\n"
      "sweep_stride=3: project\n"
      "filter=3x3: project\n" },
    { "sampled", "samples only, at their best: to begin with for a short reach or thickness",
      "march=sampled slices=3 steps=6 mips=spread interleave=yes filter=5x5",
      "march=sampled: project\n"
      "slices=3: project\n"
      "steps=6: project\n"
      "mips=spread: measured on frames: README, Marches\n"
      "interleave=yes: measured on frames: README, Marches\n"
      "filter=5x5: project: over the 4x4 pixels of a block\n" },
    { "reference", "close to the surface's exact light; for comparisons, not for games",
      "slices=64 steps=256 sampling=bilinear",
      "slices=64: project\n"
      "steps=256: project\n"
      "sampling=bilinear: project: tests/numeric/README.md\n" },
    { "hbao", "sin h - sin t of Bavoil 2008: uniform ao, weight per sample",
      "outputs=ao estimator=hbao slices=4 steps=6 sampling=nearest spacing=power exponent=1 reach=1 attenuation=quadratic angle_bias=0.1 ao_exponent=1 noise=hilbert_r2",
      "outputs=ao: HBAO + GTAO article, HBAO: Principle\n"
      "estimator=hbao: HBAO + GTAO article, HBAO: Mathematics\n"
      "slices=4: HBAO + GTAO article, fig. 22: 8 one-sided directions\n"
      "steps=6: HBAO Unity article, Ray marching: STEP_COUNT 6\n"
      "sampling=nearest: HBAO Unity article, Ray marching: round to a pixel\n"
      "spacing=power: HBAO + GTAO article, HBAO: Step length\n"
      "exponent=1: HBAO + GTAO article, HBAO: Step length, equal steps\n"
      "reach=1: HBAO + GTAO article, fig. 19: Radius 1\n"
      "attenuation=quadratic: HBAO + GTAO article, Marching: W(r) = 1 - r^2\n"
      "angle_bias=0.1: HBAO Unity article, C# script: AngleBias 0.1\n"
      "ao_exponent=1: project: the seed's pow 0.6 acts on occlusion, not on ao\n"
      "noise=hilbert_r2: project: the seeds use a hash or a blue noise texture\n" },
    { "hbao_plus", "disc-sampled obscurance of HBAO+; ao only",
      "outputs=ao estimator=hbao_plus slices=4 steps=4 spacing=power exponent=1 sampling=nearest reach=1 attenuation=quadratic angle_bias=0.1 multiplier=1.39 ao_exponent=2 noise=hilbert_r2",
      "outputs=ao: HBAO + GTAO article, HBAO+ method\n"
      "estimator=hbao_plus: HBAO + GTAO article, HBAO+ method: ComputeAO\n"
      "slices=4: NVIDIA HBAO+, SharedDefines.h: NUM_DIRECTIONS 8\n"
      "steps=4: NVIDIA HBAO+, SharedDefines.h: NUM_STEPS 4\n"
      "spacing=power: NVIDIA HBAO+, CoarseAO_PS.hlsl: StepSizePixels\n"
      "exponent=1: NVIDIA HBAO+, CoarseAO_PS.hlsl: equal steps\n"
      "sampling=nearest: NVIDIA HBAO+, CoarseAO_PS.hlsl: SnappedUV\n"
      "reach=1: NVIDIA HBAO+, GFSDK_SSAO.h: Radius 1\n"
      "attenuation=quadratic: NVIDIA HBAO+, CoarseAO_PS.hlsl: Falloff\n"
      "angle_bias=0.1: NVIDIA HBAO+, GFSDK_SSAO.h: Bias 0.1\n"
      "multiplier=1.39: project: mean weight of NVIDIA HBAO+, whose first step counts twice\n"
      "ao_exponent=2: NVIDIA HBAO+, GFSDK_SSAO.h: PowerExponent 2\n"
      "noise=hilbert_r2: project: HBAO+ has a 4x4 random texture\n" },
    { "gtao", "cosine arcs, sinking horizons, multi-bounce ao, specular occlusion",
      "outputs=ao+specular_occlusion+multi_bounce estimator=horizon slices=4 steps=4 spacing=power exponent=1 sampling=nearest reach=1 falloff=0.615 occluder=heuristic decay=0.1 bounce=cubic ao_exponent=1 noise=hilbert_r2 filter=5x5 temporal=yes",
      "outputs=ao+specular_occlusion+multi_bounce: Jimenez 2016: GTAO, multi-bounce, GTSO\n"
      "estimator=horizon: HBAO + GTAO article, GTAO: Integral\n"
      "slices=4: HBAO + GTAO article, GTAO: Noise, NUM_DIRECTIONS 4\n"
      "steps=4: HBAO + GTAO article, GTAO: Noise, NUM_STEPS 4\n"
      "spacing=power: HBAO + GTAO article, GTAO: Noise, offset\n"
      "exponent=1: HBAO + GTAO article, GTAO: Noise, equal steps\n"
      "sampling=nearest: HBAO + GTAO article, GTAO: Computing AO, LoadDepth\n"
      "reach=1: HBAO + GTAO article, fig. 19; GTAO: same radius as HBAO\n"
      "falloff=0.615: XeGTAO, XeGTAO.h: FALLOFF_RANGE; the article cuts hard\n"
      "occluder=heuristic: Jimenez 2016: thickness heuristic\n"
      "decay=0.1: project: inside 0.03 .. 0.15 of open implementations\n"
      "bounce=cubic: Jimenez 2016: multi-bounce fit\n"
      "ao_exponent=1: project: no power in the article\n"
      "noise=hilbert_r2: XeGTAO; Jimenez 2016 has a 4x4 pattern\n"
      "filter=5x5: Jimenez 2016: spatial filter, of 4x4\n"
      "temporal=yes: Jimenez 2016; HBAO + GTAO article, GTAO: Noise, Temporal Filter\n" },
    { "hbil_paper", "near light, bent cone and SH environment of Mayaux 2018",
      "outputs=ao+cone+near+far+composite estimator=horizon slices=2 steps=8 spacing=power exponent=1 sampling=nearest reach=4 falloff=0.01 occluder=height_field facing=filter bounces=recursive reproject=scatter interleave=yes f0=scalar near_intensity=1 far_intensity=1 ao_exponent=1 environment=sh sh_order=2 far_visibility=cone noise=hilbert_r2",
      "outputs=ao+cone+near+far+composite: Mayaux 2018 sec. 2.2, 2.3, eq. 17\n"
      "estimator=horizon: Mayaux 2018 sec. 2.3.2, eq. 18\n"
      "slices=2: Mayaux 2018 sec. 3.3, 3.5: 2 slices per pixel\n"
      "steps=8: Mayaux 2018 sec. 3.5: 16 samples per direction, 8 a side\n"
      "spacing=power: project: no step rule in Mayaux 2018; its code is linear\n"
      "exponent=1: project: no step rule in Mayaux 2018; its code is linear\n"
      "sampling=nearest: project: Mayaux 2018 silent; its code reads texels\n"
      "reach=4: project: Mayaux 2018 gives none; 4 m in its test program\n"
      "falloff=0.01: project: Mayaux 2018 has none; the least we have\n"
      "occluder=height_field: Mayaux 2018 sec. 1, fig. 3\n"
      "facing=filter: Mayaux 2018 sec. 3.4\n"
      "bounces=recursive: Mayaux 2018 eq. 17: radiance of frame N - 1\n"
      "reproject=scatter: Mayaux 2018 sec. 3.2: forward reprojection, push/pull\n"
      "interleave=yes: Mayaux 2018 sec. 3.3: 4x4 split buffers\n"
      "f0=scalar: Mayaux 2018 sec. 2.3.3, eq. 19; sec. 3.1: luminance\n"
      "near_intensity=1: Mayaux 2018 eq. 17: no factor\n"
      "far_intensity=1: Mayaux 2018 eq. 17: no factor\n"
      "ao_exponent=1: Mayaux 2018 eq. 11: no power\n"
      "environment=sh: Mayaux 2018 sec. 2.2.4\n"
      "sh_order=2: Mayaux 2018 sec. 2.2.4: order 2, 9 coefficients\n"
      "far_visibility=cone: Mayaux 2018 sec. 2.2.4: reduced cone\n"
      "noise=hilbert_r2: project: Mayaux 2018 sec. 3.3 rotates in 4x4 pixels\n" },
    { "hbil_screen", "near light of the whole screen, probe light behind it: YPipeline",
      "outputs=ao+near+far+composite estimator=horizon slices=3 steps=6 spacing=power exponent=1.5 sampling=nearest reach=0 occluder=height_field facing=none bounces=recursive reproject=gather temporal=yes filter=5x5 downscale=2 f0=none near_intensity=1 far_intensity=1 ao_exponent=0.75 environment=sh sh_order=2 far_visibility=direction noise=hilbert_r2",
      "outputs=ao+near+far+composite: project: the article stores near + far only\n"
      "estimator=horizon: YPipeline HBIL article, Slice integral\n"
      "slices=3: YPipeline HBIL article, Results: Direction Count 3\n"
      "steps=6: YPipeline HBIL article, Results: Step Count 6\n"
      "spacing=power: YPipeline HBIL article, Range of influence\n"
      "exponent=1.5: YPipeline source, ScreenSpaceGlobalIllumination.cs\n"
      "sampling=nearest: YPipeline HBIL article, Full code: int2 sampleCoord\n"
      "reach=0: YPipeline HBIL article, Range of influence\n"
      "occluder=height_field: YPipeline HBIL article, Full code: rising horizon\n"
      "facing=none: YPipeline HBIL article, Full code: no normal of the source\n"
      "bounces=recursive: YPipeline HBIL article, Full code: last frame's color, for all bounces\n"
      "reproject=gather: YPipeline HBIL article, Full code: motion vectors\n"
      "temporal=yes: YPipeline HBIL article, Results: Temporal Filter + Bilateral Filter\n"
      "filter=5x5: YPipeline HBIL article, Results: Temporal Filter + Bilateral Filter\n"
      "downscale=2: YPipeline HBIL article, Results: Half Resolution\n"
      "f0=none: YPipeline HBIL article, Full code: no Fresnel factor\n"
      "near_intensity=1: YPipeline source, ScreenSpaceGlobalIllumination.cs\n"
      "far_intensity=1: YPipeline source, ScreenSpaceGlobalIllumination.cs\n"
      "ao_exponent=0.75: YPipeline source, ScreenSpaceGlobalIllumination.cs\n"
      "environment=sh: YPipeline HBIL article, Full code: FallbackAmbientProbe\n"
      "sh_order=2: project: the article gives no order\n"
      "far_visibility=direction: YPipeline HBIL article, AO and bent normal\n"
      "noise=hilbert_r2: project: the article reads a blue noise texture\n" },
    { "bitmask", "32 sectors of equal energy, thick occluders, light from behind them",
      "outputs=ao+near+far+composite estimator=bitmask slices=2 steps=6 spacing=geometric reach=5 falloff=0.01 occluder=thick thickness=1 facing=half_space near_intensity=1 far_intensity=1 ao_exponent=1 environment=sh far_visibility=free_bits noise=ign",
      "outputs=ao+near+far+composite: Therrien 2023: ao, indirect and ambient light\n"
      "estimator=bitmask: Therrien 2023; equal energy: GT-VBAO\n"
      "slices=2: project: SSRT3 has 1 x 12; one slice is biased by the ratio\n"
      "steps=6: project: as many samples as SSRT3, 1 x 12 a side\n"
      "spacing=geometric: GT-VBGI: steps as a geometric series\n"
      "reach=5: SSRT3, SSRT_HDRP.cs: radius 5\n"
      "falloff=0.01: SSRT3 has none; the least we have\n"
      "occluder=thick: Therrien 2023: constant thickness\n"
      "thickness=1: SSRT3, SSRT_HDRP.cs: thickness 1\n"
      "facing=half_space: GT-VBGI: half-space mask of the source normal\n"
      "near_intensity=1: project: SSRT3's 10 makes up for its two cosines\n"
      "far_intensity=1: SSRT3, SSRT_HDRP.cs: fallbackIntensity 1\n"
      "ao_exponent=1: SSRT3, SSRT_HDRP.cs: AOIntensity 1\n"
      "environment=sh: project: SSRT3 reads probes, off by default\n"
      "far_visibility=free_bits: SSRT3, SSRTCS.compute: hitCount per group\n"
      "noise=ign: SSRT3, SSRTCS.compute: GradientNoise\n" },
};
/* >>gen options */

enum { HBIL__LAYERS_SIDES = 0x1000, HBIL__LAYERS_SIGNAL, HBIL_FORMAT_SIGNAL, HBIL__DRAWN }; /* rules instead of a number of layers, a format, a size */

/* <<gen passes     written by `cmake --build build --target embed` from the tables: do not edit */
static const struct { const char *layout; uint32_t bytes; } hbil__formats[] = {
    { "", 0 },
    { "r32f", 4 },
    { "r32ui", 4 },
    { "rgba32f", 16 },
    { "rgba16f", 8 },
};
static const struct { const char *name; uint16_t life, format, dim, layers, grid; const char *wanted, *meaning; } hbil__textures[] = {
    { "depth", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_2D_MULTISAMPLE, 1, 0, "",
      "depth as the option depth says. row 0 is ndc y = -1" },
    { "normal", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_2D_MULTISAMPLE, 1, 0, "",
      "shading normal as normals and normal_encoding say" },
    { "radiance", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_2D, 1, 0, "",
      "rgb radiance that leaves each surface and bounces, linear; glowing surfaces included" },
    { "motion", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_2D, 1, 0, "",
      "rg: pixel where the surface point was in the last frame minus where it is now, both as rendered, jitter included" },
    { "direct", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_2D, 1, 0, "",
      "rgb outgoing radiance without indirect light, linear" },
    { "albedo", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_2D, 1, 0, "",
      "rgb diffuse reflectance in [0, 1]" },
    { "f0", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_2D, 1, 0, "",
      "specular reflectance at normal incidence in [0, 1], r or rgb" },
    { "roughness", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_2D, 1, 0, "",
      "r perceptual roughness in [0, 1]" },
    { "sky", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_CUBE, 1, 0, "",
      "rgb of the environment by world direction. E/pi, already blurred; with free_bits radiance" },
    { "probes", HBIL_LIFE_INPUT, HBIL_FORMAT_ANY, HBIL_DIM_3D, 1, 0, "",
      "rgb SH radiance of a grid: nx * ny * (nz * coefficients), coefficient k in slab k of nz" },
    { "full_depth", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32F, HBIL_DIM_2D, 1, 0, "",
      "view depth of every pixel, where the grid is coarser. m, 1e15 is sky" },
    { "full_normal", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32UI, HBIL_DIM_2D, 1, 0, "",
      "normal of every pixel, as view_normal" },
    { "view_depth", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32F, HBIL_DIM_2D, 1, 1, "",
      "view depth. m, 1e15 is sky" },
    { "view_normal", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32UI, HBIL_DIM_2D, 1, 1, "",
      "octahedral normal, 2 x snorm16; x right, y up, z into the screen" },
    { "view_radiance", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32UI, HBIL_DIM_2D, 1, 1, "",
      "rgb radiance, finite: 3 x 9 bits with a common exponent of 5" },
    { "depth_mips", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32F, HBIL_DIM_2D_ARRAY, 2, 1, "",
      "view depth; layer 0 as it is, layer 1 its levels of 2, 4 and 8 pixels side by side" },
    { "radiance_mips", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32UI, HBIL_DIM_2D_ARRAY, 2, 1, "",
      "view_radiance in the same layers" },
    { "swept", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32UI, HBIL_DIM_2D_ARRAY, HBIL__LAYERS_SIDES, 1, "",
      "per side: steps to the pixel of the line that makes the horizon, 0 if there is none; high half: rise of what lies between" },
    { "swept_light", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32UI, HBIL_DIM_2D_ARRAY, HBIL__LAYERS_SIDES, 1, "",
      "per side: mean radiance of all that stands up on the way there, as view_radiance" },
    { "landed", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32UI, HBIL_DIM_2D, 1, 1, "",
      "depth code of the nearest surface of last frame that falls here, all ones if none does" },
    { "claimed", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_R32UI, HBIL_DIM_2D, 1, 1, "",
      "the pixel of last frame that it came from: x + y * 65536, all ones if none did" },
    { "pushed", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 1, "",
      "last frame's irradiance where it fell, levels of 2 and 4 pixels side by side: rgb mean, a depth, 0 if empty" },
    { "pushed_8", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 8, "",
      "the same, level of 8 pixels" },
    { "pushed_far", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 8, "",
      "the same, levels of 16, 32 and 64 pixels side by side" },
    { "raw", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_SIGNAL, HBIL_DIM_2D_ARRAY, HBIL__LAYERS_SIGNAL, 1, "",
      "what this frame's march says, in layers: see HBIL_LAYERS" },
    { "signal", HBIL_LIFE_HISTORY, HBIL_FORMAT_SIGNAL, HBIL_DIM_2D_ARRAY, HBIL__LAYERS_SIGNAL, 1, "",
      "its running mean over the frames" },
    { "soft", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_SIGNAL, HBIL_DIM_2D_ARRAY, HBIL__LAYERS_SIGNAL, 1, "",
      "after one pass of the filter" },
    { "soft_2", HBIL_LIFE_TRANSIENT, HBIL_FORMAT_SIGNAL, HBIL_DIM_2D_ARRAY, HBIL__LAYERS_SIGNAL, 1, "",
      "after two" },
    { "seen", HBIL_LIFE_HISTORY, HBIL_FORMAT_R32UI, HBIL_DIM_2D, 1, 1, "",
      "view depth, its lowest 6 bits the frames in the running mean" },
    { "bounce", HBIL_LIFE_HISTORY, HBIL_FORMAT_R32UI, HBIL_DIM_2D, 1, HBIL__DRAWN, "",
      "irradiance E/pi that the surface may reflect in the next frame, as view_radiance" },
    { "ao", HBIL_LIFE_OUTPUT, HBIL_FORMAT_R32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_AO",
      "visibility as the estimator weighs it. 1 is open, range [0, 1]" },
    { "uniform_ao", HBIL_LIFE_OUTPUT, HBIL_FORMAT_R32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_UNIFORM_AO",
      "visible part of the hemisphere's solid angle. 1 is open, range [0, 1]" },
    { "bent", HBIL_LIFE_OUTPUT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_BENT",
      "cosine-weighted bent vector in view space, not normalised, length 2/3 when open. a = 1" },
    { "cone", HBIL_LIFE_OUTPUT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_CONE",
      "visible cone: xyz its axis in view space, the bent direction; a = cosine of its half angle" },
    { "near", HBIL_LIFE_OUTPUT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_NEAR",
      "near irradiance E/pi: multiply by albedo and be done. a = 1" },
    { "sh", HBIL_LIFE_OUTPUT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D_ARRAY, 4, 0, "HBIL_OUTPUTS_SH",
      "layers Y00 Y1-1 Y10 Y11 in view space: rgb of near radiance, a of visibility" },
    { "far", HBIL_LIFE_OUTPUT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_FAR",
      "far irradiance E/pi, through the visible part only. a = 1" },
    { "irradiance", HBIL_LIFE_OUTPUT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_IRRADIANCE",
      "near + far irradiance E/pi: multiply by albedo and be done. a = 1" },
    { "specular_occlusion", HBIL_LIFE_OUTPUT, HBIL_FORMAT_R32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_SPECULAR_OCCLUSION",
      "visible part of the specular lobe. 1 is open, range [0, 1]" },
    { "multi_bounce", HBIL_LIFE_OUTPUT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_MULTI_BOUNCE",
      "rgb visibility after all bounces off surfaces of the pixel's albedo. a = 1" },
    { "composite", HBIL_LIFE_OUTPUT, HBIL_FORMAT_RGBA32F, HBIL_DIM_2D, 1, 0, "HBIL_OUTPUTS_COMPOSITE",
      "direct + albedo * (near + far). a = 1" },
};
static const struct { const char *name, *exists; uint16_t grid, domain, group[2]; const char *meaning; } hbil__passes[] = {
    { "prepare", "", HBIL_GRID_PIXELS, 0, { 8, 8 },
      "depth of any convention to metres, normals to view space, sky classified on the raw value" },
    { "shrink", "HBIL_COARSE", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "one pixel of a coarser grid for each block: the plane through its middle, or its nearest or farthest surface" },
    { "scatter", "HBIL_REPROJECT_SCATTER", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "last frame's pixels into this frame: the nearest depth stays" },
    { "claim", "HBIL_REPROJECT_SCATTER", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "last frame's pixels again: those of the nearest depth leave their address" },
    { "push", "HBIL_REPROJECT_SCATTER && HBIL_BOUNCES_RECURSIVE", HBIL_GRID_PIXELS, 22, { 8, 8 },
      "last frame's light where it fell, in coarser levels, for the holes" },
    { "push_2", "HBIL_REPROJECT_SCATTER && HBIL_BOUNCES_RECURSIVE", HBIL_GRID_PIXELS, 23, { 8, 8 },
      "the levels from 16 to 64 pixels" },
    { "reproject", "HBIL_BOUNCES_RECURSIVE", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "radiance and what the surface reflects of last frame's light" },
    { "mips", "HBIL_MIPS", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "three coarser levels of depth, and of radiance, at once" },
    { "sweep", "HBIL_SWEPT", HBIL_GRID_LINES, 17, { 32, 1 },
      "horizons of the whole screen: one walk along every line of every direction, both ways, keeps the hull of what it passed" },
    { "march", "", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "what each slice sees: visibility, near light and bent vector from the same samples" },
    { "temporal", "HBIL_TEMPORAL_YES", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "running mean with what the last frames saw of the same surface" },
    { "filter", "!HBIL_FILTER_NONE", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "mean over the neighbours that lie on the same surface" },
    { "filter_2", "!HBIL_FILTER_NONE && !HBIL_FILTER_PASSES_1", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "the same with gaps of 1 pixel" },
    { "filter_3", "!HBIL_FILTER_NONE && HBIL_FILTER_PASSES_3", HBIL_GRID_PIXELS, 12, { 8, 8 },
      "the same with gaps of 3 pixels" },
    { "upsample", "HBIL_COARSE", HBIL_GRID_PIXELS, 0, { 8, 8 },
      "from the coarser grid to every pixel: the four around it, as far as they are of its surface" },
    { "light", "HBIL_LIGHT_AO || HBIL_SUMMED", HBIL_GRID_PIXELS, 0, { 8, 8 },
      "what follows from visibility per pixel: cone, far light, sums, specular occlusion, bounces" },
};
static const struct { uint16_t pass, texture, role; const char *when; } hbil__binds[] = {
    { 0, 0, HBIL_ROLE_SAMPLE, "" }, /* prepare depth */
    { 0, 1, HBIL_ROLE_SAMPLE, "" }, /* prepare normal */
    { 0, 2, HBIL_ROLE_SAMPLE, "" }, /* prepare radiance */
    { 0, 10, HBIL_ROLE_WRITE, "" }, /* prepare full_depth */
    { 0, 11, HBIL_ROLE_WRITE, "" }, /* prepare full_normal */
    { 0, 12, HBIL_ROLE_WRITE, "" }, /* prepare view_depth */
    { 0, 13, HBIL_ROLE_WRITE, "" }, /* prepare view_normal */
    { 0, 14, HBIL_ROLE_WRITE, "" }, /* prepare view_radiance */
    { 0, 19, HBIL_ROLE_WRITE, "" }, /* prepare landed */
    { 1, 10, HBIL_ROLE_SAMPLE, "" }, /* shrink full_depth */
    { 1, 11, HBIL_ROLE_SAMPLE, "" }, /* shrink full_normal */
    { 1, 2, HBIL_ROLE_SAMPLE, "" }, /* shrink radiance */
    { 1, 12, HBIL_ROLE_WRITE, "" }, /* shrink view_depth */
    { 1, 13, HBIL_ROLE_WRITE, "" }, /* shrink view_normal */
    { 1, 14, HBIL_ROLE_WRITE, "" }, /* shrink view_radiance */
    { 1, 19, HBIL_ROLE_WRITE, "" }, /* shrink landed */
    { 2, 28, HBIL_ROLE_LAST, "" }, /* scatter seen */
    { 2, 19, HBIL_ROLE_UPDATE, "" }, /* scatter landed */
    { 2, 20, HBIL_ROLE_WRITE, "" }, /* scatter claimed */
    { 3, 28, HBIL_ROLE_LAST, "" }, /* claim seen */
    { 3, 19, HBIL_ROLE_SAMPLE, "" }, /* claim landed */
    { 3, 20, HBIL_ROLE_UPDATE, "" }, /* claim claimed */
    { 4, 20, HBIL_ROLE_SAMPLE, "" }, /* push claimed */
    { 4, 19, HBIL_ROLE_SAMPLE, "" }, /* push landed */
    { 4, 29, HBIL_ROLE_LAST, "" }, /* push bounce */
    { 4, 21, HBIL_ROLE_WRITE, "" }, /* push pushed */
    { 4, 22, HBIL_ROLE_WRITE, "" }, /* push pushed_8 */
    { 5, 22, HBIL_ROLE_SAMPLE, "" }, /* push_2 pushed_8 */
    { 5, 23, HBIL_ROLE_WRITE, "" }, /* push_2 pushed_far */
    { 6, 12, HBIL_ROLE_SAMPLE, "" }, /* reproject view_depth */
    { 6, 13, HBIL_ROLE_SAMPLE, "" }, /* reproject view_normal */
    { 6, 10, HBIL_ROLE_SAMPLE, "" }, /* reproject full_depth */
    { 6, 2, HBIL_ROLE_SAMPLE, "" }, /* reproject radiance */
    { 6, 5, HBIL_ROLE_SAMPLE, "" }, /* reproject albedo */
    { 6, 3, HBIL_ROLE_SAMPLE, "" }, /* reproject motion */
    { 6, 20, HBIL_ROLE_SAMPLE, "" }, /* reproject claimed */
    { 6, 21, HBIL_ROLE_SAMPLE, "" }, /* reproject pushed */
    { 6, 22, HBIL_ROLE_SAMPLE, "" }, /* reproject pushed_8 */
    { 6, 23, HBIL_ROLE_SAMPLE, "" }, /* reproject pushed_far */
    { 6, 28, HBIL_ROLE_LAST, "" }, /* reproject seen */
    { 6, 29, HBIL_ROLE_LAST, "" }, /* reproject bounce */
    { 6, 14, HBIL_ROLE_WRITE, "" }, /* reproject view_radiance */
    { 6, 28, HBIL_ROLE_WRITE, "" }, /* reproject seen */
    { 7, 12, HBIL_ROLE_SAMPLE, "" }, /* mips view_depth */
    { 7, 14, HBIL_ROLE_SAMPLE, "" }, /* mips view_radiance */
    { 7, 15, HBIL_ROLE_WRITE, "" }, /* mips depth_mips */
    { 7, 16, HBIL_ROLE_WRITE, "" }, /* mips radiance_mips */
    { 8, 12, HBIL_ROLE_SAMPLE, "" }, /* sweep view_depth */
    { 8, 13, HBIL_ROLE_SAMPLE, "" }, /* sweep view_normal */
    { 8, 14, HBIL_ROLE_SAMPLE, "" }, /* sweep view_radiance */
    { 8, 17, HBIL_ROLE_UPDATE, "" }, /* sweep swept */
    { 8, 18, HBIL_ROLE_UPDATE, "" }, /* sweep swept_light */
    { 9, 12, HBIL_ROLE_SAMPLE, "" }, /* march view_depth */
    { 9, 13, HBIL_ROLE_SAMPLE, "" }, /* march view_normal */
    { 9, 2, HBIL_ROLE_SAMPLE, "" }, /* march radiance */
    { 9, 14, HBIL_ROLE_SAMPLE, "" }, /* march view_radiance */
    { 9, 15, HBIL_ROLE_SAMPLE, "" }, /* march depth_mips */
    { 9, 16, HBIL_ROLE_SAMPLE, "" }, /* march radiance_mips */
    { 9, 17, HBIL_ROLE_SAMPLE, "" }, /* march swept */
    { 9, 18, HBIL_ROLE_SAMPLE, "" }, /* march swept_light */
    { 9, 6, HBIL_ROLE_SAMPLE, "" }, /* march f0 */
    { 9, 8, HBIL_ROLE_SAMPLE, "" }, /* march sky */
    { 9, 9, HBIL_ROLE_SAMPLE, "" }, /* march probes */
    { 9, 24, HBIL_ROLE_TO, "" }, /* march raw */
    { 9, 30, HBIL_ROLE_WRITE, "" }, /* march ao */
    { 9, 31, HBIL_ROLE_WRITE, "" }, /* march uniform_ao */
    { 9, 32, HBIL_ROLE_WRITE, "" }, /* march bent */
    { 9, 34, HBIL_ROLE_WRITE, "" }, /* march near */
    { 9, 35, HBIL_ROLE_WRITE, "" }, /* march sh */
    { 9, 36, HBIL_ROLE_WRITE, "HBIL_FAR_BITS" }, /* march far */
    { 10, 12, HBIL_ROLE_SAMPLE, "" }, /* temporal view_depth */
    { 10, 13, HBIL_ROLE_SAMPLE, "" }, /* temporal view_normal */
    { 10, 3, HBIL_ROLE_SAMPLE, "" }, /* temporal motion */
    { 10, 20, HBIL_ROLE_SAMPLE, "" }, /* temporal claimed */
    { 10, 24, HBIL_ROLE_FROM, "" }, /* temporal raw */
    { 10, 28, HBIL_ROLE_LAST, "" }, /* temporal seen */
    { 10, 25, HBIL_ROLE_LAST, "" }, /* temporal signal */
    { 10, 6, HBIL_ROLE_SAMPLE, "" }, /* temporal f0 */
    { 10, 28, HBIL_ROLE_WRITE, "" }, /* temporal seen */
    { 10, 25, HBIL_ROLE_TO, "" }, /* temporal signal */
    { 10, 30, HBIL_ROLE_WRITE, "" }, /* temporal ao */
    { 10, 31, HBIL_ROLE_WRITE, "" }, /* temporal uniform_ao */
    { 10, 32, HBIL_ROLE_WRITE, "" }, /* temporal bent */
    { 10, 34, HBIL_ROLE_WRITE, "" }, /* temporal near */
    { 10, 35, HBIL_ROLE_WRITE, "" }, /* temporal sh */
    { 10, 36, HBIL_ROLE_WRITE, "HBIL_FAR_BITS" }, /* temporal far */
    { 11, 12, HBIL_ROLE_SAMPLE, "" }, /* filter view_depth */
    { 11, 13, HBIL_ROLE_SAMPLE, "" }, /* filter view_normal */
    { 11, 28, HBIL_ROLE_SAMPLE, "" }, /* filter seen */
    { 11, 24, HBIL_ROLE_FROM, "HBIL_TEMPORAL_NO" }, /* filter raw */
    { 11, 25, HBIL_ROLE_FROM, "HBIL_TEMPORAL_YES" }, /* filter signal */
    { 11, 6, HBIL_ROLE_SAMPLE, "" }, /* filter f0 */
    { 11, 26, HBIL_ROLE_TO, "" }, /* filter soft */
    { 11, 30, HBIL_ROLE_WRITE, "" }, /* filter ao */
    { 11, 31, HBIL_ROLE_WRITE, "" }, /* filter uniform_ao */
    { 11, 32, HBIL_ROLE_WRITE, "" }, /* filter bent */
    { 11, 34, HBIL_ROLE_WRITE, "" }, /* filter near */
    { 11, 35, HBIL_ROLE_WRITE, "" }, /* filter sh */
    { 11, 36, HBIL_ROLE_WRITE, "HBIL_FAR_BITS" }, /* filter far */
    { 12, 12, HBIL_ROLE_SAMPLE, "" }, /* filter_2 view_depth */
    { 12, 13, HBIL_ROLE_SAMPLE, "" }, /* filter_2 view_normal */
    { 12, 28, HBIL_ROLE_SAMPLE, "" }, /* filter_2 seen */
    { 12, 26, HBIL_ROLE_FROM, "" }, /* filter_2 soft */
    { 12, 6, HBIL_ROLE_SAMPLE, "" }, /* filter_2 f0 */
    { 12, 27, HBIL_ROLE_TO, "" }, /* filter_2 soft_2 */
    { 12, 30, HBIL_ROLE_WRITE, "" }, /* filter_2 ao */
    { 12, 31, HBIL_ROLE_WRITE, "" }, /* filter_2 uniform_ao */
    { 12, 32, HBIL_ROLE_WRITE, "" }, /* filter_2 bent */
    { 12, 34, HBIL_ROLE_WRITE, "" }, /* filter_2 near */
    { 12, 35, HBIL_ROLE_WRITE, "" }, /* filter_2 sh */
    { 12, 36, HBIL_ROLE_WRITE, "HBIL_FAR_BITS" }, /* filter_2 far */
    { 13, 12, HBIL_ROLE_SAMPLE, "" }, /* filter_3 view_depth */
    { 13, 13, HBIL_ROLE_SAMPLE, "" }, /* filter_3 view_normal */
    { 13, 28, HBIL_ROLE_SAMPLE, "" }, /* filter_3 seen */
    { 13, 27, HBIL_ROLE_FROM, "" }, /* filter_3 soft_2 */
    { 13, 6, HBIL_ROLE_SAMPLE, "" }, /* filter_3 f0 */
    { 13, 26, HBIL_ROLE_TO, "" }, /* filter_3 soft */
    { 13, 30, HBIL_ROLE_WRITE, "" }, /* filter_3 ao */
    { 13, 31, HBIL_ROLE_WRITE, "" }, /* filter_3 uniform_ao */
    { 13, 32, HBIL_ROLE_WRITE, "" }, /* filter_3 bent */
    { 13, 34, HBIL_ROLE_WRITE, "" }, /* filter_3 near */
    { 13, 35, HBIL_ROLE_WRITE, "" }, /* filter_3 sh */
    { 13, 36, HBIL_ROLE_WRITE, "HBIL_FAR_BITS" }, /* filter_3 far */
    { 14, 10, HBIL_ROLE_SAMPLE, "" }, /* upsample full_depth */
    { 14, 11, HBIL_ROLE_SAMPLE, "" }, /* upsample full_normal */
    { 14, 12, HBIL_ROLE_SAMPLE, "" }, /* upsample view_depth */
    { 14, 13, HBIL_ROLE_SAMPLE, "" }, /* upsample view_normal */
    { 14, 24, HBIL_ROLE_FROM, "HBIL_FILTER_NONE && HBIL_TEMPORAL_NO" }, /* upsample raw */
    { 14, 25, HBIL_ROLE_FROM, "HBIL_FILTER_NONE && HBIL_TEMPORAL_YES" }, /* upsample signal */
    { 14, 26, HBIL_ROLE_FROM, "!HBIL_FILTER_NONE && !HBIL_FILTER_PASSES_2" }, /* upsample soft */
    { 14, 27, HBIL_ROLE_FROM, "!HBIL_FILTER_NONE && HBIL_FILTER_PASSES_2" }, /* upsample soft_2 */
    { 14, 6, HBIL_ROLE_SAMPLE, "" }, /* upsample f0 */
    { 14, 30, HBIL_ROLE_WRITE, "" }, /* upsample ao */
    { 14, 31, HBIL_ROLE_WRITE, "" }, /* upsample uniform_ao */
    { 14, 32, HBIL_ROLE_WRITE, "" }, /* upsample bent */
    { 14, 34, HBIL_ROLE_WRITE, "" }, /* upsample near */
    { 14, 35, HBIL_ROLE_WRITE, "" }, /* upsample sh */
    { 14, 36, HBIL_ROLE_WRITE, "HBIL_FAR_BITS" }, /* upsample far */
    { 15, 12, HBIL_ROLE_SAMPLE, "" }, /* light view_depth */
    { 15, 13, HBIL_ROLE_SAMPLE, "" }, /* light view_normal */
    { 15, 10, HBIL_ROLE_SAMPLE, "" }, /* light full_depth */
    { 15, 11, HBIL_ROLE_SAMPLE, "" }, /* light full_normal */
    { 15, 30, HBIL_ROLE_SAMPLE, "" }, /* light ao */
    { 15, 32, HBIL_ROLE_SAMPLE, "" }, /* light bent */
    { 15, 34, HBIL_ROLE_SAMPLE, "" }, /* light near */
    { 15, 36, HBIL_ROLE_SAMPLE, "HBIL_FAR_BITS" }, /* light far */
    { 15, 4, HBIL_ROLE_SAMPLE, "" }, /* light direct */
    { 15, 5, HBIL_ROLE_SAMPLE, "" }, /* light albedo */
    { 15, 6, HBIL_ROLE_SAMPLE, "" }, /* light f0 */
    { 15, 7, HBIL_ROLE_SAMPLE, "" }, /* light roughness */
    { 15, 8, HBIL_ROLE_SAMPLE, "" }, /* light sky */
    { 15, 9, HBIL_ROLE_SAMPLE, "" }, /* light probes */
    { 15, 33, HBIL_ROLE_WRITE, "" }, /* light cone */
    { 15, 36, HBIL_ROLE_WRITE, "!HBIL_FAR_BITS" }, /* light far */
    { 15, 37, HBIL_ROLE_WRITE, "" }, /* light irradiance */
    { 15, 38, HBIL_ROLE_WRITE, "" }, /* light specular_occlusion */
    { 15, 39, HBIL_ROLE_WRITE, "" }, /* light multi_bounce */
    { 15, 40, HBIL_ROLE_WRITE, "" }, /* light composite */
    { 15, 29, HBIL_ROLE_WRITE, "" }, /* light bounce */
};
static const struct { uint16_t type; const char *glsl, *name, *meaning; } hbil__uniforms[] = {
    { HBIL_TYPE_VEC4, "vec4", "HBIL_PIXEL_TO_RAY",
      "view xy at depth 1 (perspective) or at any depth (orthographic) = pixel * xy + zw; pixel centres at .5" },
    { HBIL_TYPE_VEC2, "vec2", "HBIL_DEPTH_TO_VIEW",
      "v = d * x + y with d = 1 at the near end: depth = 1/v (perspective) or v (orthographic)" },
    { HBIL_TYPE_IVEC2, "ivec2", "HBIL_SIZE",
      "size of the grid that is marched: render size / downscale, rounded up. pixels" },
    { HBIL_TYPE_IVEC2, "ivec2", "HBIL_FULL_SIZE",
      "render size, where the grid is coarser. pixels" },
    { HBIL_TYPE_MAT3, "mat3", "HBIL_WORLD_TO_VIEW",
      "rotation from world to view space, z into the screen" },
    { HBIL_TYPE_VEC4, "vec4", "HBIL_EYE",
      "xyz position of the eye in the world. m" },
    { HBIL_TYPE_FLOAT, "float", "HBIL_VIEW_Z",
      "z of the camera's forward axis in your view space. -1 right-handed, +1 left-handed" },
    { HBIL_TYPE_UINT, "uint", "HBIL_FRAME_INDEX",
      "frame number, advances the noise" },
    { HBIL_TYPE_VEC4, "vec4", "HBIL_FAR_COLOR",
      "rgb radiance of a constant environment" },
    { HBIL_TYPE_VEC4X4, "vec4x4", "HBIL_FAR_SH1",
      "rgb SH radiance of the environment in world space: Y00 Y1-1 Y10 Y11" },
    { HBIL_TYPE_VEC4X5, "vec4x5", "HBIL_FAR_SH2",
      "rgb SH radiance of the environment in world space: Y2-2 Y2-1 Y20 Y21 Y22" },
    { HBIL_TYPE_VEC4, "vec4", "HBIL_PROBE_ORIGIN",
      "xyz world position of probe (0, 0, 0). m" },
    { HBIL_TYPE_VEC4, "vec4", "HBIL_PROBE_SCALE",
      "xyz probes per metre along each axis" },
    { HBIL_TYPE_VEC4X3, "vec4x3", "HBIL_LAST_FROM_VIEW",
      "rows of the motion from this frame's space to last frame's. m" },
    { HBIL_TYPE_VEC4X3, "vec4x3", "HBIL_VIEW_FROM_LAST",
      "rows of the motion back" },
    { HBIL_TYPE_VEC4, "vec4", "HBIL_LAST_TO_RAY",
      "HBIL_PIXEL_TO_RAY of the last frame" },
    { HBIL_TYPE_IVEC2, "ivec2", "HBIL_LAST_SIZE",
      "HBIL_SIZE of the last frame" },
    { HBIL_TYPE_IVEC2, "ivec2", "HBIL_LAST_FULL_SIZE",
      "HBIL_FULL_SIZE of the last frame" },
    { HBIL_TYPE_INT, "int", "HBIL_RESET",
      "1: nothing of the last frame counts" },
};
/* >>gen passes */

static const struct { const char *glsl; uint16_t size, align; } hbil__types[] = { /* std140, by hbil_type */
    { "", 0, 1 }, { "int", 4, 4 }, { "uint", 4, 4 }, { "float", 4, 4 }, { "vec2", 8, 8 }, { "ivec2", 8, 8 },
    { "vec4", 16, 16 }, { "mat3", 48, 16 }, { "vec4", 48, 16 }, { "vec4", 64, 16 },
    { "vec4", 80, 16 } };
static const char *const hbil__array_ends[] = { "", "", "", "", "", "", "", "", "[3]", "[4]", "[5]" }; /* by hbil_type */
static const char *const hbil__dims[] = { "", "2D", "2DMS", "2DArray", "Cube", "3D" }; /* by hbil_dim */
static const char *const hbil__dim_names[] = { "", "2d", "2d_multisample", "2d_array", "cube", "3d" };
static const struct { uint8_t access, age; const char *name; int named; } hbil__roles[] = { /* by hbil_role; named: <texture> follows */
    { 0, 0, "", 0 }, { HBIL_ACCESS_SAMPLE, 0, "u_", 1 }, { HBIL_ACCESS_WRITE, 0, "u_", 1 }, { HBIL_ACCESS_WRITE, 0, "u_", 1 },
    { HBIL_ACCESS_SAMPLE, 1, "u_last_", 1 }, { HBIL_ACCESS_SAMPLE, 0, "u_from", 0 }, { HBIL_ACCESS_WRITE, 0, "u_to", 0 } };
static const char *const hbil__role_names[] = { "", "sample", "write", "update", "last", "from", "to" };
static const char *const hbil__access_names[] = { "", "sample", "write", "sample+write" };
static const char *const hbil__life_names[] = { "", "input", "output", "transient", "history" };

/* ======================================================================
 * >>glsl       the shader text, a chunk per function
 * ====================================================================== */

/* <<gen glsl       written by `cmake --build build --target embed` from shadergen/glsl: do not edit */
static const char hbil__glsl_triangle_vertex[] =
"void main() {\n"
"    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
"}\n";
static const char hbil__glsl_common_HBIL_SKY[] =
"const float HBIL_SKY = 1e15; // view depth of a pixel without a surface. m\n";
static const char hbil__glsl_common_HBIL_RADIANCE_MAX[] =
"const float HBIL_RADIANCE_MAX = 60000.0; // below the largest half float: history and blends stay finite\n";
static const char hbil__glsl_common_HBIL_PI[] =
"const float HBIL_PI = 3.141592654;\n";
static const char hbil__glsl_common_hbil_texel[] =
"// Where this invocation stands in its grid.\n"
"ivec2 hbil_texel() {\n"
"#if HBIL_STAGE_FRAGMENT\n"
"    return ivec2(gl_FragCoord.xy);\n"
"#else\n"
"    return ivec2(gl_GlobalInvocationID.xy);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_common_hbil_position[] =
"// Point seen at a pixel position (centres at .5) and view depth. m\n"
"vec3 hbil_position(vec2 pixel, float z) {\n"
"    vec2 ray = pixel * HBIL_PIXEL_TO_RAY.xy + HBIL_PIXEL_TO_RAY.zw;\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    return vec3(ray * z, z);\n"
"#else\n"
"    return vec3(ray, z);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_common_hbil_nearness[] =
"// The quantity that is linear on the screen for every plane; larger is nearer.\n"
"float hbil_nearness(float z) {\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    return 1.0 / z;\n"
"#else\n"
"    return -z;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_common_hbil_depth_of[] =
"// View depth of a nearness. m\n"
"float hbil_depth_of(float nearness) {\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    return 1.0 / nearness;\n"
"#else\n"
"    return -nearness;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_common_hbil_view_vector[] =
"// Unit vector from the surface seen at a pixel position to the eye. From the pixel alone: exact at any depth.\n"
"vec3 hbil_view_vector(vec2 pixel) {\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    return -normalize(hbil_position(pixel, 1.0));\n"
"#else\n"
"    return vec3(0.0, 0.0, -1.0);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_common_hbil_finite[] =
"// Radiance that can do no harm: NaN and negative become 0, infinity and fireflies the maximum.\n"
"vec3 hbil_finite(vec3 radiance) {\n"
"    return mix(vec3(0.0), min(radiance, vec3(HBIL_RADIANCE_MAX)), greaterThan(radiance, vec3(0.0)));\n"
"}\n";
static const char hbil__glsl_common_hbil_pack_snorm[] =
"// Two numbers in [-1, 1] as 16 bits each. GLSL 3.30 has no packSnorm2x16.\n"
"uint hbil_pack_snorm(vec2 v) {\n"
"#if HBIL_STAGE_FRAGMENT\n"
"    ivec2 i = ivec2(floor(v * 32767.0 + 0.5));\n"
"    return uint(i.x & 65535) | (uint(i.y) << 16);\n"
"#else\n"
"    return packSnorm2x16(v);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_common_hbil_unpack_snorm[] =
"vec2 hbil_unpack_snorm(uint code) {\n"
"#if HBIL_STAGE_FRAGMENT\n"
"    return vec2(ivec2(int(code) << 16, int(code)) >> 16) / 32767.0;\n"
"#else\n"
"    return unpackSnorm2x16(code);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_common_hbil_encode_normal[] =
"// Octahedral map of a unit vector, 2 x snorm16. Error below 5e-5 rad. Meyer 2010\n"
"uint hbil_encode_normal(vec3 n) {\n"
"    vec2 o = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));\n"
"    vec2 fold = (1.0 - abs(o.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(o, vec2(0.0)));\n"
"    return hbil_pack_snorm(n.z > 0.0 ? fold : o);\n"
"}\n";
static const char hbil__glsl_common_hbil_decode_normal[] =
"vec3 hbil_decode_normal(uint code) {\n"
"    vec2 o = hbil_unpack_snorm(code);\n"
"    vec3 n = vec3(o, abs(o.x) + abs(o.y) - 1.0);\n"
"    float fold = max(n.z, 0.0);\n"
"    n.xy += mix(vec2(fold), vec2(-fold), greaterThanEqual(n.xy, vec2(0.0)));\n"
"    return normalize(n);\n"
"}\n";
static const char hbil__glsl_common_hbil_load_depth[] =
"float hbil_load_depth(ivec2 p) {\n"
"    return texelFetch(u_view_depth, p, 0).r;\n"
"}\n";
static const char hbil__glsl_common_hbil_load_normal[] =
"vec3 hbil_load_normal(ivec2 p) {\n"
"    return hbil_decode_normal(texelFetch(u_view_normal, p, 0).r);\n"
"}\n";
static const char hbil__glsl_common_hbil_direction[] =
"// Unit vector along v, a bent vector; more and more along `other` where so little is left of v that it is rounding.\n"
"vec3 hbil_direction(vec3 v, vec3 other) {\n"
"    return normalize(v + 2e-5 * other);\n"
"}\n";
static const char hbil__glsl_common_hbil_diffuse[] =
"// Part of the light that a surface does not mirror: 1 - F0. Metals get none.\n"
"vec3 hbil_diffuse(ivec2 p) {\n"
"#if HBIL_F0_RGB\n"
"    return 1.0 - min(hbil_finite(texelFetch(u_f0, p, 0).rgb), 1.0);\n"
"#else\n"
"    return 1.0 - min(hbil_finite(texelFetch(u_f0, p, 0).rrr), 1.0);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_common_hbil_load_albedo[] =
"vec3 hbil_load_albedo(ivec2 p) {\n"
"    return min(hbil_finite(texelFetch(u_albedo, p, 0).rgb), vec3(1.0));\n"
"}\n";
static const char hbil__glsl_environment_hbil_to_world[] =
"// Direction from the space of the passes to the world.\n"
"vec3 hbil_to_world(vec3 direction) {\n"
"    return direction * HBIL_WORLD_TO_VIEW; // the transpose of a rotation is its inverse\n"
"}\n";
static const char hbil__glsl_environment_hbil_world_position[] =
"vec3 hbil_world_position(vec3 position) {\n"
"    return hbil_to_world(position) + HBIL_EYE.xyz;\n"
"}\n";
static const char hbil__glsl_environment_hbil_sh[] =
"// Y00, Y1-1, Y10, Y11; Y2-2, Y2-1, Y20, Y21, Y22\n"
"struct hbil_sh {\n"
"    vec3 low[4];\n"
"#if HBIL_SH_ORDER_2\n"
"    vec3 high[5];\n"
"#endif\n"
"};\n";
static const char hbil__glsl_environment_HBIL_SLABS[] =
"#if HBIL_SH_ORDER_2\n"
"const int HBIL_SLABS = 9; // coefficients of a probe\n"
"#else\n"
"const int HBIL_SLABS = 4; // coefficients of a probe\n"
"#endif\n";
static const char hbil__glsl_environment_hbil_load_sh[] =
"#if HBIL_ENVIRONMENT_PROBES\n"
"// Probes around a position in the world, trilinear; beyond the grid its border goes on.\n"
"hbil_sh hbil_load_sh(vec3 position) {\n"
"    hbil_sh sh;\n"
"    vec3 size = vec3(textureSize(u_probes, 0));\n"
"    float slab = size.z / float(HBIL_SLABS);\n"
"    vec3 cell = (position - HBIL_PROBE_ORIGIN.xyz) * HBIL_PROBE_SCALE.xyz;\n"
"    cell = clamp(cell, vec3(0.0), vec3(size.xy, slab) - 1.0) + 0.5; // half a texel from the next slab: none bleeds over\n"
"    for (int k = 0; k < 4; ++k)\n"
"        sh.low[k] = textureLod(u_probes, (cell + vec3(0.0, 0.0, float(k) * slab)) / size, 0.0).rgb;\n"
"#if HBIL_SH_ORDER_2\n"
"    for (int k = 0; k < 5; ++k)\n"
"        sh.high[k] = textureLod(u_probes, (cell + vec3(0.0, 0.0, float(k + 4) * slab)) / size, 0.0).rgb;\n"
"#endif\n"
"    return sh;\n"
"}\n"
"#else\n"
"hbil_sh hbil_load_sh() {\n"
"    hbil_sh sh;\n"
"    for (int k = 0; k < 4; ++k) sh.low[k] = HBIL_FAR_SH1[k].rgb;\n"
"#if HBIL_SH_ORDER_2\n"
"    for (int k = 0; k < 5; ++k) sh.high[k] = HBIL_FAR_SH2[k].rgb;\n"
"#endif\n"
"    return sh;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_environment_hbil_sh_sum[] =
"// Each band at the unit direction d, times a factor: (1, 1, 1) is radiance, (1, 2/3, 1/4) E/pi of an open surface.\n"
"vec3 hbil_sh_sum(hbil_sh sh, vec3 d, vec3 bands) {\n"
"    vec3 sum = 0.282095 * bands.x * sh.low[0];\n"
"    sum += 0.488603 * bands.y * (d.y * sh.low[1] + d.z * sh.low[2] + d.x * sh.low[3]);\n"
"#if HBIL_SH_ORDER_2\n"
"    sum += bands.z * (1.092548 * (d.x * d.y * sh.high[0] + d.y * d.z * sh.high[1] + d.z * d.x * sh.high[3])\n"
"        + 0.315392 * (3.0 * d.z * d.z - 1.0) * sh.high[2] + 0.546274 * (d.x * d.x - d.y * d.y) * sh.high[4]);\n"
"#endif\n"
"    return sum;\n"
"}\n";
static const char hbil__glsl_environment_hbil_cone_bands[] =
"// E/pi of a surface that faces the axis of a cone and sees nothing else. t: cosine of its half angle. Mayaux 2018\n"
"vec3 hbil_cone_bands(float t) {\n"
"    float s2 = 1.0 - t * t;\n"
"    return vec3(s2, (1.0 - t * t * t) * 2.0 / 3.0, 0.25 * s2 * (1.0 + 3.0 * t * t));\n"
"}\n";
static const char hbil__glsl_environment_hbil_cone_cosine[] =
"// Cosine of the half angle of the cone about its normal that has this cosine-weighted visibility.\n"
"float hbil_cone_cosine(float ao) {\n"
"#if HBIL_SEED_COMPAT_CONE_RELATION\n"
"    return 1.0 - ao; // the relation of uniform visibility\n"
"#else\n"
"    return sqrt(1.0 - ao);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_environment_hbil_fit[] =
"// Share of the environment for a visibility.\n"
"float hbil_fit(float ao) {\n"
"#if HBIL_FITTED\n"
"    return ao * (1.0 + 0.5 * exp2(0.75 * log2(max(1.0 - ao, 1e-6)))); // a fit meant for uniform visibility\n"
"#else\n"
"    return ao;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_environment_hbil_opening[] =
"#if HBIL_FAR_HERE\n"
"// The visible part of a pixel's hemisphere, as far light asks for it. World space.\n"
"struct hbil_opening {\n"
"    float ao;\n"
"#if !HBIL_ENVIRONMENT_CONSTANT\n"
"    vec3 axis;     // unit: into its middle, or the normal\n"
"#endif\n"
"#if HBIL_FAR_SH && HBIL_FAR_VISIBILITY_BENT\n"
"    float bent;    // length of the bent vector\n"
"#endif\n"
"#if HBIL_ENVIRONMENT_PROBES || HBIL_ENVIRONMENT_HOOK\n"
"    vec3 position; // of the surface. m\n"
"#endif\n"
"};\n"
"#endif\n";
static const char hbil__glsl_environment_hbil_far[] =
"#if HBIL_FAR_HERE\n"
"// Far irradiance E/pi through an opening.\n"
"vec3 hbil_far(hbil_opening o) {\n"
"#if HBIL_ENVIRONMENT_CONSTANT\n"
"    return hbil_fit(o.ao) * hbil_finite(HBIL_FAR_COLOR.rgb);\n"
"#elif HBIL_ENVIRONMENT_CUBE\n"
"    return hbil_fit(o.ao) * hbil_finite(textureLod(u_sky, o.axis, 0.0).rgb);\n"
"#elif HBIL_ENVIRONMENT_HOOK\n"
"    return hbil_fit(o.ao) * hbil_finite(hbil_far_hook(o.position, o.axis, hbil_cone_cosine(o.ao)));\n"
"#else\n"
"#if HBIL_ENVIRONMENT_PROBES\n"
"    hbil_sh sh = hbil_load_sh(o.position);\n"
"#else\n"
"    hbil_sh sh = hbil_load_sh();\n"
"#endif\n"
"#if HBIL_FAR_VISIBILITY_CONE\n"
"    return hbil_finite(hbil_sh_sum(sh, o.axis, hbil_cone_bands(hbil_cone_cosine(o.ao))));\n"
"#elif HBIL_FAR_VISIBILITY_BENT\n"
"    // exact in bands 0 and 1, whatever is visible; band 2 as through the cone\n"
"    vec3 bands = vec3(o.ao, o.bent, hbil_cone_bands(hbil_cone_cosine(o.ao)).z);\n"
"    return hbil_finite(hbil_sh_sum(sh, o.axis, bands));\n"
"#else\n"
"    return hbil_fit(o.ao) * hbil_finite(hbil_sh_sum(sh, o.axis, vec3(1.0, 2.0 / 3.0, 0.25)));\n"
"#endif\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_lines_hbil_frame_turn[] =
"// Part of the angle between two directions by which all of them are turned. One value for the whole frame: [0, 1)\n"
"float hbil_frame_turn() {\n"
"#if HBIL_NOISE_NONE\n"
"    return 0.5;\n"
"#else\n"
"    return float((2654435769u * HBIL_FRAME_INDEX + 2147483648u) >> 8) / 16777216.0;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_lines_hbil_line[] =
"// Lines of a direction.\n"
"struct hbil_line {\n"
"    vec2 d;       // along them, to larger columns or rows: unit, pixels\n"
"    bool is_row;  // steps go along x, by one pixel each; else along y\n"
"    int  slope;   // of a line, per step and in strides of HBIL_SWEEP_STRIDE pixels, with 16 fractional bits\n"
"};\n";
static const char hbil__glsl_lines_hbil_line_of[] =
"// Direction of HBIL_SLICES * HBIL_SWEEP_STRIDE, from 45 degrees on one side of x to 45 degrees on the other side of y.\n"
"hbil_line hbil_line_of(int direction) {\n"
"    hbil_line l;\n"
"    float turn = (float(direction) + hbil_frame_turn()) / float(HBIL_SLICES * HBIL_SWEEP_STRIDE);\n"
"    float phi = (turn - 0.25) * HBIL_PI;\n"
"    l.d = vec2(cos(phi), sin(phi));\n"
"    l.is_row = turn < 0.5;\n"
"    float slope = l.is_row ? l.d.y / l.d.x : l.d.x / l.d.y;\n"
"    l.slope = int(roundEven(slope * (65536.0 / float(HBIL_SWEEP_STRIDE))));\n"
"    return l;\n"
"}\n";
static const char hbil__glsl_lines_hbil_shift[] =
"// Pixels sideways from where a line begins to its pixel at a step. Whole strides: a line keeps its turn.\n"
"int hbil_shift(hbil_line l, int step) {\n"
"    return HBIL_SWEEP_STRIDE * ((l.slope * step + 32768) >> 16);\n"
"}\n";
static const char hbil__glsl_lines_hbil_across[] =
"// (column, row) to (step, place across), and back.\n"
"ivec2 hbil_across(hbil_line l, ivec2 p) {\n"
"    return l.is_row ? p : p.yx;\n"
"}\n";
static const char hbil__glsl_lines_hbil_pixel[] =
"// Pixel at a step of the line that begins at `start` across.\n"
"ivec2 hbil_pixel(hbil_line l, int start, int step) {\n"
"    return hbil_across(l, ivec2(step, start + hbil_shift(l, step)));\n"
"}\n";
static const char hbil__glsl_lines_hbil_vertex[] =
"// Pixel of a line, and the jump from it to the pixel that makes its horizon.\n"
"struct hbil_vertex {\n"
"    float nearness;\n"
"    int   step;\n"
"    int   back;  // steps of the jump, 0: there is none\n"
"#if HBIL_GATHER\n"
"    float rise;  // of all that stands up below it\n"
"    vec3  light; // mean radiance of that\n"
"#endif\n"
"};\n";
static const char hbil__glsl_lines_hbil_code[] =
"// Low half: steps. High half: rise, as the upper half of a float.\n"
"uint hbil_code(hbil_vertex v) {\n"
"#if HBIL_GATHER\n"
"    return uint(v.back) | ((floatBitsToUint(v.rise) + 0x8000u) & 0xffff0000u);\n"
"#else\n"
"    return uint(v.back);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_lines_hbil_back[] =
"int hbil_back(uint code) {\n"
"#if HBIL_GATHER\n"
"    return int(code & 0xffffu);\n"
"#else\n"
"    return int(code);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_lines_hbil_rise_in[] =
"float hbil_rise_in(uint code) {\n"
"    return uintBitsToFloat(code & 0xffff0000u);\n"
"}\n";
static const char hbil__glsl_lines_hbil_steeper[] =
"// Does the pixel `outward` stand higher over `at` than v, which is nearer to it?\n"
"bool hbil_steeper(hbil_vertex at, hbil_vertex v, int outward, float nearness) {\n"
"    return (nearness - at.nearness) * float(abs(at.step - v.step))\n"
"        > (v.nearness - at.nearness) * float(abs(at.step - outward));\n"
"}\n";
static const char hbil__glsl_lines_hbil_rise[] =
"#if HBIL_GATHER\n"
"// Rise of the line from a pixel to the one before, both by their nearness.\n"
"float hbil_rise(hbil_line l, float from, float before) {\n"
"    // of a surface that is seen at 45 degrees, at depth 1\n"
"    float pitch = length(HBIL_PIXEL_TO_RAY.xy * l.d) / max(abs(l.d.x), abs(l.d.y));\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    pitch *= from;\n"
"#endif\n"
"    return max(before - from + pitch, 0.0);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_lines_hbil_pack_radiance[] =
"// 3 x 9 bits with a common exponent: relative error of the largest channel below 0.002. r in [0, 60000]\n"
"uint hbil_pack_radiance(vec3 r) {\n"
"    float top = max(max(r.r, r.g), r.b) * 1.001; // so that no channel rounds up to 512\n"
"    uint e = uint(clamp(int(floatBitsToUint(top) >> 23) - 111, 0, 31));\n"
"    uvec3 m = uvec3(r * uintBitsToFloat((151u - e) << 23) + 0.5);\n"
"    return m.r | (m.g << 9) | (m.b << 18) | (e << 27);\n"
"}\n";
static const char hbil__glsl_lines_hbil_unpack_radiance[] =
"vec3 hbil_unpack_radiance(uint code) {\n"
"    uvec3 m = (uvec3(code) >> uvec3(0u, 9u, 18u)) & 511u;\n"
"    return vec3(m) * uintBitsToFloat(((code >> 27) + 103u) << 23);\n"
"}\n";
static const char hbil__glsl_levels_HBIL_LEVELS[] =
"const int HBIL_LEVELS = 3; // coarser levels, of 2, 4 and 8 pixels\n";
static const char hbil__glsl_levels_hbil_level_at[] =
"// Texel q of a level. Screens below 16 pixels have level 0 only.\n"
"ivec3 hbil_level_at(ivec2 q, int level) {\n"
"    ivec2 corner = ivec2(level > 1 ? (HBIL_SIZE.x + 1) / 2 : 0, level > 2 ? (HBIL_SIZE.y + 3) / 4 : 0);\n"
"    return ivec3(q + corner, min(level, 1));\n"
"}\n";
static const char hbil__glsl_levels_hbil_levels[] =
"// Levels that the screen has.\n"
"int hbil_levels() {\n"
"    return min(HBIL_SIZE.x, HBIL_SIZE.y) < 16 ? 0 : HBIL_LEVELS;\n"
"}\n";
static const char hbil__glsl_slice_hbil_hilbert[] =
"// Index of a pixel along a Hilbert curve that fills a 64 x 64 tile: neighbours on screen stay close in the sequence.\n"
"uint hbil_hilbert(uvec2 p) {\n"
"    uint index = 0u;\n"
"    for (uint side = 32u; side > 0u; side >>= 1) {\n"
"        uvec2 r = uvec2((p.x & side) != 0u ? 1u : 0u, (p.y & side) != 0u ? 1u : 0u);\n"
"        index += side * side * ((3u * r.x) ^ r.y);\n"
"        if (r.y == 0u) {\n"
"            if (r.x == 1u) p = uvec2(63u) - p;\n"
"            p = p.yx;\n"
"        }\n"
"    }\n"
"    return index;\n"
"}\n";
static const char hbil__glsl_slice_hbil_gradient[] =
"// Interleaved gradient noise in [0, 1). Jimenez 2014\n"
"float hbil_gradient(vec2 p) {\n"
"    return fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715))));\n"
"}\n";
static const char hbil__glsl_slice_hbil_block[] =
"// Place of a pixel in its block of 4 x 4, as in a Bayer matrix: neighbours are far apart in the sequence. [0, 15]\n"
"uint hbil_block(ivec2 p) {\n"
"    uint x = uint(p.x);\n"
"    uint y = uint(p.x ^ p.y);\n"
"    return ((y & 1u) << 3) | ((x & 1u) << 2) | (y & 2u) | ((x & 2u) >> 1);\n"
"}\n";
static const char hbil__glsl_slice_hbil_noise[] =
"// x rotates the slices, y jitters the steps, z the edges of sectors. [0, 1)\n"
"vec3 hbil_noise(ivec2 p) {\n"
"#if HBIL_NOISE_HILBERT_R2\n"
"    // R2 sequence in 32-bit fixed point: exact, the same on every device, for any frame number. Roberts 2018\n"
"#if HBIL_INTERLEAVE_YES\n"
"    uint index = hbil_block(p) + 16u * HBIL_FRAME_INDEX;\n"
"#else\n"
"    uint index = hbil_hilbert(uvec2(p) & 63u) + 288u * HBIL_FRAME_INDEX;\n"
"#endif\n"
"    uvec3 r2 = uvec3(3242174889u, 2447445414u, 2654435769u) * index + 2147483648u;\n"
"    return vec3(r2 >> 8) / 16777216.0;\n"
"#elif HBIL_NOISE_IGN\n"
"#if HBIL_INTERLEAVE_YES\n"
"    p &= 3;\n"
"#endif\n"
"    vec2 q = vec2(p) + 5.588238 * float(HBIL_FRAME_INDEX % 61u);\n"
"    return vec3(hbil_gradient(q), hbil_gradient(q.yx + vec2(47.0, 17.0)), hbil_gradient(q + vec2(31.0, 83.0)));\n"
"#else\n"
"    return vec3(0.5);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_slice_hbil_arc[] =
"// G(c) = acos(c) - c sqrt(1 - c c): twice the integral of sin^2 from the view vector to the horizon, c in [-1, 1].\n"
"// Error 8e-5, monotone: no increment below is negative by more than rounding.\n"
"float hbil_arc(float c) {\n"
"    float a = abs(c);\n"
"    float g = (1.0 - a) * sqrt(1.0 - a) * (1.570796327 + a * (0.354230314 - 0.042259066 * a));\n"
"    return c < 0.0 ? HBIL_PI - g : g;\n"
"}\n";
static const char hbil__glsl_slice_HBIL_STRIDE[] =
"#if HBIL_SAMPLING_BILINEAR\n"
"const float HBIL_STRIDE = 0.125; // first sample, and least distance of two samples. pixels\n"
"#else\n"
"const float HBIL_STRIDE = 1.0; // first sample, and least distance of two samples. pixels\n"
"#endif\n";
static const char hbil__glsl_slice_hbil_offset[] =
"// Distance of the sample t in [0, 1) from the pixel, for a reach of R pixels. pixels, HBIL_STRIDE at t = 0\n"
"float hbil_offset(float t, float reach_px) {\n"
"#if HBIL_SPACING_GEOMETRIC\n"
"    return HBIL_STRIDE * exp2(t * log2(max(reach_px / HBIL_STRIDE, 1.0)));\n"
"#elif HBIL_EXPONENT_1\n"
"    return HBIL_STRIDE + t * (reach_px - HBIL_STRIDE);\n"
"#elif HBIL_EXPONENT_2\n"
"    return HBIL_STRIDE + t * t * (reach_px - HBIL_STRIDE);\n"
"#else\n"
"    return HBIL_STRIDE + exp2(HBIL_EXPONENT * log2(max(t, 1e-6))) * (reach_px - HBIL_STRIDE);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_slice_hbil_border[] =
"// Pixels from p along the unit direction d until the screen ends; a little less, so that rounding leads nowhere\n"
"// outside.\n"
"float hbil_border(ivec2 p, vec2 d) {\n"
"    vec2 room = mix(vec2(p), vec2(HBIL_SIZE - 1 - p), greaterThan(d, vec2(0.0))) + 0.49;\n"
"    vec2 t = room / max(abs(d), vec2(1e-6));\n"
"    return min(t.x, t.y);\n"
"}\n";
static const char hbil__glsl_slice_hbil_reach[] =
"// Pixels along the slice direction D in which the sphere of radius HBIL_REACH around the point shows: the tangent to\n"
"// it from the eye, in the slice. The whole screen if the eye is inside.\n"
"float hbil_reach(vec3 position, vec3 v, vec3 slice) {\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    float s = min(HBIL_REACH * inversesqrt(dot(position, position)), 1.0);\n"
"    vec3 edge = slice * s - v * sqrt(1.0 - s * s);\n"
"    if (s >= 1.0 || edge.z <= 0.0) return 1e6;\n"
"    return length((edge.xy / edge.z - position.xy / position.z) / HBIL_PIXEL_TO_RAY.xy);\n"
"#else\n"
"    return length(HBIL_REACH * slice.xy / HBIL_PIXEL_TO_RAY.xy);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_slice_hbil_receiver[] =
"// What the samples of a pixel have in common.\n"
"struct hbil_receiver {\n"
"    ivec2 pixel;\n"
"    vec3 position; // pulled towards the camera\n"
"    vec3 v;        // to the eye\n"
"    vec3 n;        // n.v >= HBIL_LEAST_NY\n"
"    float ny;      // n.v, the same in every slice\n"
"#if HBIL_FAR_BITS && HBIL_FAR_SH\n"
"    hbil_sh sh;    // environment around it\n"
"#endif\n"
"};\n";
static const char hbil__glsl_slice_HBIL_LEAST_NY[] =
"const float HBIL_LEAST_NY = 0.001; // of the cosine of normal and view vector; a turned normal darkens planes\n";
static const char hbil__glsl_slice_hbil_turned[] =
"// A shading normal may face away from the eye (interpolated, bumped): it is turned until it does not, since the\n"
"// horizons of a slice then lie on both sides of V, which all closed forms below rely on.\n"
"vec3 hbil_turned(vec3 n, vec3 v) {\n"
"    float ny = dot(n, v);\n"
"    return ny < HBIL_LEAST_NY ? normalize(n + (HBIL_LEAST_NY - ny) * v) : n;\n"
"}\n";
static const char hbil__glsl_slice_hbil_receive[] =
"hbil_receiver hbil_receive(ivec2 p, float z) {\n"
"    hbil_receiver r;\n"
"    r.pixel = p;\n"
"    r.position = hbil_position(vec2(p) + 0.5, z - HBIL_PULL * abs(z));\n"
"    r.v = hbil_view_vector(vec2(p) + 0.5);\n"
"    r.n = hbil_turned(hbil_load_normal(p), r.v);\n"
"    r.ny = dot(r.n, r.v);\n"
"#if HBIL_FAR_BITS && HBIL_ENVIRONMENT_PROBES\n"
"    r.sh = hbil_load_sh(hbil_world_position(r.position));\n"
"#elif HBIL_FAR_BITS && HBIL_ENVIRONMENT_SH\n"
"    r.sh = hbil_load_sh();\n"
"#endif\n"
"    return r;\n"
"}\n";
static const char hbil__glsl_slice_hbil_surface_depth[] =
"#if HBIL_SAMPLING_BILINEAR\n"
"// Depth of the surface between four pixel centres: bilinear in nearness, so that planes are exact. HBIL_SKY where a\n"
"// corner is sky or off the screen.\n"
"float hbil_surface_depth(vec2 pixel) {\n"
"    ivec2 p = ivec2(floor(pixel - 0.5));\n"
"    vec2 f = pixel - 0.5 - vec2(p);\n"
"    if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p + 1, HBIL_SIZE))) return HBIL_SKY;\n"
"    vec4 z = vec4(hbil_load_depth(p), hbil_load_depth(p + ivec2(1, 0)),\n"
"        hbil_load_depth(p + ivec2(0, 1)), hbil_load_depth(p + ivec2(1, 1)));\n"
"    if (max(max(z.x, z.y), max(z.z, z.w)) >= HBIL_SKY) return HBIL_SKY;\n"
"    return hbil_depth_of(mix(mix(hbil_nearness(z.x), hbil_nearness(z.y), f.x),\n"
"        mix(hbil_nearness(z.z), hbil_nearness(z.w), f.x), f.y));\n"
"}\n"
"#endif\n";
static const char hbil__glsl_slice_hbil_side[] =
"// One side of a slice.\n"
"struct hbil_side {\n"
"    vec3 tangent;   // D, or -D for the back\n"
"#if HBIL_SWEPT\n"
"    hbil_line line;\n"
"#endif\n"
"#if HBIL_SAMPLED\n"
"    vec2 d;         // its direction on the screen, unit\n"
"    float reach_px; // pixels to search\n"
"    float jitter;\n"
"#endif\n"
"#if !HBIL_ESTIMATOR_HBAO_PLUS\n"
"    float nx;       // normal along the tangent\n"
"    float c0;       // horizon of the tangent plane, where the search starts\n"
"#endif\n"
"};\n";
static const char hbil__glsl_slice_hbil_side_of[] =
"#if HBIL_MARCH_SWEEP\n"
"hbil_side hbil_side_of(hbil_receiver r, vec3 slice, hbil_line line) {\n"
"    hbil_side s;\n"
"    s.tangent = slice;\n"
"    s.line = line;\n"
"#else\n"
"// back: -1 for the side of -D, 1 for the other one.\n"
"hbil_side hbil_side_of(hbil_receiver r, vec3 slice, vec2 d, float jitter, float back) {\n"
"    hbil_side s;\n"
"    s.tangent = back * slice;\n"
"    s.d = back * d;\n"
"    s.reach_px = hbil_border(r.pixel, s.d);\n"
"#if !HBIL_REACH_0\n"
"    s.reach_px = min(s.reach_px, hbil_reach(r.position, r.v, s.tangent));\n"
"#endif\n"
"    s.jitter = jitter;\n"
"#endif\n"
"#if !HBIL_ESTIMATOR_HBAO_PLUS\n"
"    s.nx = dot(r.n, s.tangent);\n"
"    s.c0 = -s.nx * inversesqrt(s.nx * s.nx + r.ny * r.ny); // short of 1 by 5e-7, since ny is at least HBIL_LEAST_NY\n"
"#endif\n"
"    return s;\n"
"}\n";
static const char hbil__glsl_slice_hbil_horizon_at[] =
"#if HBIL_SWEPT\n"
"// Horizon that pixel q makes on a side.\n"
"float hbil_horizon_at(hbil_receiver r, hbil_side s, ivec2 q) {\n"
"    vec3 h = hbil_position(vec2(q) + 0.5, hbil_load_depth(q)) - r.position;\n"
"    float inv = inversesqrt(max(dot(h, h), 1e-30));\n"
"    float c = clamp(dot(h, r.v) * inv, -1.0, 1.0);\n"
"    return c > s.c0 && dot(r.n, h) * inv > HBIL_BIAS ? c : s.c0;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_slice_hbil_swept[] =
"#if HBIL_MARCH_SWEEP\n"
"// Horizon that the sweep found on a side: layer 0 or 1 of its slice. One depth to load, and the mean radiance of what\n"
"// it hides.\n"
"#if HBIL_GATHER\n"
"float hbil_swept(hbil_receiver r, hbil_side s, int layer, out vec3 radiance) {\n"
"    radiance = hbil_unpack_radiance(texelFetch(u_swept_light, ivec3(r.pixel, layer), 0).r);\n"
"#else\n"
"float hbil_swept(hbil_receiver r, hbil_side s, int layer) {\n"
"#endif\n"
"    int back = hbil_back(texelFetch(u_swept, ivec3(r.pixel, layer), 0).r);\n"
"    ivec2 from = hbil_across(s.line, r.pixel);\n"
"    int to = layer % 2 == 0 ? from.x + back : from.x - back;\n"
"    return hbil_horizon_at(r, s, hbil_pixel(s.line, from.y - hbil_shift(s.line, from.x), to)); // not at itself\n"
"}\n"
"#elif HBIL_MARCH_BOTH\n"
"// Horizon of all beyond the samples on a side: the hull of the pixel where they end, as seen from the receiver. Layer\n"
"// 0 or 1 of its slice.\n"
"#if HBIL_GATHER\n"
"float hbil_swept(hbil_receiver r, hbil_side s, int layer, out vec3 radiance) {\n"
"    radiance = vec3(0.0);\n"
"#else\n"
"float hbil_swept(hbil_receiver r, hbil_side s, int layer) {\n"
"#endif\n"
"    ivec2 from = hbil_across(s.line, r.pixel);\n"
"    int start = from.y - hbil_shift(s.line, from.x);\n"
"    int way = layer % 2 == 0 ? 1 : -1;\n"
"    hbil_vertex at;\n"
"    at.nearness = hbil_nearness(r.position.z);\n"
"    at.step = from.x;\n"
"    hbil_vertex v;\n"
"    v.step = from.x + way * (1 + int(s.reach_px * max(abs(s.line.d.x), abs(s.line.d.y))));\n"
"    ivec2 q = hbil_pixel(s.line, start, v.step);\n"
"    if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_SIZE))) return s.c0;\n"
"    uint code = texelFetch(u_swept, ivec3(q, layer), 0).r;\n"
"    float z = hbil_load_depth(q);\n"
"    if (z >= HBIL_SKY) { // on to the next surface\n"
"        v.step += way * hbil_back(code);\n"
"        q = hbil_pixel(s.line, start, v.step);\n"
"        if (hbil_back(code) == 0) return s.c0;\n"
"        code = texelFetch(u_swept, ivec3(q, layer), 0).r;\n"
"        z = hbil_load_depth(q);\n"
"    }\n"
"    v.nearness = hbil_nearness(z);\n"
"#if HBIL_GATHER\n"
"    at.rise = hbil_rise(s.line, at.nearness, v.nearness);\n"
"    radiance = hbil_unpack_radiance(texelFetch(u_view_radiance, q, 0).r);\n"
"    at.light = at.rise * radiance;\n"
"#endif\n"
"    while (hbil_back(code) != 0) {\n"
"        int outward = v.step + way * hbil_back(code);\n"
"        ivec2 next = hbil_pixel(s.line, start, outward);\n"
"        float nearness = hbil_nearness(hbil_load_depth(next));\n"
"        if (!hbil_steeper(at, v, outward, nearness)) break;\n"
"#if HBIL_GATHER\n"
"        v.rise = hbil_rise_in(code);\n"
"        at.rise += v.rise;\n"
"        at.light += v.rise * hbil_unpack_radiance(texelFetch(u_swept_light, ivec3(q, layer), 0).r);\n"
"#endif\n"
"        v.nearness = nearness;\n"
"        v.step = outward;\n"
"        q = next;\n"
"        code = texelFetch(u_swept, ivec3(q, layer), 0).r;\n"
"    }\n"
"#if HBIL_GATHER\n"
"    if (at.rise > 0.0) radiance = at.light / at.rise;\n"
"#endif\n"
"    return hbil_horizon_at(r, s, q);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_slice_hbil_visit[] =
"// Where a side's search is.\n"
"struct hbil_visit {\n"
"    float offset; // pixels from the receiver\n"
"    vec2 pixel;   // centres at .5\n"
"    float z;      // depth of the surface there, HBIL_SKY if there is none. m\n"
"#if HBIL_MIPS\n"
"    int level;    // that it was read from\n"
"#endif\n"
"};\n";
static const char hbil__glsl_slice_hbil_start[] =
"// The receiver itself.\n"
"hbil_visit hbil_start(hbil_receiver r) {\n"
"    hbil_visit at;\n"
"    at.offset = 0.0;\n"
"    at.pixel = vec2(r.pixel) + 0.5;\n"
"    at.z = HBIL_SKY;\n"
"#if HBIL_MIPS\n"
"    at.level = 0;\n"
"#endif\n"
"    return at;\n"
"}\n";
static const char hbil__glsl_slice_HBIL_FINE[] =
"const float HBIL_FINE = 4.0; // distance of a sample, in texels, from which on it reads the next coarser level\n";
static const char hbil__glsl_slice_hbil_go[] =
"// On to sample i: never the receiver itself, never one place twice. false: the side has ended.\n"
"bool hbil_go(hbil_receiver r, hbil_side s, int i, inout hbil_visit at) {\n"
"    at.offset = max(hbil_offset((float(i) + s.jitter) / float(HBIL_STEPS), s.reach_px), at.offset + HBIL_STRIDE);\n"
"    if (at.offset > s.reach_px) return false;\n"
"#if HBIL_SAMPLING_BILINEAR\n"
"    at.pixel = vec2(r.pixel) + 0.5 + at.offset * s.d;\n"
"    at.z = hbil_surface_depth(at.pixel);\n"
"#else\n"
"    ivec2 q = r.pixel + ivec2(floor(at.offset * s.d + 0.5));\n"
"#if HBIL_MIPS\n"
"    at.level = clamp(int(log2(at.offset / HBIL_FINE)), 0, hbil_levels());\n"
"    q >>= at.level;\n"
"    at.pixel = (vec2(q) + 0.5) * float(1 << at.level);\n"
"    at.z = texelFetch(u_depth_mips, hbil_level_at(q, at.level), 0).r;\n"
"#else\n"
"    at.pixel = vec2(q) + 0.5;\n"
"    at.z = hbil_load_depth(q);\n"
"#endif\n"
"#endif\n"
"    return true;\n"
"}\n";
static const char hbil__glsl_slice_hbil_fade[] =
"#if !HBIL_REACH_0\n"
"// What is left of an occluder at a distance. [0, 1]\n"
"float hbil_fade(float distance) {\n"
"    return clamp((1.0 - distance / HBIL_REACH) / HBIL_FALLOFF, 0.0, 1.0);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_slice_hbil_normal_at[] =
"// Normal of the surface that a sample sees. The middle of a coarser texel may lie beyond the screen.\n"
"vec3 hbil_normal_at(hbil_visit at) {\n"
"#if HBIL_MIPS\n"
"    return hbil_load_normal(min(ivec2(at.pixel), HBIL_SIZE - 1));\n"
"#else\n"
"    return hbil_load_normal(ivec2(at.pixel));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_slice_hbil_load_radiance[] =
"vec3 hbil_load_radiance(ivec2 p) {\n"
"    vec3 radiance = hbil_finite(texelFetch(u_radiance, p, 0).rgb);\n"
"#if !HBIL_FIREFLY_0\n"
"    radiance *= min(1.0, HBIL_FIREFLY / max(max(radiance.r, max(radiance.g, radiance.b)), 1e-30));\n"
"#endif\n"
"    return radiance;\n"
"}\n";
static const char hbil__glsl_slice_hbil_radiance_at[] =
"// Light of the surface that a sample sees.\n"
"#if HBIL_MIPS\n"
"vec3 hbil_radiance_at(hbil_visit at) {\n"
"    ivec2 q = ivec2(at.pixel) >> at.level;\n"
"    return hbil_unpack_radiance(texelFetch(u_radiance_mips, hbil_level_at(q, at.level), 0).r);\n"
"}\n"
"#elif HBIL_PACKED\n"
"vec3 hbil_radiance_at(hbil_visit at) {\n"
"    return hbil_unpack_radiance(texelFetch(u_view_radiance, ivec2(at.pixel), 0).r);\n"
"}\n"
"#else\n"
"vec3 hbil_radiance_at(hbil_visit at) {\n"
"    return hbil_load_radiance(ivec2(at.pixel));\n"
"}\n"
"#endif\n";
static const char hbil__glsl_slice_HBIL_FILTER_LOW[] =
"const float HBIL_FILTER_LOW = -0.1; // cosine at a source up to which it faces away; Mayaux 2018 gives no value\n";
static const char hbil__glsl_slice_HBIL_FILTER_HIGH[] =
"const float HBIL_FILTER_HIGH = 0.1; // and from which on it faces the receiver\n";
static const char hbil__glsl_slice_hbil_source[] =
"#if HBIL_FACING_FILTER\n"
"// Light that a sample sees along the unit vector `along`. A surface that faces away hides what is behind it, but is\n"
"// not what lights the receiver: the last light that was accepted stands in.\n"
"vec3 hbil_source(hbil_visit at, vec3 along, inout vec3 accepted) {\n"
"    float t = smoothstep(HBIL_FILTER_LOW, HBIL_FILTER_HIGH, -dot(hbil_normal_at(at), along));\n"
"    accepted = mix(accepted, hbil_radiance_at(at), t);\n"
"    return accepted;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_slice_hbil_sums[] =
"// Sums over the slices.\n"
"struct hbil_sums {\n"
"#if HBIL_SWEPT\n"
"    float weight;  // azimuth that the slices stand for, up to a factor\n"
"#endif\n"
"#if !HBIL_COSINE\n"
"    float hidden; // part that is occluded, as the estimator weighs it\n"
"#endif\n"
"#if HBIL_SUMS\n"
"    float full;    // light of an open sky\n"
"    float blocked; // the part of it that is hidden\n"
"#endif\n"
"#if HBIL_NEAR_LIGHT\n"
"    vec3 near;     // what comes from there instead\n"
"#endif\n"
"#if HBIL_BENT\n"
"    vec3 bent;\n"
"#endif\n"
"#if HBIL_OUTPUTS_UNIFORM_AO\n"
"    float uniform_open;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    vec4 sh_0;     // rgb near radiance, a visibility: integrals over solid angle, of 1\n"
"    vec4 sh_x;     // and of the direction's components\n"
"    vec4 sh_y;\n"
"    vec4 sh_z;\n"
"#endif\n"
"#if HBIL_FAR_BITS\n"
"    vec3 far;\n"
"#endif\n"
"};\n";
static const char hbil__glsl_slice_hbil_add_moments[] =
"#if HBIL_OUTPUTS_SH\n"
"// Directions that add up to m, seen with the given rgb radiance and a visibility.\n"
"void hbil_add_moments(vec3 m, vec4 seen, inout hbil_sums sum) {\n"
"    sum.sh_x += m.x * seen;\n"
"    sum.sh_y += m.y * seen;\n"
"    sum.sh_z += m.z * seen;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_horizon_hbil_light[] =
"#if HBIL_GATHER\n"
"// Light of a side. Its weight is the dot product of (nx, ny) with its moments, so one set of arcs gives both.\n"
"struct hbil_light {\n"
"#if HBIL_MEAN_LIGHT\n"
"    vec3 mean; // radiance of what stands in front, of which a horizon takes its share\n"
"#else\n"
"#if HBIL_NEAR_LIGHT\n"
"    vec3 near;\n"
"#if !HBIL_FACING_HALF_SPACE\n"
"    float arc; // hbil_arc of the horizon\n"
"#endif\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    vec3 sh_0; // integrals of L |sin|, L sin |sin|, L cos |sin| over the angle\n"
"    vec3 sh_x;\n"
"    vec3 sh_y;\n"
"#endif\n"
"#endif\n"
"#if HBIL_FACING_FILTER\n"
"    vec3 accepted;\n"
"#endif\n"
"};\n"
"#endif\n";
static const char hbil__glsl_horizon_hbil_dark[] =
"#if HBIL_GATHER\n"
"hbil_light hbil_dark(float c0) {\n"
"    hbil_light light;\n"
"#if HBIL_MEAN_LIGHT\n"
"    light.mean = vec3(0.0);\n"
"#else\n"
"#if HBIL_NEAR_LIGHT\n"
"    light.near = vec3(0.0);\n"
"#if !HBIL_FACING_HALF_SPACE\n"
"    light.arc = hbil_arc(c0);\n"
"#endif\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    light.sh_0 = vec3(0.0);\n"
"    light.sh_x = vec3(0.0);\n"
"    light.sh_y = vec3(0.0);\n"
"#endif\n"
"#endif\n"
"#if HBIL_FACING_FILTER\n"
"    light.accepted = vec3(0.0);\n"
"#endif\n"
"    return light;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_horizon_hbil_weight[] =
"// Share of a Lambertian surface's light that comes from between the horizons c and higher >= c.\n"
"float hbil_weight(float nx, float ny, float c, float higher) {\n"
"    return max(0.5 * (nx * (hbil_arc(c) - hbil_arc(higher)) + ny * (higher - c) * (higher + c)), 0.0);\n"
"}\n";
static const char hbil__glsl_horizon_hbil_lit[] =
"#if HBIL_FACING_HALF_SPACE\n"
"// The part of the arc between horizons arc.x and arc.y from where the front of a source can be seen: w . normal < 0.\n"
"vec2 hbil_lit(hbil_receiver r, hbil_side s, vec3 normal, vec2 arc) {\n"
"    float x = dot(normal, s.tangent);\n"
"    float y = dot(normal, r.v);\n"
"    // min: an inverse root may be too large, and no arc is defined beyond 1\n"
"    float edge = min((y < 0.0 ? x : -x) * inversesqrt(max(x * x + y * y, 1e-20)), 1.0);\n"
"    if (y < 0.0) arc.x = max(arc.x, edge);\n"
"    else arc.y = min(arc.y, edge);\n"
"    arc.y = max(arc.x, arc.y);\n"
"    return arc;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_horizon_hbil_add_arc[] =
"#if HBIL_GATHER\n"
"// Add the light of a sample, seen along the unit vector `along`, through the arc between the horizons c and higher.\n"
"void hbil_add_arc(hbil_receiver r, hbil_side s, hbil_visit at, vec3 along, float c, float higher,\n"
"        inout hbil_light light) {\n"
"#if HBIL_FACING_FILTER\n"
"    vec3 radiance = hbil_source(at, along, light.accepted);\n"
"#else\n"
"    vec3 radiance = hbil_radiance_at(at);\n"
"#endif\n"
"    vec2 arc = vec2(c, higher);\n"
"#if HBIL_FACING_HALF_SPACE\n"
"    arc = hbil_lit(r, s, hbil_normal_at(at), arc);\n"
"#endif\n"
"#if HBIL_OCCLUDER_HEURISTIC\n"
"    float before = hbil_weight(s.nx, r.ny, s.c0, c);\n"
"    float all = before + hbil_weight(s.nx, r.ny, c, higher);\n"
"    light.mean = (light.mean * before + radiance * hbil_weight(s.nx, r.ny, arc.x, arc.y)) / max(all, 1e-20);\n"
"#else\n"
"#if HBIL_NEAR_LIGHT && HBIL_FACING_HALF_SPACE\n"
"    light.near += hbil_weight(s.nx, r.ny, arc.x, arc.y) * radiance;\n"
"#elif HBIL_NEAR_LIGHT\n"
"    // half an arc of the horizon is known from the rise before\n"
"    float next = hbil_arc(higher);\n"
"    light.near += max(0.5 * (s.nx * (light.arc - next) + r.ny * (higher - c) * (higher + c)), 0.0) * radiance;\n"
"    light.arc = next;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    light.sh_0 += (arc.y - arc.x) * radiance;\n"
"    light.sh_x += 0.5 * (hbil_arc(arc.x) - hbil_arc(arc.y)) * radiance;\n"
"    light.sh_y += 0.5 * (arc.y - arc.x) * (arc.y + arc.x) * radiance;\n"
"#endif\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_horizon_hbil_step[] =
"#if HBIL_SAMPLING_BILINEAR && HBIL_GATHER\n"
"// From the sample before to this one: where on the screen, and the nearness of the surface at both ends.\n"
"struct hbil_step {\n"
"    vec2 to;\n"
"    vec2 way;\n"
"    float from_nearness; // -1e30: no surface there\n"
"    float to_nearness;\n"
"};\n"
"#endif\n";
static const char hbil__glsl_horizon_hbil_add_corner[] =
"#if HBIL_SAMPLING_BILINEAR && HBIL_GATHER\n"
"// Light of one corner of the cell around a sample. It stands in front of the rays from c up to the one that meets the\n"
"// surface where that is as near as the corner; the nearest corner (depth z_top) in front of all. Moves c there.\n"
"void hbil_add_corner(hbil_receiver r, hbil_side s, hbil_step step, ivec2 q, float z_top, float c_sample, inout float c,\n"
"        inout hbil_light light) {\n"
"    float z = hbil_load_depth(q);\n"
"    float rise = step.to_nearness - step.from_nearness;\n"
"    float t = rise > 0.0 ? clamp((hbil_nearness(z) - step.from_nearness) / rise, 0.0, 1.0) : 1.0;\n"
"    vec3 h = hbil_position(step.to - (1.0 - t) * step.way, z) - r.position;\n"
"    vec3 along = h * inversesqrt(max(dot(h, h), 1e-30));\n"
"    float low = c;\n"
"    c = z <= z_top ? c_sample : clamp(dot(along, r.v), c, c_sample);\n"
"    hbil_visit at;\n"
"    at.pixel = vec2(q) + 0.5;\n"
"    hbil_add_arc(r, s, at, along, low, c, light);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_horizon_hbil_add_cell[] =
"#if HBIL_SAMPLING_BILINEAR && HBIL_GATHER\n"
"// Light through the arc between the horizons c and c_sample: each ray gets that of the nearest of the four corners that\n"
"// stand in front of it.\n"
"void hbil_add_cell(hbil_receiver r, hbil_side s, hbil_step step, float c, float c_sample, inout hbil_light light) {\n"
"    ivec2 q = ivec2(step.to);\n"
"    vec2 f = step.to - floor(step.to) - 0.5;\n"
"    ivec2 x = ivec2(f.x < 0.0 ? -1 : 1, 0);\n"
"    ivec2 y = ivec2(0, f.y < 0.0 ? -1 : 1);\n"
"    ivec2 second = abs(f.x) > abs(f.y) ? x : y;\n"
"    float z_top = min(min(hbil_load_depth(q), hbil_load_depth(q + x)),\n"
"        min(hbil_load_depth(q + y), hbil_load_depth(q + x + y)));\n"
"    hbil_add_corner(r, s, step, q, z_top, c_sample, c, light);\n"
"    hbil_add_corner(r, s, step, q + second, z_top, c_sample, c, light);\n"
"    hbil_add_corner(r, s, step, q + x + y - second, z_top, c_sample, c, light);\n"
"    hbil_add_corner(r, s, step, q + x + y, z_top, c_sample, c, light);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_horizon_HBIL_DECAY_STEPS[] =
"const float HBIL_DECAY_STEPS = 8.0; // steps per side for which HBIL_DECAY is meant\n";
static const char hbil__glsl_horizon_hbil_horizon[] =
"// Highest horizon on one side of a slice, from that of the tangent plane on. Each rise adds the light of the arc that\n"
"// the sample fills.\n"
"#if HBIL_GATHER\n"
"float hbil_horizon(hbil_receiver r, hbil_side s, inout hbil_light light) {\n"
"#else\n"
"float hbil_horizon(hbil_receiver r, hbil_side s) {\n"
"#endif\n"
"    float c = s.c0;\n"
"    hbil_visit at = hbil_start(r);\n"
"#if HBIL_GATHER_SIDE && HBIL_GATHER\n"
"    hbil_visit top = at; // what makes the horizon\n"
"#elif HBIL_SAMPLING_BILINEAR && HBIL_GATHER\n"
"    hbil_step step;\n"
"    step.to = at.pixel;\n"
"    step.to_nearness = hbil_nearness(r.position.z);\n"
"#endif\n"
"#if HBIL_OCCLUDER_HEURISTIC\n"
"    // the same per side, whatever the number of steps\n"
"    float sink = 1.0 - exp2(log2(1.0 - HBIL_DECAY) * HBIL_DECAY_STEPS / float(HBIL_STEPS));\n"
"#endif\n"
"    for (int i = 0; i < HBIL_STEPS; ++i) {\n"
"        if (!hbil_go(r, s, i, at)) break;\n"
"#if HBIL_SAMPLING_BILINEAR && HBIL_GATHER && !HBIL_GATHER_SIDE\n"
"        step.way = at.pixel - step.to;\n"
"        step.to = at.pixel;\n"
"        step.from_nearness = step.to_nearness;\n"
"        step.to_nearness = at.z < HBIL_SKY ? hbil_nearness(at.z) : -1e30;\n"
"#endif\n"
"        if (at.z >= HBIL_SKY) continue;\n"
"        vec3 h = hbil_position(at.pixel, at.z) - r.position;\n"
"        float l2 = max(dot(h, h), 1e-30);\n"
"        float inv = inversesqrt(l2);\n"
"        // at silhouettes h is nearly parallel to v and rounding takes the cosine above 1\n"
"        float c_sample = clamp(dot(h, r.v) * inv, -1.0, 1.0);\n"
"#if !HBIL_REACH_0\n"
"        // fade the horizon, not its weight: near + ao stays 1\n"
"        c_sample = mix(s.c0, c_sample, hbil_fade(l2 * inv));\n"
"#endif\n"
"        if (c_sample > c && dot(r.n, h) * inv > HBIL_BIAS) {\n"
"#if HBIL_GATHER_SIDE && HBIL_GATHER\n"
"            top = at;\n"
"#elif HBIL_GATHER\n"
"#if HBIL_SAMPLING_BILINEAR\n"
"            hbil_add_cell(r, s, step, c, c_sample, light);\n"
"#else\n"
"            hbil_add_arc(r, s, at, h * inv, c, c_sample, light);\n"
"#endif\n"
"#endif\n"
"            c = c_sample;\n"
"        }\n"
"#if HBIL_OCCLUDER_HEURISTIC\n"
"        else c = max(s.c0, mix(c, min(c, c_sample), sink));\n"
"#endif\n"
"    }\n"
"#if HBIL_GATHER_SIDE && HBIL_GATHER\n"
"    light.mean = hbil_radiance_at(top);\n"
"#if HBIL_FACING_HALF_SPACE\n"
"    vec2 arc = hbil_lit(r, s, hbil_normal_at(top), vec2(s.c0, c));\n"
"    light.mean *= hbil_weight(s.nx, r.ny, arc.x, arc.y) / max(hbil_weight(s.nx, r.ny, s.c0, c), 1e-20);\n"
"#endif\n"
"#endif\n"
"    return c;\n"
"}\n";
static const char hbil__glsl_horizon_hbil_bent[] =
"// Cosine-weighted bent vector of a slice with horizons cf, cb: x along D, y along V.\n"
"#if HBIL_BENT\n"
"vec2 hbil_bent(float nx, float ny, float cf, float cb) {\n"
"#if HBIL_SEED_COMPAT_UNIFORM_BENT\n"
"    return 0.5 * vec2(hbil_arc(cf) - hbil_arc(cb), 2.0 - cf * cf - cb * cb);\n"
"#else\n"
"    float sf2 = 1.0 - cf * cf;\n"
"    float sb2 = 1.0 - cb * cb;\n"
"    float s3 = sf2 * sqrt(sf2) - sb2 * sqrt(sb2);\n"
"    float c3 = cf * cf * cf + cb * cb * cb;\n"
"    return vec2(nx * (c3 - 3.0 * (cf + cb) + 4.0) + ny * s3, nx * s3 + ny * (2.0 - c3)) / 3.0;\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_horizon_hbil_add_light[] =
"#if HBIL_GATHER\n"
"// The light of a side into the sums; c: its horizon.\n"
"void hbil_add_light(hbil_receiver r, hbil_side s, hbil_light light, float c, inout hbil_sums sum) {\n"
"#if HBIL_MEAN_LIGHT\n"
"#if HBIL_NEAR_LIGHT\n"
"    sum.near += light.mean * hbil_weight(s.nx, r.ny, s.c0, c);\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    vec2 moments = 0.5 * vec2(hbil_arc(s.c0) - hbil_arc(c), (c - s.c0) * (c + s.c0));\n"
"    sum.sh_0.rgb += (c - s.c0) * light.mean;\n"
"    hbil_add_moments(s.tangent * moments.x + r.v * moments.y, vec4(light.mean, 0.0), sum);\n"
"#endif\n"
"#else\n"
"#if HBIL_NEAR_LIGHT\n"
"    sum.near += light.near;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    sum.sh_0.rgb += light.sh_0;\n"
"    hbil_add_moments(s.tangent, vec4(light.sh_x, 0.0), sum);\n"
"    hbil_add_moments(r.v, vec4(light.sh_y, 0.0), sum);\n"
"#endif\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_horizon_hbil_horizon_slice[] =
"// Add the slice with tangent D and screen direction d.\n"
"#if HBIL_MARCH_SWEEP\n"
"void hbil_horizon_slice(hbil_receiver r, vec3 slice, hbil_line line, int i, inout hbil_sums sum) {\n"
"    hbil_side front = hbil_side_of(r, slice, line);\n"
"    hbil_side back = front;\n"
"    back.tangent = -front.tangent;\n"
"    back.nx = -front.nx;\n"
"    back.c0 = -front.c0;\n"
"#else\n"
"void hbil_horizon_slice(hbil_receiver r, vec3 slice, vec2 d, float jitter, inout hbil_sums sum) {\n"
"    hbil_side front = hbil_side_of(r, slice, d, jitter, 1.0);\n"
"    hbil_side back = hbil_side_of(r, slice, d, jitter, -1.0);\n"
"#endif\n"
"    float nx = front.nx;\n"
"#if HBIL_MARCH_SWEEP && HBIL_GATHER\n"
"    hbil_light light;\n"
"    float cf = hbil_swept(r, front, 2 * i, light.mean);\n"
"    hbil_add_light(r, front, light, cf, sum);\n"
"    float cb = hbil_swept(r, back, 2 * i + 1, light.mean);\n"
"    hbil_add_light(r, back, light, cb, sum);\n"
"#elif HBIL_MARCH_SWEEP\n"
"    float cf = hbil_swept(r, front, 2 * i);\n"
"    float cb = hbil_swept(r, back, 2 * i + 1);\n"
"#elif HBIL_GATHER\n"
"    hbil_light light = hbil_dark(front.c0);\n"
"    float cf = hbil_horizon(r, front, light);\n"
"    hbil_add_light(r, front, light, cf, sum);\n"
"    light = hbil_dark(back.c0);\n"
"    float cb = hbil_horizon(r, back, light);\n"
"    hbil_add_light(r, back, light, cb, sum);\n"
"#else\n"
"    float cf = hbil_horizon(r, front);\n"
"    float cb = hbil_horizon(r, back);\n"
"#endif\n"
"#if HBIL_SUMS\n"
"    float g0 = hbil_arc(front.c0);\n"
"    sum.full += nx * (g0 - 0.5 * HBIL_PI) + r.ny * (1.0 - front.c0 * front.c0);\n"
"    sum.blocked += 0.5 * (nx * (2.0 * g0 - HBIL_PI - hbil_arc(cf) + hbil_arc(cb))\n"
"        + r.ny * (cf * cf + cb * cb - 2.0 * front.c0 * front.c0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_UNIFORM_AO\n"
"    sum.uniform_open += 0.5 * (2.0 - cf - cb);\n"
"#endif\n"
"#if HBIL_BENT\n"
"    vec2 b = hbil_bent(nx, r.ny, cf, cb);\n"
"    sum.bent += b.x * slice + b.y * r.v;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    sum.sh_0.a += 2.0 - cf - cb;\n"
"    vec2 open = 0.5 * vec2(hbil_arc(cf) - hbil_arc(cb), 2.0 - cf * cf - cb * cb);\n"
"    hbil_add_moments(open.x * slice + open.y * r.v, vec4(0.0, 0.0, 0.0, 1.0), sum);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_fan[] =
"// A slice as its sectors lie.\n"
"struct hbil_fan {\n"
"#if HBIL_SPANS || HBIL_FACING_HALF_SPACE\n"
"    hbil_side front;\n"
"    hbil_side back;\n"
"#endif\n"
"    float ny;\n"
"    float light_front; // of each side, open: above 0, as ny is at least HBIL_LEAST_NY\n"
"    float light_back;\n"
"    float jitter;      // common to all edges: the expected number of sectors is exact\n"
"};\n";
static const char hbil__glsl_bitmask_hbil_edge_light[] =
"// Light between the view vector and the horizon c of a side.\n"
"float hbil_edge_light(float nx, float ny, float c) {\n"
"    return 0.5 * (nx * hbil_arc(c) + ny * (1.0 - c) * (1.0 + c));\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_fan_of[] =
"hbil_fan hbil_fan_of(hbil_receiver r, hbil_side front, hbil_side back, float jitter) {\n"
"    hbil_fan f;\n"
"#if HBIL_SPANS || HBIL_FACING_HALF_SPACE\n"
"    f.front = front;\n"
"    f.back = back;\n"
"#endif\n"
"    f.ny = r.ny;\n"
"    f.light_front = hbil_edge_light(front.nx, r.ny, front.c0);\n"
"    f.light_back = hbil_edge_light(back.nx, r.ny, back.c0);\n"
"    f.jitter = jitter;\n"
"    return f;\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_edge[] =
"// Sector edge of the horizon c of a side: 0 to 32.\n"
"int hbil_edge(hbil_fan f, hbil_side s, bool is_back, float c) {\n"
"    if (c <= s.c0) return is_back ? 0 : 32;\n"
"    float light = hbil_edge_light(s.nx, f.ny, c);\n"
"    float u = (f.light_back + (is_back ? -light : light)) / (f.light_front + f.light_back);\n"
"    return clamp(int(32.0 * u + f.jitter), 0, 32);\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_bits[] =
"// Sectors from edge `low` to edge `high`. None: a shift by 32 would be undefined.\n"
"uint hbil_bits(int low, int high) {\n"
"    int count = high - low;\n"
"    return count > 0 ? (0xffffffffu >> uint(32 - count)) << uint(low) : 0u;\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_lit_bits[] =
"#if HBIL_FACING_HALF_SPACE\n"
"// Sectors from where the front of a source can be seen: directions w with w . normal < 0.\n"
"uint hbil_lit_bits(hbil_receiver r, hbil_fan f, vec3 normal) {\n"
"    float x = dot(normal, f.front.tangent);\n"
"    float y = dot(normal, r.v);\n"
"    // the source's plane meets the slice in a line; of its two ends, the one above the receiver\n"
"    float side = y * f.front.nx - x * r.ny < 0.0 ? -1.0 : 1.0;\n"
"    vec2 end = side * vec2(y, -x) * inversesqrt(max(x * x + y * y, 1e-20));\n"
"    float c = min(end.y, 1.0); // an inverse root may be too large, and no arc is defined beyond 1\n"
"    int edge = end.x < 0.0 ? hbil_edge(f, f.back, true, c) : hbil_edge(f, f.front, false, c);\n"
"    return side > 0.0 ? hbil_bits(edge, 32) : hbil_bits(0, edge);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_bitmask_hbil_turn[] =
"// Direction of a sector's edge: x = -1 back or 1 front, y = its horizon. Newton's method on the root of the light below\n"
"// the horizon, which is nearly linear in it: three rounds leave an error of 5e-5.\n"
"vec2 hbil_turn(hbil_fan f, int edge) {\n"
"    float light = float(edge) / 32.0 * (f.light_front + f.light_back) - f.light_back;\n"
"    bool is_back = light < 0.0;\n"
"    float nx = is_back ? f.back.nx : f.front.nx;\n"
"    float c0 = is_back ? f.back.c0 : f.front.c0;\n"
"    float all = is_back ? f.light_back : f.light_front;\n"
"    float goal = sqrt(clamp(1.0 - abs(light) / all, 0.0, 1.0));\n"
"    float c = min(mix(c0, 1.0, goal), 1.0); // a root of 1 may be above it\n"
"    for (int i = 0; i < 3; ++i) {\n"
"        float root = sqrt(clamp(1.0 - hbil_edge_light(nx, f.ny, c) / all, 1e-12, 1.0));\n"
"        float slope = nx * sqrt((1.0 - c) * (1.0 + c)) + f.ny * c;\n"
"        c = clamp(c + 2.0 * (goal - root) * root * all / max(slope, 1e-6), c0, 1.0);\n"
"    }\n"
"    return vec2(is_back ? -1.0 : 1.0, edge == (is_back ? 0 : 32) ? c0 : c);\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_span[] =
"// What a set of sectors holds, in coordinates of the slice: x along D, y along V.\n"
"struct hbil_span {\n"
"#if HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH\n"
"    float angle;  // integral of |sin|\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    vec2 moments; // of direction |sin|\n"
"#endif\n"
"#if HBIL_BENT || HBIL_FAR_BITS\n"
"    vec2 bent;    // of direction (n . direction) |sin|\n"
"#endif\n"
"};\n";
static const char hbil__glsl_bitmask_hbil_span_to[] =
"// From the view vector to an edge, signed.\n"
"hbil_span hbil_span_to(hbil_fan f, vec2 edge) {\n"
"    hbil_span to;\n"
"    float side = edge.x;\n"
"    float c = edge.y;\n"
"#if HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH\n"
"    to.angle = side * (1.0 - c);\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    to.moments = 0.5 * vec2(hbil_arc(c), side * (1.0 - c) * (1.0 + c));\n"
"#endif\n"
"#if HBIL_BENT || HBIL_FAR_BITS\n"
"    float s2 = (1.0 - c) * (1.0 + c);\n"
"    float s3 = s2 * sqrt(s2);\n"
"    to.bent = vec2(side * f.front.nx * (c * c * c - 3.0 * c + 2.0) + f.ny * s3,\n"
"        f.front.nx * s3 + side * f.ny * (1.0 - c * c * c)) / 3.0;\n"
"#endif\n"
"    return to;\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_lowest_bit[] =
"// Number of the lowest bit that is set; one is. GLSL 3.30 has no findLSB.\n"
"int hbil_lowest_bit(uint bits) {\n"
"#if HBIL_STAGE_FRAGMENT\n"
"    return int(floatBitsToUint(float(bits & (~bits + 1u))) >> 23) - 127;\n"
"#else\n"
"    return findLSB(bits);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_bit_count[] =
"// Bits that are set.\n"
"int hbil_bit_count(uint bits) {\n"
"#if HBIL_STAGE_FRAGMENT\n"
"    bits -= (bits >> 1) & 0x55555555u;\n"
"    bits = (bits & 0x33333333u) + ((bits >> 2) & 0x33333333u);\n"
"    return int((((bits + (bits >> 4)) & 0x0f0f0f0fu) * 0x01010101u) >> 24);\n"
"#else\n"
"    return bitCount(bits);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_span_of[] =
"// Sum over the runs of sectors.\n"
"hbil_span hbil_span_of(hbil_fan f, uint bits) {\n"
"    hbil_span sum;\n"
"#if HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH\n"
"    sum.angle = 0.0;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    sum.moments = vec2(0.0);\n"
"#endif\n"
"#if HBIL_BENT || HBIL_FAR_BITS\n"
"    sum.bent = vec2(0.0);\n"
"#endif\n"
"    while (bits != 0u) {\n"
"        int low = hbil_lowest_bit(bits);\n"
"        uint gaps = ~(bits >> uint(low));\n"
"        int high = gaps == 0u ? 32 : low + hbil_lowest_bit(gaps);\n"
"        hbil_span a = hbil_span_to(f, hbil_turn(f, low));\n"
"        hbil_span b = hbil_span_to(f, hbil_turn(f, high));\n"
"#if HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH\n"
"        sum.angle += b.angle - a.angle;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"        sum.moments += b.moments - a.moments;\n"
"#endif\n"
"#if HBIL_BENT || HBIL_FAR_BITS\n"
"        sum.bent += b.bent - a.bent;\n"
"#endif\n"
"        bits &= ~hbil_bits(low, high);\n"
"    }\n"
"    return sum;\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_add_bits[] =
"#if HBIL_GATHER\n"
"// Radiance through sectors that nothing nearer has filled.\n"
"void hbil_add_bits(hbil_receiver r, hbil_fan f, uint bits, vec3 radiance, inout hbil_sums sum) {\n"
"#if HBIL_NEAR_LIGHT\n"
"    sum.near += float(hbil_bit_count(bits)) / 32.0 * (f.light_front + f.light_back) * radiance;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    hbil_span span = hbil_span_of(f, bits);\n"
"    sum.sh_0.rgb += span.angle * radiance;\n"
"    hbil_add_moments(span.moments.x * f.front.tangent + span.moments.y * r.v, vec4(radiance, 0.0), sum);\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_bitmask_hbil_low_end[] =
"// Horizon at which an occluder ends that is seen at `position`.\n"
"float hbil_low_end(hbil_receiver r, hbil_side s, vec3 position) {\n"
"#if HBIL_OCCLUDER_THICK\n"
"    // along the sample's own view ray\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    vec3 h = position + HBIL_THICKNESS * normalize(position) - r.position;\n"
"#else\n"
"    vec3 h = position + vec3(0.0, 0.0, HBIL_THICKNESS) - r.position;\n"
"#endif\n"
"    return clamp(dot(h, r.v) * inversesqrt(max(dot(h, h), 1e-30)), s.c0, 1.0);\n"
"#else\n"
"    return s.c0;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_fill[] =
"// Fill the sectors that one side's samples hide.\n"
"void hbil_fill(hbil_receiver r, hbil_fan f, hbil_side s, bool is_back, inout uint hidden, inout hbil_sums sum) {\n"
"#if HBIL_FACING_FILTER\n"
"    vec3 accepted = vec3(0.0);\n"
"#endif\n"
"    hbil_visit at = hbil_start(r);\n"
"    for (int i = 0; i < HBIL_STEPS; ++i) {\n"
"        if (!hbil_go(r, s, i, at)) break;\n"
"        if (at.z >= HBIL_SKY) continue;\n"
"        vec3 position = hbil_position(at.pixel, at.z);\n"
"        vec3 h = position - r.position;\n"
"        float l2 = max(dot(h, h), 1e-30);\n"
"        float inv = inversesqrt(l2);\n"
"        float high = clamp(dot(h, r.v) * inv, -1.0, 1.0);\n"
"        float low = hbil_low_end(r, s, position);\n"
"#if HBIL_MARCH_SAMPLED && !HBIL_REACH_0\n"
"        high = mix(low, high, hbil_fade(l2 * inv));\n"
"#endif\n"
"        if (dot(r.n, h) * inv <= HBIL_BIAS) continue;\n"
"        int a = hbil_edge(f, s, is_back, low);\n"
"        int b = hbil_edge(f, s, is_back, high);\n"
"        uint bits = hbil_bits(min(a, b), max(a, b));\n"
"#if HBIL_GATHER\n"
"        uint fresh = bits & ~hidden;\n"
"        if (fresh != 0u) {\n"
"#if HBIL_FACING_FILTER\n"
"            vec3 radiance = hbil_source(at, h * inv, accepted);\n"
"#else\n"
"            vec3 radiance = hbil_radiance_at(at);\n"
"#endif\n"
"#if HBIL_FACING_HALF_SPACE\n"
"            fresh &= hbil_lit_bits(r, f, hbil_normal_at(at));\n"
"#endif\n"
"            hbil_add_bits(r, f, fresh, radiance, sum);\n"
"        }\n"
"#endif\n"
"        hidden |= bits;\n"
"    }\n"
"}\n";
static const char hbil__glsl_bitmask_hbil_fill_swept[] =
"#if HBIL_MARCH_BOTH\n"
"// Fill what the sweep hides beyond the samples of one side, as a solid.\n"
"void hbil_fill_swept(hbil_receiver r, hbil_fan f, hbil_side s, bool is_back, int layer, inout uint hidden,\n"
"        inout hbil_sums sum) {\n"
"#if HBIL_GATHER\n"
"    vec3 radiance;\n"
"    float c = hbil_swept(r, s, layer, radiance);\n"
"#else\n"
"    float c = hbil_swept(r, s, layer);\n"
"#endif\n"
"    int a = hbil_edge(f, s, is_back, s.c0);\n"
"    int b = hbil_edge(f, s, is_back, c);\n"
"    uint bits = hbil_bits(min(a, b), max(a, b)) & ~hidden;\n"
"#if HBIL_GATHER\n"
"    hbil_add_bits(r, f, bits, radiance, sum);\n"
"#endif\n"
"    hidden |= bits;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_bitmask_hbil_far_arc[] =
"#if HBIL_FAR_BITS\n"
"// Light of the environment through a group of free sectors. energy: their share of a Lambertian surface's light;\n"
"// bent: their cosine-weighted directions in the space of the passes; r: the receiver.\n"
"vec3 hbil_far_arc(hbil_receiver r, float energy, vec3 bent) {\n"
"    vec3 d = hbil_to_world(hbil_direction(bent / energy, r.n));\n"
"#if HBIL_ENVIRONMENT_CUBE\n"
"    return energy * hbil_finite(textureLod(u_sky, d, 0.0).rgb);\n"
"#elif HBIL_ENVIRONMENT_HOOK\n"
"    return energy * hbil_finite(hbil_far_hook(hbil_world_position(r.position), d, 1.0));\n"
"#else\n"
"    return hbil_sh_sum(r.sh, d, vec3(energy, length(bent), energy));\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_bitmask_hbil_bitmask_slice[] =
"// Add the slice with tangent D and screen direction d.\n"
"#if HBIL_MARCH_BOTH\n"
"void hbil_bitmask_slice(hbil_receiver r, vec3 slice, hbil_line line, int i, vec2 jitter, inout hbil_sums sum) {\n"
"    hbil_side front = hbil_side_of(r, slice, line.d, jitter.x, 1.0);\n"
"    hbil_side back = hbil_side_of(r, slice, line.d, jitter.x, -1.0);\n"
"    front.line = line;\n"
"    back.line = line;\n"
"#else\n"
"void hbil_bitmask_slice(hbil_receiver r, vec3 slice, vec2 d, vec2 jitter, inout hbil_sums sum) {\n"
"    hbil_side front = hbil_side_of(r, slice, d, jitter.x, 1.0);\n"
"    hbil_side back = hbil_side_of(r, slice, d, jitter.x, -1.0);\n"
"#endif\n"
"    hbil_fan f = hbil_fan_of(r, front, back, jitter.y);\n"
"    uint hidden = 0u;\n"
"    hbil_fill(r, f, front, false, hidden, sum);\n"
"    hbil_fill(r, f, back, true, hidden, sum);\n"
"#if HBIL_MARCH_BOTH\n"
"    hbil_fill_swept(r, f, front, false, 2 * i, hidden, sum);\n"
"    hbil_fill_swept(r, f, back, true, 2 * i + 1, hidden, sum);\n"
"#endif\n"
"#if HBIL_SUMS || HBIL_FAR_BITS\n"
"    float full = f.light_front + f.light_back;\n"
"#endif\n"
"#if HBIL_SUMS\n"
"    sum.full += full;\n"
"    sum.blocked += full * float(hbil_bit_count(hidden)) / 32.0;\n"
"#endif\n"
"#if HBIL_BENT || HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH\n"
"    hbil_span open = hbil_span_of(f, ~hidden);\n"
"#endif\n"
"#if HBIL_OUTPUTS_UNIFORM_AO\n"
"    sum.uniform_open += 0.5 * open.angle;\n"
"#endif\n"
"#if HBIL_BENT\n"
"    sum.bent += open.bent.x * slice + open.bent.y * r.v;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    sum.sh_0.a += open.angle;\n"
"    hbil_add_moments(open.moments.x * slice + open.moments.y * r.v, vec4(0.0, 0.0, 0.0, 1.0), sum);\n"
"#endif\n"
"#if HBIL_FAR_BITS\n"
"    for (int i = 0; i < 32; i += 8) {\n"
"        uint bits = ~hidden & (0xffu << uint(i));\n"
"        if (bits == 0u) continue;\n"
"        vec2 b = hbil_span_of(f, bits).bent;\n"
"        sum.far += hbil_far_arc(r, full * float(hbil_bit_count(bits)) / 32.0, b.x * slice + b.y * r.v);\n"
"    }\n"
"#endif\n"
"}\n";
static const char hbil__glsl_hbao_hbil_attenuation[] =
"// Weight of an occluder at a distance. [0, 1]\n"
"float hbil_attenuation(float distance) {\n"
"#if HBIL_REACH_0\n"
"    return 1.0;\n"
"#elif HBIL_ATTENUATION_LINEAR\n"
"    return clamp(1.0 - distance / HBIL_REACH, 0.0, 1.0);\n"
"#else\n"
"    float d = distance / HBIL_REACH;\n"
"    return clamp(1.0 - d * d, 0.0, 1.0);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_hbao_hbil_hidden[] =
"// Occlusion of a side. hbao: sin h - sin t, where each rise counts with the weight of the sample that made it; the\n"
"// sine of an elevation is the cosine of the angle to V. hbao_plus: sum over the samples of how far each is raised above\n"
"// the tangent plane; it knows no horizon.\n"
"float hbil_hidden(hbil_receiver r, hbil_side s) {\n"
"#if HBIL_ESTIMATOR_HBAO\n"
"    float c = s.c0 + HBIL_ANGLE_BIAS;\n"
"#endif\n"
"    float hidden = 0.0;\n"
"    hbil_visit at = hbil_start(r);\n"
"    for (int i = 0; i < HBIL_STEPS; ++i) {\n"
"        if (!hbil_go(r, s, i, at)) break;\n"
"        if (at.z >= HBIL_SKY) continue;\n"
"        vec3 h = hbil_position(at.pixel, at.z) - r.position;\n"
"        float distance = sqrt(max(dot(h, h), 1e-30));\n"
"#if HBIL_ESTIMATOR_HBAO\n"
"        float rise = max(dot(h, r.v) / distance - c, 0.0);\n"
"        c += rise;\n"
"#else\n"
"        float rise = clamp(dot(r.n, h) / distance - HBIL_ANGLE_BIAS, 0.0, 1.0);\n"
"#endif\n"
"        hidden += rise * hbil_attenuation(distance);\n"
"    }\n"
"    return hidden;\n"
"}\n";
static const char hbil__glsl_hbao_hbil_hbao_slice[] =
"// Add the slice with tangent D and screen direction d.\n"
"void hbil_hbao_slice(hbil_receiver r, vec3 slice, vec2 d, float jitter, inout hbil_sums sum) {\n"
"    hbil_side front = hbil_side_of(r, slice, d, jitter, 1.0);\n"
"    hbil_side back = hbil_side_of(r, slice, d, jitter, -1.0);\n"
"#if HBIL_ESTIMATOR_HBAO_PLUS\n"
"    sum.hidden += HBIL_MULTIPLIER * (hbil_hidden(r, front) + hbil_hidden(r, back)) / float(HBIL_STEPS);\n"
"#else\n"
"    sum.hidden += 0.5 * (hbil_hidden(r, front) + hbil_hidden(r, back));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_grid_hbil_frame_size[] =
"// Render size. pixels\n"
"ivec2 hbil_frame_size() {\n"
"#if HBIL_COARSE\n"
"    return HBIL_FULL_SIZE;\n"
"#else\n"
"    return HBIL_SIZE;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_grid_hbil_centre[] =
"// Where the centre of a pixel of the frame lies on the grid. Pixels of the grid have theirs at .5\n"
"vec2 hbil_centre(ivec2 p) {\n"
"#if HBIL_COARSE\n"
"    return (vec2(p) + 0.5) / float(HBIL_DOWNSCALE);\n"
"#else\n"
"    return vec2(p) + 0.5;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_grid_hbil_middle[] =
"// Pixel of the frame in the middle of a block; at the border, the last there is.\n"
"ivec2 hbil_middle(ivec2 p) {\n"
"#if HBIL_COARSE\n"
"    return min(p * HBIL_DOWNSCALE + HBIL_DOWNSCALE / 2, HBIL_FULL_SIZE - 1);\n"
"#else\n"
"    return p;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_grid_hbil_quad[] =
"#if HBIL_COARSE\n"
"// The four pixels of the frame around the middle of a block, i in [0, 3]. Blocks that leave the frame take its last\n"
"// ones.\n"
"ivec2 hbil_quad(ivec2 p, int i) {\n"
"    ivec2 first = max(min(p * HBIL_DOWNSCALE + HBIL_DOWNSCALE / 2 - 1, HBIL_FULL_SIZE - 2), ivec2(0));\n"
"    return min(first + ivec2(i & 1, i >> 1), HBIL_FULL_SIZE - 1);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_grid_HBIL_SAME_DEPTH[] =
"const float HBIL_SAME_DEPTH = 0.1; // of a depth (orthographic: of the screen's height): another surface\n";
static const char hbil__glsl_grid_hbil_depth_scale[] =
"// Length that depths are held against. m\n"
"float hbil_depth_scale(float z) {\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    return z;\n"
"#else\n"
"    return abs(HBIL_PIXEL_TO_RAY.y) * float(HBIL_SIZE.y);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_grid_hbil_quad_weights[] =
"#if HBIL_COARSE\n"
"// Which of the four are of the surface that the grid took, at depth z. Adds up to 1.\n"
"vec4 hbil_quad_weights(ivec2 p, float z) {\n"
"    vec4 w;\n"
"    for (int i = 0; i < 4; ++i) {\n"
"        float off = abs(texelFetch(u_full_depth, hbil_quad(p, i), 0).r - z);\n"
"        w[i] = off < HBIL_SAME_DEPTH * hbil_depth_scale(z) ? 1.0 : 1e-3;\n"
"    }\n"
"    return w / dot(w, vec4(1.0));\n"
"}\n"
"#endif\n";
static const char hbil__glsl_grid_hbil_grid_radiance[] =
"// Radiance of a pixel of the grid. w: hbil_quad_weights\n"
"#if HBIL_COARSE\n"
"vec3 hbil_grid_radiance(ivec2 p, vec4 w) {\n"
"    vec3 sum = vec3(0.0);\n"
"    for (int i = 0; i < 4; ++i) sum += w[i] * hbil_load_radiance(hbil_quad(p, i));\n"
"    return sum;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_grid_hbil_grid_albedo[] =
"// The same of albedo.\n"
"#if HBIL_COARSE\n"
"vec3 hbil_grid_albedo(ivec2 p, vec4 w) {\n"
"    vec3 sum = vec3(0.0);\n"
"    for (int i = 0; i < 4; ++i) sum += w[i] * hbil_load_albedo(hbil_quad(p, i));\n"
"    return sum;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_signal_HBIL_LAYERS[] =
"const int HBIL_LAYERS = 0 // of a signal, each a vec4\n"
"#if HBIL_LIGHT_LAYER\n"
"    + 1 // rgb near light, a ao. One slice: both not yet divided by the light of an open sky, and a what is hidden\n"
"#endif\n"
"#if HBIL_BENT_LAYER\n"
"    + 1 // xyz bent vector. One slice: a light of an open sky\n"
"#endif\n"
"#if HBIL_FAR_LAYER\n"
"    + 1 // rgb far light, a uniform ao\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    + 4 // as u_sh\n"
"#endif\n"
"    ;\n";
static const char hbil__glsl_signal_HBIL_AT_BENT[] =
"#if HBIL_LIGHT_LAYER\n"
"const int HBIL_AT_BENT = 1; // layer of the bent vector\n"
"#else\n"
"const int HBIL_AT_BENT = 0; // layer of the bent vector\n"
"#endif\n";
static const char hbil__glsl_signal_HBIL_AT_FAR[] =
"const int HBIL_AT_FAR = 0 // layer of far light\n"
"#if HBIL_LIGHT_LAYER\n"
"    + 1\n"
"#endif\n"
"#if HBIL_BENT_LAYER\n"
"    + 1\n"
"#endif\n"
"    ;\n";
static const char hbil__glsl_signal_HBIL_AT_SH[] =
"const int HBIL_AT_SH = HBIL_LAYERS - 4; // first layer of sh\n";
static const char hbil__glsl_signal_hbil_signal[] =
"// Layer of the signal that the pass before left. Ao alone lies in the only channel.\n"
"vec4 hbil_signal(ivec2 p, int layer) {\n"
"#if HBIL_ONLY_AO\n"
"    return texelFetch(u_from, ivec3(p, layer), 0).rrrr;\n"
"#else\n"
"    return texelFetch(u_from, ivec3(p, layer), 0);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_signal_hbil_pass_on[] =
"// Leave a signal for the next pass.\n"
"void hbil_pass_on(ivec2 p, vec4 s[HBIL_LAYERS]) {\n"
"#if HBIL_STORAGE_HALF || HBIL_ARITHMETIC_HALF\n"
"    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] = clamp(s[i], vec4(-HBIL_RADIANCE_MAX), vec4(HBIL_RADIANCE_MAX));\n"
"#endif\n"
"#if HBIL_ONLY_AO\n"
"    s[0] = vec4(s[0].a);\n"
"#endif\n"
"#if HBIL_STAGE_COMPUTE\n"
"    for (int i = 0; i < HBIL_LAYERS; ++i) imageStore(u_to, ivec3(p, i), s[i]);\n"
"#else\n"
"#if HBIL_LIGHT_LAYER\n"
"    u_to[0] = s[0];\n"
"#endif\n"
"#if HBIL_BENT_LAYER\n"
"    u_to[HBIL_AT_BENT] = s[HBIL_AT_BENT];\n"
"#endif\n"
"#if HBIL_FAR_LAYER\n"
"    u_to[HBIL_AT_FAR] = s[HBIL_AT_FAR];\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    u_to[HBIL_AT_SH] = s[HBIL_AT_SH];\n"
"    u_to[HBIL_AT_SH + 1] = s[HBIL_AT_SH + 1];\n"
"    u_to[HBIL_AT_SH + 2] = s[HBIL_AT_SH + 2];\n"
"    u_to[HBIL_AT_SH + 3] = s[HBIL_AT_SH + 3];\n"
"#endif\n"
"#endif\n"
"}\n";
static const char hbil__glsl_signal_hbil_store_sh_at[] =
"// The output sh.\n"
"void hbil_store_sh_at(ivec2 p, vec4 a, vec4 b, vec4 c, vec4 d) {\n"
"#if HBIL_STAGE_COMPUTE\n"
"    imageStore(u_sh, ivec3(p, 0), a);\n"
"    imageStore(u_sh, ivec3(p, 1), b);\n"
"    imageStore(u_sh, ivec3(p, 2), c);\n"
"    imageStore(u_sh, ivec3(p, 3), d);\n"
"#else\n"
"    u_sh[0] = a;\n"
"    u_sh[1] = b;\n"
"    u_sh[2] = c;\n"
"    u_sh[3] = d;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_signal_hbil_finish[] =
"// A signal to outputs.\n"
"void hbil_finish(ivec2 p, vec4 s[HBIL_LAYERS]) {\n"
"#if HBIL_DEFER\n"
"    float scale = 1.0 / s[HBIL_AT_BENT].a; // never 0: n.v is not\n"
"    s[0] *= scale;\n"
"    s[0].a = 1.0 - s[0].a;\n"
"#if HBIL_FAR_BITS\n"
"    s[HBIL_AT_FAR].rgb = hbil_finite(scale * s[HBIL_AT_FAR].rgb); // scale: a thousand where the surface is seen edge-on\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    for (int i = 1; i < 4; ++i) s[HBIL_AT_SH + i] *= scale;\n"
"#endif\n"
"#endif\n"
"#if HBIL_VISIBILITY\n"
"    float ao = clamp(s[0].a, 0.0, 1.0);\n"
"#if !HBIL_AO_EXPONENT_1\n"
"    float lift = exp2((HBIL_AO_EXPONENT - 1.0) * log2(max(ao, 1e-6)));\n"
"    ao = min(ao * lift, 1.0); // Vulkan lets a logarithm of 1 be wrong by 5e-7\n"
"#endif\n"
"#endif\n"
"#if HBIL_AO\n"
"    imageStore(u_ao, p, vec4(ao));\n"
"#endif\n"
"#if HBIL_BENT\n"
"    vec3 bent = s[HBIL_AT_BENT].xyz;\n"
"#if !HBIL_AO_EXPONENT_1\n"
"    bent *= lift;\n"
"#endif\n"
"    bent *= min(inversesqrt(max(dot(bent, bent), 1e-12)), 1.0); // one slice or a lift may take it beyond 1\n"
"    imageStore(u_bent, p, vec4(bent, 1.0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_UNIFORM_AO\n"
"    imageStore(u_uniform_ao, p, vec4(min(s[HBIL_AT_FAR].a, 1.0)));\n"
"#endif\n"
"#if HBIL_NEAR_LIGHT\n"
"    vec3 near = s[0].rgb;\n"
"#if !HBIL_F0_NONE\n"
"    near *= hbil_diffuse(p);\n"
"#endif\n"
"    imageStore(u_near, p, vec4(near, 1.0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    vec4 a = s[HBIL_AT_SH + 1];\n"
"    vec4 b = s[HBIL_AT_SH + 2];\n"
"    vec4 c = s[HBIL_AT_SH + 3];\n"
"    // no light comes from less than one direction, but the ratio of few slices may say so\n"
"    vec4 fit = min(1.7320508 * s[HBIL_AT_SH] * inversesqrt(max(a * a + b * b + c * c, vec4(1e-30))), vec4(1.0));\n"
"    hbil_store_sh_at(p, s[HBIL_AT_SH], fit * a, fit * b, fit * c);\n"
"#endif\n"
"#if HBIL_FAR_BITS\n"
"    vec3 far = HBIL_FAR_INTENSITY * s[HBIL_AT_FAR].rgb;\n"
"#if !HBIL_F0_NONE\n"
"    far *= hbil_diffuse(p);\n"
"#endif\n"
"    imageStore(u_far, p, vec4(far, 1.0));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_signal_hbil_finish_sky[] =
"// Outputs of a pixel without a surface.\n"
"void hbil_finish_sky(ivec2 p) {\n"
"#if HBIL_AO\n"
"    imageStore(u_ao, p, vec4(1.0));\n"
"#endif\n"
"#if HBIL_BENT\n"
"    imageStore(u_bent, p, vec4(0.0, 0.0, 0.0, 1.0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_UNIFORM_AO\n"
"    imageStore(u_uniform_ao, p, vec4(1.0));\n"
"#endif\n"
"#if HBIL_NEAR_LIGHT\n"
"    imageStore(u_near, p, vec4(0.0, 0.0, 0.0, 1.0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    hbil_store_sh_at(p, vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));\n"
"#endif\n"
"#if HBIL_FAR_BITS\n"
"    imageStore(u_far, p, vec4(0.0, 0.0, 0.0, 1.0));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_signal_HBIL_FILTER_PLANE[] =
"const float HBIL_FILTER_PLANE = 1.0; // distance from the tangent plane at which a neighbour counts no more. pixels\n";
static const char hbil__glsl_signal_HBIL_FILTER_NORMAL[] =
"const float HBIL_FILTER_NORMAL = 4.0; // 1 / square of the angle between normals at which it does not. rad^-2\n";
static const char hbil__glsl_signal_hbil_surface[] =
"// The surface at a pixel, as its neighbours are held against it.\n"
"struct hbil_surface {\n"
"    vec3 position;\n"
"    vec3 n;\n"
"    vec2 code;     // of n, octahedral\n"
"    float pixel;   // width of a pixel of the grid there. m\n"
"};\n";
static const char hbil__glsl_signal_hbil_surface_at[] =
"// pixel: on the grid\n"
"hbil_surface hbil_surface_at(vec2 pixel, float z, uint normal) {\n"
"    hbil_surface s;\n"
"    s.position = hbil_position(pixel, z);\n"
"    s.n = hbil_decode_normal(normal);\n"
"    s.code = hbil_unpack_snorm(normal);\n"
"    s.pixel = length(hbil_position(pixel + vec2(1.0, 0.0), z) - s.position);\n"
"    return s;\n"
"}\n";
static const char hbil__glsl_signal_hbil_belongs[] =
"// How far pixel q of the grid, `gap` pixels away, is part of a surface: up to 1, 0 and less is not.\n"
"float hbil_belongs(hbil_surface s, ivec2 q, float gap) {\n"
"    float z = hbil_load_depth(q);\n"
"    if (z >= HBIL_SKY) return 0.0;\n"
"    float off = abs(dot(s.n, hbil_position(vec2(q) + 0.5, z) - s.position));\n"
"    vec2 turn = hbil_unpack_snorm(texelFetch(u_view_normal, q, 0).r) - s.code;\n"
"    return max(1.0 - off / max(HBIL_FILTER_PLANE * gap * s.pixel, 1e-30), 0.0)\n"
"        * (1.0 - HBIL_FILTER_NORMAL * dot(turn, turn));\n"
"}\n";
static const char hbil__glsl_signal_HBIL_FILTER_RADIUS[] =
"#if HBIL_FILTER_3X3\n"
"const int HBIL_FILTER_RADIUS = 1; // pixels\n"
"#else\n"
"const int HBIL_FILTER_RADIUS = 2; // pixels\n"
"#endif\n";
static const char hbil__glsl_signal_hbil_blend[] =
"// Move the mean towards the signal at a pixel: no sum can leave the range of a half float.\n"
"#if HBIL_ARITHMETIC_HALF\n"
"void hbil_blend(ivec2 q, mediump float share, inout mediump vec4 s[HBIL_LAYERS]) {\n"
"    for (int i = 0; i < HBIL_LAYERS; ++i) {\n"
"        mediump vec4 other = hbil_signal(q, i);\n"
"        s[i] += share * (other - s[i]);\n"
"    }\n"
"}\n"
"#else\n"
"void hbil_blend(ivec2 q, float share, inout vec4 s[HBIL_LAYERS]) {\n"
"    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] += share * (hbil_signal(q, i) - s[i]);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_signal_hbil_filter_share[] =
"#if HBIL_TEMPORAL_YES\n"
"// Weight of a neighbour beside the pixel itself: noise of the running mean falls faster with its frames than detail is\n"
"// worth.\n"
"float hbil_filter_share(ivec2 p) {\n"
"    float frames = float(texelFetch(u_seen, p, 0).r & 63u);\n"
"    return max(1.0 / (1.0 + 0.05 * frames * frames), 0.1);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_signal_hbil_filter[] =
"// Mean of a signal over the neighbours of a pixel, `gap` pixels apart, that lie on the same surface. What few slices\n"
"// per pixel get wrong differs from pixel to pixel, and cancels. False: there is no surface.\n"
"#if HBIL_ARITHMETIC_HALF\n"
"bool hbil_filter(ivec2 p, int gap, out mediump vec4 s[HBIL_LAYERS]) {\n"
"#else\n"
"bool hbil_filter(ivec2 p, int gap, out vec4 s[HBIL_LAYERS]) {\n"
"#endif\n"
"    float z = hbil_load_depth(p);\n"
"    if (z >= HBIL_SKY) return false;\n"
"    hbil_surface here = hbil_surface_at(vec2(p) + 0.5, z, texelFetch(u_view_normal, p, 0).r);\n"
"    float all = 1.0;\n"
"#if HBIL_TEMPORAL_YES\n"
"    float share = hbil_filter_share(p);\n"
"#endif\n"
"    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] = hbil_signal(p, i);\n"
"    for (int y = -HBIL_FILTER_RADIUS; y <= HBIL_FILTER_RADIUS; ++y)\n"
"        for (int x = -HBIL_FILTER_RADIUS; x <= HBIL_FILTER_RADIUS; ++x) {\n"
"            ivec2 q = p + gap * ivec2(x, y);\n"
"            if (q == p || any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_SIZE))) continue;\n"
"            float w = hbil_belongs(here, q, float(gap));\n"
"            if (w <= 0.0) continue;\n"
"#if HBIL_TEMPORAL_YES\n"
"            w *= share;\n"
"#endif\n"
"            all += w;\n"
"            hbil_blend(q, w / all, s);\n"
"        }\n"
"    return true;\n"
"}\n";
static const char hbil__glsl_last_HBIL_NOWHERE[] =
"const uint HBIL_NOWHERE = 0xffffffffu; // no surface of last frame falls here\n";
static const char hbil__glsl_last_hbil_pack_seen[] =
"// View depth and a number of frames in [0, 63]. Relative error of the depth below 1e-5.\n"
"uint hbil_pack_seen(float z, float frames) {\n"
"    return (floatBitsToUint(z) & ~63u) | uint(frames + 0.5);\n"
"}\n";
static const char hbil__glsl_last_hbil_seen_depth[] =
"float hbil_seen_depth(uint code) {\n"
"    return uintBitsToFloat(code & ~63u);\n"
"}\n";
static const char hbil__glsl_last_hbil_move[] =
"// A point by the rows of a motion.\n"
"vec3 hbil_move(vec4 rows[3], vec3 p) {\n"
"    return vec3(dot(rows[0].xyz, p), dot(rows[1].xyz, p), dot(rows[2].xyz, p)) + vec3(rows[0].w, rows[1].w, rows[2].w);\n"
"}\n";
static const char hbil__glsl_last_hbil_last_position[] =
"// Point that the last frame saw at a pixel position and view depth, in its own space. m\n"
"vec3 hbil_last_position(vec2 pixel, float z) {\n"
"    vec2 ray = pixel * HBIL_LAST_TO_RAY.xy + HBIL_LAST_TO_RAY.zw;\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    return vec3(ray * z, z);\n"
"#else\n"
"    return vec3(ray, z);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_last_hbil_pixel_of[] =
"// Pixel position at which a camera sees a point in front of it; far away where it does not.\n"
"vec2 hbil_pixel_of(vec3 p, vec4 to_ray) {\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    if (p.z <= 0.0) return vec2(-1e9);\n"
"    return (p.xy / p.z - to_ray.zw) / to_ray.xy;\n"
"#else\n"
"    return (p.xy - to_ray.zw) / to_ray.xy;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_last_hbil_landing[] =
"// Where a surface of last frame falls in this one: xy pixel position, z view depth.\n"
"vec3 hbil_landing(ivec2 q, float z) {\n"
"    vec3 here = hbil_move(HBIL_VIEW_FROM_LAST, hbil_last_position(vec2(q) + 0.5, z));\n"
"    return vec3(hbil_pixel_of(here, HBIL_PIXEL_TO_RAY), here.z);\n"
"}\n";
static const char hbil__glsl_last_hbil_land[] =
"// The pixel of this frame on which a pixel q of last frame falls, and its depth there. False: on none.\n"
"bool hbil_land(ivec2 q, out ivec2 p, out float z) {\n"
"    float before = hbil_seen_depth(texelFetch(u_last_seen, q, 0).r);\n"
"    if (before >= 0.5 * HBIL_SKY) return false;\n"
"    vec3 landing = hbil_landing(q, before);\n"
"    // before it is made an int: none holds NaN or what is far away\n"
"    if (!(all(greaterThanEqual(landing.xy, vec2(0.0))) && all(lessThan(landing.xy, vec2(HBIL_SIZE))))) return false;\n"
"    p = ivec2(landing.xy);\n"
"    z = landing.z;\n"
"    return true;\n"
"}\n";
static const char hbil__glsl_last_hbil_depth_key[] =
"// Order of view depths as whole numbers.\n"
"uint hbil_depth_key(float z) {\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    return floatBitsToUint(z);\n"
"#else\n"
"    uint bits = floatBitsToUint(z);\n"
"    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_last_hbil_key_depth[] =
"// And back.\n"
"float hbil_key_depth(uint key) {\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    return uintBitsToFloat(key);\n"
"#else\n"
"    return uintBitsToFloat((key & 0x80000000u) != 0u ? key ^ 0x80000000u : ~key);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_last_hbil_claim[] =
"#if HBIL_REPROJECT_SCATTER\n"
"// The pixel of last frame that fell on p or, in the cracks of a surface that has come nearer, beside it.\n"
"uint hbil_claim(ivec2 p) {\n"
"    uint claim = texelFetch(u_claimed, p, 0).r;\n"
"    for (int i = 0; i < 4 && claim == HBIL_NOWHERE; ++i) {\n"
"        ivec2 q = p + ivec2(i == 0 ? -1 : i == 1 ? 1 : 0, i == 2 ? -1 : i == 3 ? 1 : 0);\n"
"        if (all(greaterThanEqual(q, ivec2(0))) && all(lessThan(q, HBIL_SIZE))) claim = texelFetch(u_claimed, q, 0).r;\n"
"    }\n"
"    return claim;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_last_hbil_last_pixel[] =
"// Where the surface at p, at `there` in last frame's space if it stands still, was on its grid. Far away: nobody\n"
"// knows.\n"
"vec2 hbil_last_pixel(ivec2 p, vec3 there) {\n"
"#if HBIL_REPROJECT_GATHER\n"
"    return vec2(p) + 0.5 + texelFetch(u_motion, hbil_middle(p), 0).rg / float(HBIL_DOWNSCALE);\n"
"#elif HBIL_REPROJECT_CAMERA\n"
"    return hbil_pixel_of(there, HBIL_LAST_TO_RAY);\n"
"#else\n"
"    uint claim = hbil_claim(p);\n"
"    if (claim == HBIL_NOWHERE) return vec2(-1e9);\n"
"    ivec2 q = ivec2(claim & 65535u, claim >> 16);\n"
"    vec3 landing = hbil_landing(q, hbil_seen_depth(texelFetch(u_last_seen, q, 0).r));\n"
"    return vec2(p) + vec2(q) + 1.0 - landing.xy;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_last_HBIL_LAST_PLANE[] =
"const float HBIL_LAST_PLANE = 0.01; // of a depth: farther from the tangent plane is another surface\n";
static const char hbil__glsl_last_hbil_taps[] =
"// The four pixels of last frame around a place, and what each of them counts: 0 if it saw another surface.\n"
"struct hbil_taps {\n"
"    ivec2 first;\n"
"    vec4 weights; // add up to `all`\n"
"    float all;    // [0, 1]\n"
"    float frames; // in the running mean there\n"
"};\n";
static const char hbil__glsl_last_hbil_find[] =
"// Last frame's pixels of the surface with normal n at `position`, seen at pixel p.\n"
"hbil_taps hbil_find(ivec2 p, vec3 position, vec3 n) {\n"
"    hbil_taps t;\n"
"    t.first = p;\n"
"    t.weights = vec4(0.0);\n"
"    t.all = 0.0;\n"
"    t.frames = 0.0;\n"
"    vec3 there = hbil_move(HBIL_LAST_FROM_VIEW, position);\n"
"    vec2 pixel = hbil_last_pixel(p, there);\n"
"    // written so that NaN is off the screen, too. A branch on uniforms alone makes lavapipe compile anew in each frame\n"
"    bool seen = all(greaterThan(pixel, vec2(-1.0))) && all(lessThan(pixel, vec2(HBIL_LAST_SIZE) + 1.0));\n"
"    if (!seen || HBIL_RESET != 0) return t;\n"
"    there = hbil_last_position(pixel, there.z); // moving things: at the depth of still ones\n"
"    n = hbil_move(HBIL_LAST_FROM_VIEW, position + n) - hbil_move(HBIL_LAST_FROM_VIEW, position);\n"
"    float limit = HBIL_LAST_PLANE * hbil_depth_scale(there.z); // below 0 behind the eye: nothing is near\n"
"    t.first = ivec2(floor(pixel - 0.5));\n"
"    vec2 f = pixel - 0.5 - vec2(t.first);\n"
"    vec4 w = vec4(1.0 - f.x, f.x, 1.0 - f.x, f.x) * vec4(vec2(1.0 - f.y), vec2(f.y));\n"
"    for (int i = 0; i < 4; ++i) {\n"
"        ivec2 q = t.first + ivec2(i & 1, i >> 1);\n"
"        if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_LAST_SIZE))) continue;\n"
"        uint code = texelFetch(u_last_seen, q, 0).r;\n"
"        float z = hbil_seen_depth(code);\n"
"        float off = abs(dot(n, hbil_last_position(vec2(q) + 0.5, z) - there));\n"
"        if (!(z < 0.5 * HBIL_SKY && off < limit)) continue;\n"
"        t.weights[i] = w[i];\n"
"        t.all += w[i];\n"
"        t.frames += w[i] * float(code & 63u);\n"
"    }\n"
"    return t;\n"
"}\n";
static const char hbil__glsl_last_hbil_last_irradiance[] =
"// E/pi that pixel q of last frame's grid may reflect.\n"
"vec3 hbil_last_irradiance(ivec2 q) {\n"
"#if HBIL_STAGE_FRAGMENT && HBIL_COARSE\n"
"    q = min(q * HBIL_DOWNSCALE + HBIL_DOWNSCALE / 2, HBIL_LAST_FULL_SIZE - 1); // as hbil_middle was\n"
"#endif\n"
"    return hbil_unpack_radiance(texelFetch(u_last_bounce, q, 0).r);\n"
"}\n";
static const char hbil__glsl_last_hbil_pushed_at[] =
"// Texel q of level 1 or 2 in u_pushed.\n"
"ivec2 hbil_pushed_at(ivec2 q, int level) {\n"
"    return q + ivec2(level == 2 ? (HBIL_SIZE.x + 1) / 2 : 0, 0);\n"
"}\n";
static const char hbil__glsl_last_hbil_pushed_far_at[] =
"// Texel q of level 4, 5 or 6 in u_pushed_far.\n"
"ivec2 hbil_pushed_far_at(ivec2 q, int level) {\n"
"    ivec2 size = (HBIL_SIZE + 7) / 8;\n"
"    return q + ivec2(level > 4 ? (size.x + 1) / 2 : 0, level > 5 ? (size.y + 3) / 4 : 0);\n"
"}\n";
static const char hbil__glsl_last_HBIL_PUSHED[] =
"const int HBIL_PUSHED = 6; // levels, of 2 to 64 pixels\n";
static const char hbil__glsl_last_hbil_has_pushed[] =
"// Is there room for them?\n"
"bool hbil_has_pushed() {\n"
"    return min(HBIL_SIZE.x, HBIL_SIZE.y) >= 16;\n"
"}\n";
static const char hbil__glsl_last_hbil_push[] =
"// One texel from the four below it: mean of those that are about as far as the farthest, since holes open onto what is\n"
"// behind.\n"
"vec4 hbil_push(vec4 a, vec4 b, vec4 c, vec4 d) {\n"
"    vec4 z = vec4(a.a, b.a, c.a, d.a);\n"
"    vec4 there = vec4(notEqual(z, vec4(0.0)));\n"
"    vec4 known = mix(vec4(-1e30), z, greaterThan(there, vec4(0.0)));\n"
"    float most = max(max(known.x, known.y), max(known.z, known.w));\n"
"    vec4 w = there * vec4(greaterThan(known, vec4(most - HBIL_SAME_DEPTH * hbil_depth_scale(most))));\n"
"    return (w.x * a + w.y * b + w.z * c + w.w * d) / max(dot(w, vec4(1.0)), 1.0);\n"
"}\n";
static const char hbil__glsl_prepare_hbil_load_raw_depth[] =
"float hbil_load_raw_depth(ivec2 p) {\n"
"#if HBIL_MULTISAMPLE_YES\n"
"    return texelFetch(u_depth, p, HBIL_SAMPLE).r;\n"
"#else\n"
"    return texelFetch(u_depth, p, 0).r;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_prepare_HBIL_LEAST_DEPTH[] =
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"const float HBIL_LEAST_DEPTH = 1e-9; // nearer is no surface: squares of lengths would underflow, nearness overflow. m\n"
"#endif\n";
static const char hbil__glsl_prepare_hbil_view_depth[] =
"// View depth of the surface at a pixel. m; HBIL_SKY where there is none. The sky test reads the raw value, before any\n"
"// arithmetic could round it, and is written so that NaN is sky too.\n"
"float hbil_view_depth(ivec2 p) {\n"
"    float raw = hbil_load_raw_depth(p);\n"
"#if HBIL_DEPTH_LINEAR\n"
"    float z = raw;\n"
"    bool surface = raw < HBIL_SKY_DEPTH;\n"
"#else\n"
"#if HBIL_DEPTH_DIRECTION_REVERSED\n"
"    float d = raw;\n"
"#else\n"
"    float d = 1.0 - raw;\n"
"#endif\n"
"    bool surface = d > 0.0;\n"
"#if HBIL_PROJECTION_ORTHOGRAPHIC\n"
"    float z = d * HBIL_DEPTH_TO_VIEW.x + HBIL_DEPTH_TO_VIEW.y;\n"
"#elif HBIL_DEPTH_FAR_INFINITE\n"
"    float z = 1.0 / max(d * HBIL_DEPTH_TO_VIEW.x, 1e-30); // the sky's: 1e30\n"
"#else\n"
"    float z = 1.0 / max(d * HBIL_DEPTH_TO_VIEW.x + HBIL_DEPTH_TO_VIEW.y, 1e-30);\n"
"#endif\n"
"#endif\n"
"#if HBIL_PROJECTION_PERSPECTIVE\n"
"    return surface && z >= HBIL_LEAST_DEPTH && z < HBIL_SKY ? z : HBIL_SKY;\n"
"#else\n"
"    return surface && abs(z) < HBIL_SKY ? z : HBIL_SKY;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_prepare_hbil_unfold[] =
"#if HBIL_NORMAL_ENCODING_OCTAHEDRAL || HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM || HBIL_NORMAL_ENCODING_OCTAHEDRAL_888\n"
"// Vector of an octahedral map with +z in its middle, not normalised. o in [-1, 1]\n"
"vec3 hbil_unfold(vec2 o) {\n"
"    vec3 n = vec3(o, 1.0 - abs(o.x) - abs(o.y));\n"
"    float fold = max(-n.z, 0.0);\n"
"    n.xy += mix(vec2(fold), vec2(-fold), greaterThanEqual(n.xy, vec2(0.0)));\n"
"    return n;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_prepare_hbil_load_raw_normal[] =
"#if !HBIL_NORMALS_DEPTH\n"
"// The normal as its channels say, not normalised.\n"
"vec3 hbil_load_raw_normal(ivec2 p) {\n"
"#if HBIL_MULTISAMPLE_YES\n"
"    vec3 t = texelFetch(u_normal, p, HBIL_SAMPLE).xyz;\n"
"#else\n"
"    vec3 t = texelFetch(u_normal, p, 0).xyz;\n"
"#endif\n"
"#if HBIL_NORMAL_ENCODING_XYZ_UNORM\n"
"    return t * 2.0 - 1.0;\n"
"#elif HBIL_NORMAL_ENCODING_OCTAHEDRAL\n"
"    return hbil_unfold(t.xy);\n"
"#elif HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM\n"
"    return hbil_unfold(t.xy * 2.0 - 1.0);\n"
"#elif HBIL_NORMAL_ENCODING_OCTAHEDRAL_888\n"
"    // low bytes of x and y, then their high halves in one byte\n"
"    uvec3 b = uvec3(hbil_finite(t) * 255.0 + 0.5);\n"
"    uvec2 o = b.xy | uvec2((b.z & 15u) << 8, (b.z >> 4) << 8);\n"
"    return hbil_unfold(vec2(o) / 4095.0 * 2.0 - 1.0);\n"
"#elif HBIL_NORMAL_ENCODING_XY || HBIL_NORMAL_ENCODING_XY_UNORM\n"
"#if HBIL_NORMAL_ENCODING_XY_UNORM\n"
"    t = t * 2.0 - 1.0;\n"
"#endif\n"
"    // quantised channels may be longer than 1: the root is guarded. z towards the camera\n"
"    return vec3(t.xy, -HBIL_VIEW_Z * sqrt(max(1.0 - dot(t.xy, t.xy), 0.0)));\n"
"#else\n"
"    return t;\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_prepare_hbil_neighbour[] =
"// Nearness at a pixel; -1e30 outside the screen and on the sky.\n"
"float hbil_neighbour(ivec2 p) {\n"
"    if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, hbil_frame_size()))) return -1e30;\n"
"    float z = hbil_view_depth(p);\n"
"    return z < HBIL_SKY ? hbil_nearness(z) : -1e30;\n"
"}\n";
static const char hbil__glsl_prepare_hbil_tangent[] =
"// Surface tangent along one screen axis: towards the side whose two pixels lie straighter in line with this one, so\n"
"// that a silhouette or a crease beside the pixel is not averaged in.\n"
"vec3 hbil_tangent(ivec2 p, ivec2 axis, float z) {\n"
"    float here = hbil_nearness(z);\n"
"    float left = hbil_neighbour(p - axis);\n"
"    float right = hbil_neighbour(p + axis);\n"
"    float bend_left = abs(2.0 * left - hbil_neighbour(p - 2 * axis) - here);\n"
"    float bend_right = abs(2.0 * right - hbil_neighbour(p + 2 * axis) - here);\n"
"    bool lost_left = left < -1e29;\n"
"    bool lost_right = right < -1e29;\n"
"    // right where both bend alike: by 1e30, if the first pixel of one side and the second of the other are lost\n"
"    float side = lost_right || bend_left < bend_right ? -1.0 : 1.0;\n"
"    float there = side < 0.0 ? left : right;\n"
"    if (lost_left && lost_right) there = here;\n"
"    vec2 q = hbil_centre(p + int(side) * axis);\n"
"    return side * (hbil_position(q, hbil_depth_of(there)) - hbil_position(hbil_centre(p), z));\n"
"}\n";
static const char hbil__glsl_prepare_hbil_view_normal[] =
"// Unit normal in view space, z into the screen. A normal that is zero, infinite or NaN is replaced by the view vector.\n"
"vec3 hbil_view_normal(ivec2 p, float z) {\n"
"    vec3 v = hbil_view_vector(hbil_centre(p));\n"
"#if HBIL_NORMALS_DEPTH\n"
"    vec3 n = cross(hbil_tangent(p, ivec2(1, 0), z), hbil_tangent(p, ivec2(0, 1), z));\n"
"    n /= max(max(abs(n.x), abs(n.y)), max(abs(n.z), 1e-30));\n"
"    n = dot(n, v) < 0.0 ? -n : n;\n"
"#elif HBIL_NORMALS_WORLD\n"
"    vec3 n = HBIL_WORLD_TO_VIEW * hbil_load_raw_normal(p);\n"
"#else\n"
"    vec3 n = hbil_load_raw_normal(p) * vec3(1.0, 1.0, HBIL_VIEW_Z);\n"
"#endif\n"
"    float l2 = dot(n, n);\n"
"    return l2 > 0.0 && l2 < 1e12 ? n * inversesqrt(l2) : v;\n"
"}\n";
static const char hbil__glsl_prepare_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, hbil_frame_size()))) return;\n"
"    float z = hbil_view_depth(p);\n"
"    uint normal = z < HBIL_SKY ? hbil_encode_normal(hbil_view_normal(p, z)) : 0u;\n"
"#if HBIL_COARSE\n"
"    imageStore(u_full_depth, p, vec4(z));\n"
"    imageStore(u_full_normal, p, uvec4(normal));\n"
"#else\n"
"    imageStore(u_view_depth, p, vec4(z));\n"
"    imageStore(u_view_normal, p, uvec4(normal));\n"
"#if HBIL_PACKED && !HBIL_BOUNCES_RECURSIVE\n"
"    imageStore(u_view_radiance, p, uvec4(hbil_pack_radiance(hbil_load_radiance(p))));\n"
"#endif\n"
"#if HBIL_REPROJECT_SCATTER\n"
"    imageStore(u_landed, p, uvec4(HBIL_NOWHERE));\n"
"#endif\n"
"#endif\n"
"}\n";
static const char hbil__glsl_shrink_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, HBIL_SIZE))) return;\n"
"    vec4 z;\n"
"    for (int i = 0; i < 4; ++i) z[i] = texelFetch(u_full_depth, hbil_quad(p, i), 0).r;\n"
"    bool farthest = ((p.x + p.y) & 1) != 0;\n"
"    int taken = 0;\n"
"    for (int i = 1; i < 4; ++i)\n"
"        if (z[taken] >= HBIL_SKY || (z[i] < HBIL_SKY && (farthest ? z[i] > z[taken] : z[i] < z[taken]))) taken = i;\n"
"    uint code = texelFetch(u_full_normal, hbil_quad(p, taken), 0).r;\n"
"    float depth = z[taken];\n"
"    hbil_surface s = hbil_surface_at(hbil_centre(hbil_quad(p, taken)), depth, code);\n"
"    bool flat_here = depth < HBIL_SKY;\n"
"    for (int i = 0; i < 4; ++i)\n"
"        flat_here = flat_here\n"
"            && abs(dot(s.n, hbil_position(hbil_centre(hbil_quad(p, i)), z[i]) - s.position)) < 0.5 * s.pixel;\n"
"    if (flat_here) {\n"
"        // 0.5 but in blocks that leave the frame\n"
"        vec2 t = (vec2(p) + 0.5 - hbil_centre(hbil_quad(p, 0))) * float(HBIL_DOWNSCALE);\n"
"        float nearness = mix(mix(hbil_nearness(z.x), hbil_nearness(z.y), t.x),\n"
"            mix(hbil_nearness(z.z), hbil_nearness(z.w), t.x), t.y);\n"
"        float middle = hbil_depth_of(nearness);\n"
"        if (abs(middle - depth) < 0.5 * hbil_depth_scale(depth)) depth = middle; // NaN not\n"
"    }\n"
"    imageStore(u_view_depth, p, vec4(depth));\n"
"    imageStore(u_view_normal, p, uvec4(code));\n"
"#if HBIL_GATHER && !HBIL_BOUNCES_RECURSIVE\n"
"    imageStore(u_view_radiance, p, uvec4(hbil_pack_radiance(hbil_grid_radiance(p, hbil_quad_weights(p, depth)))));\n"
"#endif\n"
"#if HBIL_REPROJECT_SCATTER\n"
"    imageStore(u_landed, p, uvec4(HBIL_NOWHERE));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_scatter_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    bool inside = all(lessThan(p, HBIL_SIZE));\n"
"    if (inside) imageStore(u_claimed, p, uvec4(HBIL_NOWHERE));\n"
"    if (!inside || HBIL_RESET != 0) return; // in one condition: see hbil_find\n"
"    ivec2 to;\n"
"    float z;\n"
"    for (int y = p.y; y < HBIL_LAST_SIZE.y; y += HBIL_SIZE.y) // last frame may have been larger\n"
"        for (int x = p.x; x < HBIL_LAST_SIZE.x; x += HBIL_SIZE.x)\n"
"            if (hbil_land(ivec2(x, y), to, z)) imageAtomicMin(u_landed, to, hbil_depth_key(z));\n"
"}\n";
static const char hbil__glsl_claim_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, HBIL_SIZE)) || HBIL_RESET != 0) return;\n"
"    ivec2 to;\n"
"    float z;\n"
"    for (int y = p.y; y < HBIL_LAST_SIZE.y; y += HBIL_SIZE.y)\n"
"        for (int x = p.x; x < HBIL_LAST_SIZE.x; x += HBIL_SIZE.x)\n"
"            if (hbil_land(ivec2(x, y), to, z) && texelFetch(u_landed, to, 0).r == hbil_depth_key(z))\n"
"                imageAtomicMin(u_claimed, to, uint(x) | uint(y) << 16);\n"
"}\n";
static const char hbil__glsl_push_hbil_landed_light[] =
"// Irradiance and depth of what fell on a pixel; a = 0: nothing did.\n"
"vec4 hbil_landed_light(ivec2 p) {\n"
"    if (any(greaterThanEqual(p, HBIL_SIZE))) return vec4(0.0);\n"
"    uint claim = texelFetch(u_claimed, p, 0).r;\n"
"    if (claim == HBIL_NOWHERE) return vec4(0.0);\n"
"    vec3 light = hbil_last_irradiance(ivec2(claim & 65535u, claim >> 16));\n"
"    return vec4(light, hbil_key_depth(texelFetch(u_landed, p, 0).r));\n"
"}\n";
static const char hbil__glsl_push_hbil_push_near[] =
"// Texel q of level 1 or 2 from the four below it.\n"
"vec4 hbil_push_near(ivec2 q, int level, vec4 a, vec4 b, vec4 c, vec4 d) {\n"
"    vec4 mean = hbil_push(a, b, c, d);\n"
"    if (all(lessThan(q << level, HBIL_SIZE))) imageStore(u_pushed, hbil_pushed_at(q, level), mean);\n"
"    return mean;\n"
"}\n";
static const char hbil__glsl_push_hbil_push_pair[] =
"// Level 2 from 4 x 4 pixels.\n"
"vec4 hbil_push_pair(ivec2 q) {\n"
"    vec4 m[4];\n"
"    for (int i = 0; i < 4; ++i) {\n"
"        ivec2 r = 2 * q + ivec2(i & 1, i >> 1);\n"
"        m[i] = hbil_push_near(r, 1, hbil_landed_light(2 * r), hbil_landed_light(2 * r + ivec2(1, 0)),\n"
"            hbil_landed_light(2 * r + ivec2(0, 1)), hbil_landed_light(2 * r + 1));\n"
"    }\n"
"    return hbil_push_near(q, 2, m[0], m[1], m[2], m[3]);\n"
"}\n";
static const char hbil__glsl_push_main[] =
"void main() {\n"
"    ivec2 q = hbil_texel();\n"
"    if (any(greaterThanEqual(8 * q, HBIL_SIZE)) || !hbil_has_pushed()) return;\n"
"    vec4 mean = hbil_push(hbil_push_pair(2 * q), hbil_push_pair(2 * q + ivec2(1, 0)),\n"
"        hbil_push_pair(2 * q + ivec2(0, 1)), hbil_push_pair(2 * q + 1));\n"
"    imageStore(u_pushed_8, q, mean);\n"
"}\n";
static const char hbil__glsl_push_2_hbil_pushed[] =
"// What push made of 8 x 8 pixels.\n"
"vec4 hbil_pushed(ivec2 q) {\n"
"    return any(greaterThanEqual(8 * q, HBIL_SIZE)) ? vec4(0.0) : texelFetch(u_pushed_8, q, 0);\n"
"}\n";
static const char hbil__glsl_push_2_hbil_push_far[] =
"// Texel q of level 4 to 6 from the four below it.\n"
"vec4 hbil_push_far(ivec2 q, int level, vec4 a, vec4 b, vec4 c, vec4 d) {\n"
"    vec4 mean = hbil_push(a, b, c, d);\n"
"    if (all(lessThan(q << level, HBIL_SIZE))) imageStore(u_pushed_far, hbil_pushed_far_at(q, level), mean);\n"
"    return mean;\n"
"}\n";
static const char hbil__glsl_push_2_hbil_push_pair[] =
"// Level 5 from 4 x 4 texels of level 3.\n"
"vec4 hbil_push_pair(ivec2 q) {\n"
"    vec4 m[4];\n"
"    for (int i = 0; i < 4; ++i) {\n"
"        ivec2 r = 2 * q + ivec2(i & 1, i >> 1);\n"
"        m[i] = hbil_push_far(r, 4, hbil_pushed(2 * r), hbil_pushed(2 * r + ivec2(1, 0)),\n"
"            hbil_pushed(2 * r + ivec2(0, 1)), hbil_pushed(2 * r + 1));\n"
"    }\n"
"    return hbil_push_far(q, 5, m[0], m[1], m[2], m[3]);\n"
"}\n";
static const char hbil__glsl_push_2_main[] =
"void main() {\n"
"    ivec2 q = hbil_texel();\n"
"    if (!hbil_has_pushed()) return;\n"
"    hbil_push_far(q, 6, hbil_push_pair(2 * q), hbil_push_pair(2 * q + ivec2(1, 0)),\n"
"        hbil_push_pair(2 * q + ivec2(0, 1)), hbil_push_pair(2 * q + 1));\n"
"}\n";
static const char hbil__glsl_reproject_HBIL_GAIN_MAX[] =
"const float HBIL_GAIN_MAX = 0.95; // of a bounce: albedo * near_intensity. Below 1, so that light dies out\n";
static const char hbil__glsl_reproject_hbil_pull[] =
"#if HBIL_REPROJECT_SCATTER\n"
"// Light for a hole: of the finest level that knows of a surface at about this depth.\n"
"vec3 hbil_pull(ivec2 p, float z) {\n"
"    for (int level = 1; level <= HBIL_PUSHED && hbil_has_pushed(); ++level) {\n"
"        vec2 at = (vec2(p) + 0.5) / float(1 << level) - 0.5;\n"
"        ivec2 first = ivec2(floor(at));\n"
"        vec2 f = at - vec2(first);\n"
"        ivec2 size = (HBIL_SIZE + (1 << level) - 1) >> level;\n"
"        vec4 sum = vec4(0.0);\n"
"        for (int i = 0; i < 4; ++i) {\n"
"            ivec2 o = ivec2(i & 1, i >> 1);\n"
"            ivec2 q = clamp(first + o, ivec2(0), size - 1);\n"
"            vec4 t = level < 3 ? texelFetch(u_pushed, hbil_pushed_at(q, level), 0)\n"
"                : level < 4 ? texelFetch(u_pushed_8, q, 0) : texelFetch(u_pushed_far, hbil_pushed_far_at(q, level), 0);\n"
"            if (t.a == 0.0 || abs(t.a - z) > HBIL_SAME_DEPTH * hbil_depth_scale(z)) continue;\n"
"            vec2 w = mix(1.0 - f, f, vec2(o));\n"
"            sum += w.x * w.y * vec4(t.rgb, 1.0); // at is never whole: no weight is 0\n"
"        }\n"
"        if (sum.a > 0.0) return sum.rgb / sum.a;\n"
"    }\n"
"    return vec3(0.0);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_reproject_hbil_last_light[] =
"// Irradiance that the surface had in the last frame.\n"
"vec3 hbil_last_light(ivec2 p, float z) {\n"
"    hbil_taps t = hbil_find(p, hbil_position(vec2(p) + 0.5, z), hbil_load_normal(p));\n"
"    vec3 sum = vec3(0.0);\n"
"    for (int i = 0; i < 4; ++i) {\n"
"        if (t.weights[i] <= 0.0) continue;\n"
"        sum += t.weights[i] * hbil_last_irradiance(t.first + ivec2(i & 1, i >> 1));\n"
"    }\n"
"    if (t.all > 0.0) return sum / t.all;\n"
"#if HBIL_REPROJECT_SCATTER\n"
"    return hbil_pull(p, z); // after a reset nothing was pushed\n"
"#else\n"
"    return vec3(0.0);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_reproject_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, HBIL_SIZE))) return;\n"
"    float z = hbil_load_depth(p);\n"
"    vec3 radiance = vec3(0.0);\n"
"    if (z < HBIL_SKY) {\n"
"#if HBIL_COARSE\n"
"        vec4 w = hbil_quad_weights(p, z);\n"
"        radiance = hbil_grid_radiance(p, w);\n"
"        vec3 albedo = hbil_grid_albedo(p, w);\n"
"#else\n"
"        radiance = hbil_load_radiance(p);\n"
"        vec3 albedo = hbil_load_albedo(p);\n"
"#endif\n"
"        vec3 gain = min(albedo, vec3(HBIL_GAIN_MAX / HBIL_NEAR_INTENSITY));\n"
"        radiance = hbil_finite(radiance + gain * hbil_last_light(p, z));\n"
"    }\n"
"    imageStore(u_view_radiance, p, uvec4(hbil_pack_radiance(radiance)));\n"
"#if !HBIL_TEMPORAL_YES\n"
"    imageStore(u_seen, p, uvec4(hbil_pack_seen(z, 0.0)));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_mips_hbil_tile[] =
"#if HBIL_STAGE_COMPUTE\n"
"shared float hbil_tile[64]; // nearness of the group's texels, -1e30: sky or off the screen\n"
"#else\n"
"float hbil_tile[64]; // nearness of the texels under this one, rows of 8, -1e30: sky or off the screen\n"
"#endif\n";
static const char hbil__glsl_mips_hbil_tile_light[] =
"#if HBIL_GATHER && HBIL_STAGE_COMPUTE\n"
"shared vec3 hbil_tile_light[64];\n"
"#elif HBIL_GATHER\n"
"vec3 hbil_tile_light[64];\n"
"#endif\n";
static const char hbil__glsl_mips_HBIL_SAME_SURFACE[] =
"const float HBIL_SAME_SURFACE = 0.95; // of the nearest texel's nearness (its inverse for an orthographic camera)\n";
static const char hbil__glsl_mips_hbil_weights[] =
"// How much each of four texels counts.\n"
"vec4 hbil_weights(vec4 nearness) {\n"
"    vec4 there = vec4(greaterThan(nearness, vec4(-1e29)));\n"
"#if HBIL_MIPS_MEAN || HBIL_MIPS_SPREAD\n"
"    return there;\n"
"#else\n"
"    float top = max(max(nearness.x, nearness.y), max(nearness.z, nearness.w));\n"
"#if HBIL_MIPS_NEAREST\n"
"    return there * vec4(equal(nearness, vec4(top)));\n"
"#elif HBIL_PROJECTION_PERSPECTIVE\n"
"    return there * vec4(greaterThanEqual(nearness, vec4(top * HBIL_SAME_SURFACE)));\n"
"#else\n"
"    return there * vec4(greaterThanEqual(nearness, vec4(top - abs(top) * (1.0 - HBIL_SAME_SURFACE))));\n"
"#endif\n"
"#endif\n"
"}\n";
static const char hbil__glsl_mips_hbil_load_tile[] =
"// Pixel p into the tile.\n"
"void hbil_load_tile(ivec2 p, int i) {\n"
"    bool inside = all(lessThan(p, HBIL_SIZE));\n"
"    float z = inside ? hbil_load_depth(p) : HBIL_SKY;\n"
"    hbil_tile[i] = z < HBIL_SKY ? hbil_nearness(z) : -1e30;\n"
"#if HBIL_GATHER\n"
"    hbil_tile_light[i] = hbil_unpack_radiance(inside ? texelFetch(u_view_radiance, p, 0).r : 0u);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_mips_hbil_reduce[] =
"// One texel of a level from four of the level below, i: the first of them in the tile, stride: to its neighbours.\n"
"void hbil_reduce(int i, int stride) {\n"
"    vec4 n = vec4(hbil_tile[i], hbil_tile[i + stride], hbil_tile[i + 8 * stride], hbil_tile[i + 9 * stride]);\n"
"    vec4 w = hbil_weights(n);\n"
"    float all = dot(w, vec4(1.0));\n"
"    float inv = 1.0 / max(all, 1.0);\n"
"    vec4 known = mix(vec4(0.0), n, greaterThan(w, vec4(0.0)));\n"
"    float mean = dot(w, known) * inv;\n"
"#if HBIL_MIPS_SPREAD\n"
"    vec4 off = known - mean;\n"
"    mean += sqrt(dot(w, off * off) * inv);\n"
"#endif\n"
"    hbil_tile[i] = all > 0.0 ? mean : -1e30;\n"
"#if HBIL_GATHER\n"
"    vec3 light = w.x * hbil_tile_light[i] + w.y * hbil_tile_light[i + stride]\n"
"        + w.z * hbil_tile_light[i + 8 * stride] + w.w * hbil_tile_light[i + 9 * stride];\n"
"    hbil_tile_light[i] = light * inv;\n"
"#endif\n"
"}\n";
static const char hbil__glsl_mips_hbil_store_level[] =
"// What the tile holds at i, to texel q of a level.\n"
"void hbil_store_level(ivec2 q, int level, int i) {\n"
"    vec4 z = vec4(hbil_tile[i] > -1e29 ? hbil_depth_of(hbil_tile[i]) : HBIL_SKY);\n"
"#if HBIL_STAGE_COMPUTE\n"
"    imageStore(u_depth_mips, hbil_level_at(q, level), z);\n"
"#else\n"
"    u_depth_mips[1] = z;\n"
"#endif\n"
"#if HBIL_GATHER && HBIL_STAGE_COMPUTE\n"
"    imageStore(u_radiance_mips, hbil_level_at(q, level), uvec4(hbil_pack_radiance(hbil_tile_light[i])));\n"
"#elif HBIL_GATHER\n"
"    u_radiance_mips[1] = uvec4(hbil_pack_radiance(hbil_tile_light[i]));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_mips_main[] =
"#if HBIL_STAGE_COMPUTE\n"
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    ivec2 at = ivec2(gl_LocalInvocationID.xy);\n"
"    int i = at.y * 8 + at.x;\n"
"    hbil_load_tile(p, i);\n"
"    if (all(lessThan(p, HBIL_SIZE))) {\n"
"        imageStore(u_depth_mips, ivec3(p, 0), vec4(hbil_load_depth(p)));\n"
"#if HBIL_GATHER\n"
"        imageStore(u_radiance_mips, ivec3(p, 0), uvec4(texelFetch(u_view_radiance, p, 0).r));\n"
"#endif\n"
"    }\n"
"    for (int level = 1; level <= HBIL_LEVELS; ++level) {\n"
"        int stride = 1 << level;\n"
"        ivec2 q = p >> level;\n"
"        barrier();\n"
"        if (at.x % stride != 0 || at.y % stride != 0) continue;\n"
"        hbil_reduce(i, stride / 2);\n"
"        if (all(lessThan(q << level, HBIL_SIZE)) && hbil_levels() > 0) hbil_store_level(q, level, i);\n"
"    }\n"
"}\n"
"#else\n"
"// Each pixel is layer 0 and, in layer 1, a texel of the level that lies there: it reduces the pixels under that.\n"
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    u_depth_mips[0] = vec4(hbil_load_depth(p));\n"
"#if HBIL_GATHER\n"
"    u_radiance_mips[0] = uvec4(texelFetch(u_view_radiance, p, 0).r);\n"
"#endif\n"
"    ivec2 corner = hbil_level_at(ivec2(0), 3).xy;\n"
"    int level = p.x < corner.x ? 1 : p.y < corner.y ? 2 : 3;\n"
"    ivec2 q = p - hbil_level_at(ivec2(0), level).xy;\n"
"    int side = 1 << level;\n"
"    for (int y = 0; y < side; ++y)\n"
"        for (int x = 0; x < side; ++x) hbil_load_tile(side * q + ivec2(x, y), 8 * y + x);\n"
"    for (int stride = 2; stride <= side; stride *= 2)\n"
"        for (int y = 0; y < side; y += stride)\n"
"            for (int x = 0; x < side; x += stride) hbil_reduce(8 * y + x, stride / 2);\n"
"    hbil_store_level(q, level, 0);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_sweep_HBIL_BACK_LOW[] =
"const float HBIL_BACK_LOW = -0.7; // cosine of normal and way to the next pixel up to which a surface turns its back\n";
static const char hbil__glsl_sweep_HBIL_BACK_HIGH[] =
"const float HBIL_BACK_HIGH = -0.3; // and from which on it does not: a smooth surface has 0\n";
static const char hbil__glsl_sweep_hbil_lit_step[] =
"#if HBIL_GATHER && !HBIL_FACING_NONE\n"
"// Part of the light of pixel p that goes on along the line, to the pixel `next`: none if p turns its back there.\n"
"float hbil_lit_step(ivec2 p, float nearness, ivec2 next, float next_nearness) {\n"
"    vec3 way = hbil_position(vec2(next) + 0.5, hbil_depth_of(next_nearness))\n"
"        - hbil_position(vec2(p) + 0.5, hbil_depth_of(nearness));\n"
"    float facing = dot(hbil_load_normal(p), way) * inversesqrt(max(dot(way, way), 1e-30));\n"
"    return smoothstep(HBIL_BACK_LOW, HBIL_BACK_HIGH, facing);\n"
"}\n"
"#endif\n";
static const char hbil__glsl_sweep_hbil_jump[] =
"// Jump of the pixel `at`, which sees the pixel v before it: over all that stands lower, along the jumps from there on.\n"
"// With it goes what stands up below: at.rise, and at.light as a sum.\n"
"void hbil_jump(hbil_line l, int start, int way, int layer, hbil_vertex v, inout hbil_vertex at) {\n"
"    while (v.back != 0) {\n"
"        int outward = v.step - way * v.back;\n"
"        ivec2 q = hbil_pixel(l, start, outward);\n"
"        float nearness = hbil_nearness(hbil_load_depth(q));\n"
"        if (!hbil_steeper(at, v, outward, nearness)) break;\n"
"#if HBIL_GATHER\n"
"        at.rise += v.rise;\n"
"        at.light += v.rise * v.light;\n"
"        v.light = hbil_unpack_radiance(imageLoad(u_swept_light, ivec3(q, layer)).r);\n"
"#endif\n"
"        uint code = imageLoad(u_swept, ivec3(q, layer)).r;\n"
"        v.back = hbil_back(code);\n"
"#if HBIL_GATHER\n"
"        v.rise = hbil_rise_in(code);\n"
"#endif\n"
"        v.nearness = nearness;\n"
"        v.step = outward;\n"
"    }\n"
"    at.back = abs(at.step - v.step);\n"
"}\n";
static const char hbil__glsl_sweep_hbil_walk[] =
"// One walk along a line, towards smaller steps if `down`.\n"
"void hbil_walk(hbil_line l, int lane, int width, bool down, int layer) {\n"
"    int steps = hbil_across(l, HBIL_SIZE).x;\n"
"    int way = down ? -1 : 1;\n"
"    int start = lane; // place across where the line would begin\n"
"    hbil_vertex last; // the last pixel with a surface\n"
"    last.step = -1;\n"
"#if HBIL_GATHER\n"
"    vec3 own = vec3(0.0); // its own radiance\n"
"#if !HBIL_FACING_NONE\n"
"    ivec2 before = ivec2(0);\n"
"#endif\n"
"#if HBIL_FACING_FILTER\n"
"    vec3 accepted = vec3(0.0); // the last light that was taken\n"
"#endif\n"
"#endif\n"
"    for (int step = down ? steps - 1 : 0; down ? step >= 0 : step < steps; step += way) {\n"
"        int place = lane + hbil_shift(l, step);\n"
"        int here = lane - int(floor((float(place) + 0.5) / float(width))) * width;\n"
"        if (here != start) last.step = -1; // the line has come in again on the other side\n"
"        start = here;\n"
"        ivec2 p = hbil_pixel(l, start, step);\n"
"        if (any(greaterThanEqual(p, HBIL_SIZE))) continue;\n"
"        float z = hbil_load_depth(p);\n"
"        bool surface = z < HBIL_SKY;\n"
"        hbil_vertex at;\n"
"        at.nearness = hbil_nearness(z);\n"
"        at.step = step;\n"
"        at.back = last.step >= 0 ? abs(step - last.step) : 0; // of the sky: to the last surface\n"
"#if HBIL_GATHER\n"
"        at.rise = 0.0;\n"
"        at.light = vec3(0.0);\n"
"#endif\n"
"        if (surface && last.step >= 0) {\n"
"#if HBIL_GATHER\n"
"#if HBIL_FACING_HALF_SPACE\n"
"            own *= hbil_lit_step(before, last.nearness, p, at.nearness);\n"
"#elif HBIL_FACING_FILTER\n"
"            accepted = mix(accepted, own, hbil_lit_step(before, last.nearness, p, at.nearness));\n"
"            own = accepted;\n"
"#endif\n"
"            at.rise = hbil_rise(l, at.nearness, last.nearness);\n"
"            at.light = at.rise * own;\n"
"#endif\n"
"            hbil_jump(l, start, way, layer, last, at);\n"
"#if HBIL_GATHER\n"
"            at.light = at.rise > 0.0 ? at.light / at.rise : own;\n"
"#endif\n"
"        }\n"
"        imageStore(u_swept, ivec3(p, layer), uvec4(hbil_code(at)));\n"
"#if HBIL_GATHER\n"
"        imageStore(u_swept_light, ivec3(p, layer), uvec4(hbil_pack_radiance(at.light)));\n"
"#endif\n"
"        if (!surface) continue;\n"
"#if HBIL_GATHER\n"
"        own = hbil_unpack_radiance(texelFetch(u_view_radiance, p, 0).r);\n"
"#if !HBIL_FACING_NONE\n"
"        before = p;\n"
"#endif\n"
"#endif\n"
"        last = at;\n"
"    }\n"
"}\n";
static const char hbil__glsl_sweep_main[] =
"void main() {\n"
"    int lane = int(gl_GlobalInvocationID.x);\n"
"    int layer = int(gl_GlobalInvocationID.y);\n"
"    int slice = layer / 2;\n"
"    // the lines of a direction side by side: neighbours in a wave do alike\n"
"#if HBIL_SWEEP_STRIDE_1\n"
"    hbil_line l = hbil_line_of(slice);\n"
"    int width = hbil_across(l, HBIL_SIZE).y;\n"
"#else\n"
"    int lines = (hbil_across(hbil_line_of(slice * HBIL_SWEEP_STRIDE), HBIL_SIZE).y - 1) / HBIL_SWEEP_STRIDE + 1;\n"
"    int width = lines * HBIL_SWEEP_STRIDE; // whole strides: a line that comes in again keeps its turn\n"
"    hbil_line l = hbil_line_of(slice * HBIL_SWEEP_STRIDE + min(lane / lines, HBIL_SWEEP_STRIDE - 1));\n"
"    lane = lane < width ? lane % lines * HBIL_SWEEP_STRIDE + lane / lines : width;\n"
"#endif\n"
"    if (lane < width) hbil_walk(l, lane, width, layer % 2 == 0, layer);\n"
"}\n";
static const char hbil__glsl_march_hbil_nothing[] =
"hbil_sums hbil_nothing() {\n"
"    hbil_sums sum;\n"
"#if HBIL_SWEPT\n"
"    sum.weight = 0.0;\n"
"#endif\n"
"#if !HBIL_COSINE\n"
"    sum.hidden = 0.0;\n"
"#endif\n"
"#if HBIL_SUMS\n"
"    sum.full = 0.0;\n"
"    sum.blocked = 0.0;\n"
"#endif\n"
"#if HBIL_NEAR_LIGHT\n"
"    sum.near = vec3(0.0);\n"
"#endif\n"
"#if HBIL_BENT\n"
"    sum.bent = vec3(0.0);\n"
"#endif\n"
"#if HBIL_OUTPUTS_UNIFORM_AO\n"
"    sum.uniform_open = 0.0;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    sum.sh_0 = vec4(0.0);\n"
"    sum.sh_x = vec4(0.0);\n"
"    sum.sh_y = vec4(0.0);\n"
"    sum.sh_z = vec4(0.0);\n"
"#endif\n"
"#if HBIL_FAR_BITS\n"
"    sum.far = vec3(0.0);\n"
"#endif\n"
"    return sum;\n"
"}\n";
static const char hbil__glsl_march_hbil_add_sums[] =
"#if HBIL_SWEPT\n"
"// Add a slice that stands for more or less azimuth than another.\n"
"void hbil_add_sums(hbil_sums slice, float weight, inout hbil_sums sum) {\n"
"    sum.weight += weight;\n"
"#if HBIL_SUMS\n"
"    sum.full += weight * slice.full;\n"
"    sum.blocked += weight * slice.blocked;\n"
"#endif\n"
"#if HBIL_NEAR_LIGHT\n"
"    sum.near += weight * slice.near;\n"
"#endif\n"
"#if HBIL_BENT\n"
"    sum.bent += weight * slice.bent;\n"
"#endif\n"
"#if HBIL_OUTPUTS_UNIFORM_AO\n"
"    sum.uniform_open += weight * slice.uniform_open;\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    sum.sh_0 += weight * slice.sh_0;\n"
"    sum.sh_x += weight * slice.sh_x;\n"
"    sum.sh_y += weight * slice.sh_y;\n"
"    sum.sh_z += weight * slice.sh_z;\n"
"#endif\n"
"#if HBIL_FAR_BITS\n"
"    sum.far += weight * slice.far;\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_march_hbil_march_swept[] =
"#if HBIL_SWEPT\n"
"// All slices of a pixel. The lines of a sweep are uniform on the screen: each counts for the azimuth around V that it\n"
"// stands for.\n"
"hbil_sums hbil_march_swept(ivec2 p, float z) {\n"
"    hbil_sums sum = hbil_nothing();\n"
"    hbil_receiver r = hbil_receive(p, z);\n"
"#if HBIL_MARCH_BOTH\n"
"    vec3 noise = hbil_noise(p);\n"
"#endif\n"
"    for (int i = 0; i < HBIL_SLICES; ++i) {\n"
"#if HBIL_SWEEP_STRIDE_1\n"
"        hbil_line line = hbil_line_of(i);\n"
"#else\n"
"        int turn = (2 * i < HBIL_SLICES ? p.y : p.x) % HBIL_SWEEP_STRIDE;\n"
"        hbil_line line = hbil_line_of(i * HBIL_SWEEP_STRIDE + turn);\n"
"#endif\n"
"        vec3 d = vec3(line.d * HBIL_PIXEL_TO_RAY.xy, 0.0);\n"
"        vec3 across = d - dot(d, r.v) * r.v;\n"
"        float inv = inversesqrt(dot(across, across));\n"
"        hbil_sums one = hbil_nothing();\n"
"#if HBIL_MARCH_BOTH\n"
"        hbil_bitmask_slice(r, across * inv, line, i, vec2(noise.y, fract(noise.z + float(i) * 0.61803399)), one);\n"
"#else\n"
"        hbil_horizon_slice(r, across * inv, line, i, one);\n"
"#endif\n"
"        hbil_add_sums(one, inv * inv, sum);\n"
"    }\n"
"    return sum;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_march_hbil_march[] =
"// All slices of a pixel.\n"
"hbil_sums hbil_march(ivec2 p, float z) {\n"
"    hbil_sums sum = hbil_nothing();\n"
"    hbil_receiver r = hbil_receive(p, z);\n"
"    vec3 noise = hbil_noise(p);\n"
"#if !HBIL_SEED_COMPAT_SCREEN_AZIMUTH\n"
"    // Slices are uniform in azimuth around V, not on the screen, or walls and floors away from the image centre\n"
"    // get the wrong weight. e1, e2: any frame about V (v.z < 0); k1, k2: their directions on the screen, linear\n"
"    // in D.\n"
"    float a = 1.0 / (1.0 - r.v.z);\n"
"    vec3 e1 = vec3(1.0 - r.v.x * r.v.x * a, -r.v.x * r.v.y * a, r.v.x);\n"
"    vec3 e2 = vec3(r.v.x * r.v.y * a, r.v.y * r.v.y * a - 1.0, -r.v.y);\n"
"    vec2 k1 = (r.v.xy * e1.z - e1.xy * r.v.z) / HBIL_PIXEL_TO_RAY.xy;\n"
"    vec2 k2 = (r.v.xy * e2.z - e2.xy * r.v.z) / HBIL_PIXEL_TO_RAY.xy;\n"
"#endif\n"
"    for (int i = 0; i < HBIL_SLICES; ++i) {\n"
"#if HBIL_SEED_COMPAT_NOISE_2PI\n"
"        float phi = float(i) * HBIL_PI / float(HBIL_SLICES) + noise.x * 2.0 * HBIL_PI;\n"
"#else\n"
"        float phi = (float(i) + noise.x) * HBIL_PI / float(HBIL_SLICES);\n"
"#endif\n"
"        vec2 turn = vec2(cos(phi), sin(phi));\n"
"#if HBIL_SEED_COMPAT_SCREEN_AZIMUTH\n"
"        vec3 slice = normalize(vec3(turn, 0.0) - dot(turn, r.v.xy) * r.v);\n"
"        vec2 d = normalize(turn / HBIL_PIXEL_TO_RAY.xy);\n"
"#else\n"
"        vec3 slice = turn.x * e1 + turn.y * e2;\n"
"        vec2 d = normalize(turn.x * k1 + turn.y * k2);\n"
"#endif\n"
"#if HBIL_ESTIMATOR_BITMASK\n"
"        hbil_bitmask_slice(r, slice, d, vec2(noise.y, fract(noise.z + float(i) * 0.61803399)), sum);\n"
"#elif HBIL_ESTIMATOR_HORIZON\n"
"        hbil_horizon_slice(r, slice, d, noise.y, sum);\n"
"#else\n"
"        hbil_hbao_slice(r, slice, d, noise.y, sum);\n"
"#endif\n"
"    }\n"
"    return sum;\n"
"}\n";
static const char hbil__glsl_march_hbil_mean[] =
"// What turns sums over slices into means.\n"
"float hbil_mean(hbil_sums sum) {\n"
"#if HBIL_SWEPT\n"
"    return 1.0 / sum.weight;\n"
"#else\n"
"    return 1.0 / float(HBIL_SLICES);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_march_hbil_store_sh[] =
"#if HBIL_OUTPUTS_SH\n"
"// Integrals of 1 and of the direction to coefficients. scale: of band 1; band 0 needs no ratio, each slice has its\n"
"// whole solid angle. Near radiance and visibility together are those of the open hemisphere.\n"
"void hbil_store_sh(hbil_sums sum, float scale, inout vec4 s[HBIL_LAYERS]) {\n"
"    vec4 factor = vec4(vec3(HBIL_PI * HBIL_NEAR_INTENSITY), HBIL_PI);\n"
"    s[HBIL_AT_SH] = 0.282095 * hbil_mean(sum) * factor * sum.sh_0;\n"
"    s[HBIL_AT_SH + 1] = 0.488603 * scale * factor * sum.sh_y;\n"
"    s[HBIL_AT_SH + 2] = 0.488603 * scale * factor * HBIL_VIEW_Z * sum.sh_z;\n"
"    s[HBIL_AT_SH + 3] = 0.488603 * scale * factor * sum.sh_x;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_march_hbil_store[] =
"// Sums to a signal.\n"
"void hbil_store(hbil_sums sum, out vec4 s[HBIL_LAYERS]) {\n"
"    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] = vec4(0.0);\n"
"#if HBIL_RATIO && !HBIL_DEFER\n"
"    // what few slices get wrong about an open sky cancels. Never 0: n.v is not\n"
"    float scale = 1.0 / sum.full;\n"
"#elif HBIL_DEFER || (HBIL_SEED_COMPAT_SLICE_MEAN && HBIL_COSINE && (HBIL_VISIBILITY || HBIL_GATHER || HBIL_FAR_BITS))\n"
"    float scale = hbil_mean(sum);\n"
"#endif\n"
"#if HBIL_DEFER\n"
"    s[0].a = scale * sum.blocked;\n"
"    s[HBIL_AT_BENT].a = scale * sum.full; // rounding may leave it below what is blocked: see hbil_finish\n"
"#elif HBIL_VISIBILITY\n"
"#if !HBIL_COSINE\n"
"    float ao = 1.0 - sum.hidden * hbil_mean(sum);\n"
"#elif HBIL_SEED_COMPAT_SLICE_MEAN\n"
"    float ao = (sum.full - sum.blocked) * scale;\n"
"#else\n"
"    float ao = 1.0 - sum.blocked * scale;\n"
"#endif\n"
"    s[0].a = clamp(ao, 0.0, 1.0);\n"
"#endif\n"
"#if HBIL_NEAR_LIGHT\n"
"    s[0].rgb = scale * HBIL_NEAR_INTENSITY * sum.near;\n"
"#endif\n"
"#if HBIL_BENT\n"
"    // no ratio: from two slices on the vectors of an open surface add up to 2/3 n by themselves\n"
"    s[HBIL_AT_BENT].xyz = sum.bent * hbil_mean(sum) * vec3(1.0, 1.0, HBIL_VIEW_Z);\n"
"#endif\n"
"#if HBIL_OUTPUTS_UNIFORM_AO\n"
"    s[HBIL_AT_FAR].a = sum.uniform_open * hbil_mean(sum);\n"
"#endif\n"
"#if HBIL_FAR_BITS\n"
"    s[HBIL_AT_FAR].rgb = hbil_finite(scale * sum.far);\n"
"#endif\n"
"#if HBIL_OUTPUTS_SH\n"
"    hbil_store_sh(sum, scale, s);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_march_main[] =
"void main() {\n"
"#if HBIL_INTERLEAVE_YES && HBIL_STAGE_COMPUTE\n"
"    // place by place of the 4 x 4, each a quarter of the screen wide: a wave has one noise\n"
"    ivec2 quarter = (HBIL_SIZE + 3) / 4;\n"
"    ivec2 g = hbil_texel();\n"
"    ivec2 p = g % quarter * 4 + g / quarter;\n"
"    if (any(greaterThanEqual(g, 4 * quarter))) return;\n"
"#else\n"
"    ivec2 p = hbil_texel();\n"
"#endif\n"
"    if (any(greaterThanEqual(p, HBIL_SIZE))) return;\n"
"    float z = hbil_load_depth(p);\n"
"    if (z >= HBIL_SKY) {\n"
"#if !HBIL_STAGED\n"
"        hbil_finish_sky(p);\n"
"#endif\n"
"        return;\n"
"    }\n"
"    vec4 s[HBIL_LAYERS];\n"
"#if HBIL_SWEPT\n"
"    hbil_store(hbil_march_swept(p, z), s);\n"
"#else\n"
"    hbil_store(hbil_march(p, z), s);\n"
"#endif\n"
"#if HBIL_STAGED\n"
"    hbil_pass_on(p, s);\n"
"#else\n"
"    hbil_finish(p, s);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_temporal_HBIL_RECTIFY_WIDTH[] =
"#if HBIL_RECTIFY_VARIANCE\n"
"const float HBIL_RECTIFY_WIDTH = 2.0; // standard deviations that history may be off\n"
"#endif\n";
static const char hbil__glsl_temporal_hbil_rectify[] =
"#if !HBIL_RECTIFY_NONE\n"
"// History that this frame's 3 x 3 pixels could have made.\n"
"vec4 hbil_rectify(ivec2 p, int layer, vec4 past) {\n"
"#if HBIL_RECTIFY_VARIANCE\n"
"    vec4 sum = vec4(0.0);\n"
"    vec4 squares = vec4(0.0);\n"
"#else\n"
"    vec4 low = vec4(1e30);\n"
"    vec4 high = vec4(-1e30);\n"
"#endif\n"
"    float count = 0.0;\n"
"    for (int y = -1; y <= 1; ++y)\n"
"        for (int x = -1; x <= 1; ++x) {\n"
"            ivec2 q = clamp(p + ivec2(x, y), ivec2(0), HBIL_SIZE - 1);\n"
"            if (hbil_load_depth(q) >= HBIL_SKY) continue;\n"
"            vec4 s = hbil_signal(q, layer);\n"
"#if HBIL_RECTIFY_VARIANCE\n"
"            sum += s;\n"
"            squares += s * s;\n"
"#else\n"
"            low = min(low, s);\n"
"            high = max(high, s);\n"
"#endif\n"
"            count += 1.0;\n"
"        }\n"
"#if HBIL_RECTIFY_VARIANCE\n"
"    vec4 mean = sum / count;\n"
"    vec4 room = HBIL_RECTIFY_WIDTH * sqrt(max(squares / count - mean * mean, vec4(0.0)));\n"
"    return clamp(past, mean - room, mean + room);\n"
"#else\n"
"    return clamp(past, low, high);\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_temporal_hbil_last_signal[] =
"// The same of last frame's running mean.\n"
"vec4 hbil_last_signal(ivec2 p, int layer) {\n"
"#if HBIL_ONLY_AO\n"
"    return texelFetch(u_last_signal, ivec3(p, layer), 0).rrrr;\n"
"#else\n"
"    return texelFetch(u_last_signal, ivec3(p, layer), 0);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_temporal_HBIL_SANE[] =
"const float HBIL_SANE = 1e7; // history beyond, or that is no number, is thrown away\n";
static const char hbil__glsl_temporal_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, HBIL_SIZE))) return;\n"
"    float z = hbil_load_depth(p);\n"
"    if (z >= HBIL_SKY) {\n"
"        imageStore(u_seen, p, uvec4(hbil_pack_seen(HBIL_SKY, 0.0)));\n"
"#if HBIL_FILTER_NONE && !HBIL_COARSE\n"
"        hbil_finish_sky(p);\n"
"#endif\n"
"        return;\n"
"    }\n"
"    hbil_taps t = hbil_find(p, hbil_position(vec2(p) + 0.5, z), hbil_load_normal(p));\n"
"    float frames = t.all > 0.0 ? min(t.frames / t.all + 1.0, float(HBIL_HISTORY)) : 1.0;\n"
"    vec4 s[HBIL_LAYERS];\n"
"    for (int i = 0; i < HBIL_LAYERS; ++i) {\n"
"        s[i] = hbil_signal(p, i);\n"
"        if (t.all <= 0.0) continue;\n"
"        vec4 past = vec4(0.0);\n"
"        for (int k = 0; k < 4; ++k)\n"
"            if (t.weights[k] > 0.0)\n"
"                past += t.weights[k] * hbil_last_signal(t.first + ivec2(k & 1, k >> 1), i);\n"
"        past /= t.all;\n"
"        if (!all(lessThan(abs(past), vec4(HBIL_SANE)))) { // NaN too\n"
"            frames = 1.0;\n"
"            continue;\n"
"        }\n"
"#if !HBIL_RECTIFY_NONE\n"
"        past = hbil_rectify(p, i, past);\n"
"#endif\n"
"        s[i] = mix(past, s[i], 1.0 / frames);\n"
"    }\n"
"    imageStore(u_seen, p, uvec4(hbil_pack_seen(z, frames)));\n"
"    hbil_pass_on(p, s);\n"
"#if HBIL_FILTER_NONE && !HBIL_COARSE\n"
"    hbil_finish(p, s);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_filter_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, HBIL_SIZE))) return;\n"
"#if HBIL_ARITHMETIC_HALF\n"
"    mediump vec4 s[HBIL_LAYERS];\n"
"#else\n"
"    vec4 s[HBIL_LAYERS];\n"
"#endif\n"
"    bool surface = hbil_filter(p, 1, s);\n"
"#if HBIL_FILTER_PASSES_1 && !HBIL_COARSE\n"
"    if (surface) hbil_finish(p, s);\n"
"    else hbil_finish_sky(p);\n"
"#else\n"
"    if (surface) hbil_pass_on(p, s);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_filter_2_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, HBIL_SIZE))) return;\n"
"#if HBIL_ARITHMETIC_HALF\n"
"    mediump vec4 s[HBIL_LAYERS];\n"
"#else\n"
"    vec4 s[HBIL_LAYERS];\n"
"#endif\n"
"    bool surface = hbil_filter(p, 2, s);\n"
"#if HBIL_FILTER_PASSES_2 && !HBIL_COARSE\n"
"    if (surface) hbil_finish(p, s);\n"
"    else hbil_finish_sky(p);\n"
"#else\n"
"    if (surface) hbil_pass_on(p, s);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_filter_3_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, HBIL_SIZE))) return;\n"
"#if HBIL_ARITHMETIC_HALF\n"
"    mediump vec4 s[HBIL_LAYERS];\n"
"#else\n"
"    vec4 s[HBIL_LAYERS];\n"
"#endif\n"
"    bool surface = hbil_filter(p, 4, s);\n"
"#if !HBIL_COARSE\n"
"    if (surface) hbil_finish(p, s);\n"
"    else hbil_finish_sky(p);\n"
"#else\n"
"    if (surface) hbil_pass_on(p, s);\n"
"#endif\n"
"}\n";
static const char hbil__glsl_upsample_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, HBIL_FULL_SIZE))) return;\n"
"    float z = texelFetch(u_full_depth, p, 0).r;\n"
"    if (z >= HBIL_SKY) {\n"
"        hbil_finish_sky(p);\n"
"        return;\n"
"    }\n"
"    vec2 at = hbil_centre(p);\n"
"    hbil_surface here = hbil_surface_at(at, z, texelFetch(u_full_normal, p, 0).r);\n"
"    ivec2 first = ivec2(floor(at - 0.5));\n"
"    vec2 f = at - 0.5 - vec2(first);\n"
"    vec4 w = vec4(1.0 - f.x, f.x, 1.0 - f.x, f.x) * vec4(vec2(1.0 - f.y), vec2(f.y));\n"
"    float all = 0.0;\n"
"    float least = 1e30; // difference in depth, for a pixel that none of the four belongs to\n"
"    ivec2 like = ivec2(0);\n"
"#if HBIL_ARITHMETIC_HALF\n"
"    mediump vec4 s[HBIL_LAYERS];\n"
"#else\n"
"    vec4 s[HBIL_LAYERS];\n"
"#endif\n"
"    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] = vec4(0.0);\n"
"    for (int k = 0; k < 4; ++k) {\n"
"        ivec2 q = clamp(first + ivec2(k & 1, k >> 1), ivec2(0), HBIL_SIZE - 1);\n"
"        float share = w[k] * hbil_belongs(here, q, 1.0);\n"
"        float off = abs(hbil_load_depth(q) - z);\n"
"        if (off < least) {\n"
"            least = off;\n"
"            like = q;\n"
"        }\n"
"        if (share <= 0.0) continue;\n"
"        all += share;\n"
"        hbil_blend(q, share / all, s);\n"
"    }\n"
"    if (all < 1e-3) {\n"
"        if (hbil_load_depth(like) >= HBIL_SKY) {\n"
"            hbil_finish_sky(p);\n"
"            return;\n"
"        }\n"
"        hbil_blend(like, 1.0, s);\n"
"    }\n"
"    hbil_finish(p, s);\n"
"}\n";
static const char hbil__glsl_light_hbil_angle[] =
"// acos by sums and products, which are exact everywhere: Vulkan lets acos and atan be wrong by 5e-4. c in [-1, 1]; rad,\n"
"// error 5e-7. Abramowitz and Stegun 4.4.46\n"
"float hbil_angle(float c) {\n"
"    float a = abs(c);\n"
"    float p = ((0.0066700901 - 0.0012624911 * a) * a - 0.0170881256) * a + 0.0308918810;\n"
"    p = (((p * a - 0.0501743046) * a + 0.0889789874) * a - 0.2145988016) * a + 1.5707963050;\n"
"    float angle = sqrt(1.0 - a) * p;\n"
"    return c < 0.0 ? HBIL_PI - angle : angle;\n"
"}\n";
static const char hbil__glsl_light_hbil_caps[] =
"// Solid angle that two spherical caps share, neither more than a hemisphere. c1, c2: cosines of their half angles; cd:\n"
"// of the angle between their axes, which rounding may take beyond 1.\n"
"float hbil_caps(float c1, float c2, float cd) {\n"
"    float s1 = sqrt((1.0 - c1) * (1.0 + c1));\n"
"    float s2 = sqrt((1.0 - c2) * (1.0 + c2));\n"
"    if (cd <= c1 * c2 - s1 * s2) return 0.0;\n"
"    if (cd >= min(c1 * c2 + s1 * s2, 1.0)) return 2.0 * HBIL_PI * (1.0 - max(c1, c2));\n"
"    // from here on no cap is a point, and their axes are not the same\n"
"    float sd = sqrt((1.0 - cd) * (1.0 + cd));\n"
"    float lens = HBIL_PI - hbil_angle(clamp((cd - c1 * c2) / (s1 * s2), -1.0, 1.0))\n"
"        - c1 * hbil_angle(clamp((c2 - cd * c1) / (sd * s1), -1.0, 1.0))\n"
"        - c2 * hbil_angle(clamp((c1 - cd * c2) / (sd * s2), -1.0, 1.0));\n"
"    return 2.0 * lens;\n"
"}\n";
static const char hbil__glsl_light_hbil_specular_occlusion[] =
"// Part of the specular lobe that the visible cone leaves: GTSO with the open hemisphere's share of the lobe below it,\n"
"// so that an open surface gets 1. Rough lobes are wider than a cone can say: they get ao. r: perceptual roughness.\n"
"float hbil_specular_occlusion(vec3 n, vec3 v, float ao, vec3 axis, float r) {\n"
"    float lobe = exp2(-3.32193 * max(r, 0.02) * max(r, 0.02));\n"
"    vec3 mirror = 2.0 * dot(n, v) * n - v;\n"
"    // min: a root of 1 may be above it\n"
"    float seen = hbil_caps(min(sqrt(1.0 - ao), 1.0), lobe, dot(axis, mirror));\n"
"    float open = hbil_caps(0.0, lobe, dot(n, mirror));\n"
"    return mix(clamp(seen / open, 0.0, 1.0), ao, smoothstep(0.5, 0.8, r));\n"
"}\n";
static const char hbil__glsl_light_hbil_multi_bounce[] =
"// Visibility after all bounces between surfaces of this albedo and visibility, per channel.\n"
"vec3 hbil_multi_bounce(float ao, vec3 albedo) {\n"
"#if HBIL_BOUNCE_CUBIC\n"
"    vec3 a = 2.0404 * albedo - 0.3324;\n"
"    vec3 b = -4.7951 * albedo + 0.6417;\n"
"    vec3 c = 2.7552 * albedo + 0.6903;\n"
"    return clamp(((a * ao + b) * ao + c) * ao, vec3(ao), vec3(1.0)); // the fit passes 1 by 1e-4\n"
"#else\n"
"    return ao / max(1.0 - albedo * (1.0 - ao), vec3(max(ao, 1e-6)));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_light_hbil_far_light[] =
"#if HBIL_FAR_HERE\n"
"// Far irradiance of a pixel.\n"
"vec3 hbil_far_light(ivec2 p, hbil_opening o) {\n"
"    vec3 far = HBIL_FAR_INTENSITY * hbil_far(o);\n"
"#if !HBIL_F0_NONE\n"
"    far *= hbil_diffuse(p);\n"
"#endif\n"
"    return far;\n"
"}\n"
"#endif\n";
static const char hbil__glsl_light_hbil_store_bounce[] =
"#if HBIL_BOUNCES_RECURSIVE\n"
"// What the surface may reflect in the next frame, on the grid.\n"
"void hbil_store_bounce(ivec2 p, vec3 irradiance) {\n"
"    uint code = hbil_pack_radiance(hbil_finite(irradiance));\n"
"#if HBIL_STAGE_FRAGMENT\n"
"    imageStore(u_bounce, p, uvec4(code)); // of every pixel: a fragment cannot write another one\n"
"#else\n"
"    ivec2 q = p / HBIL_DOWNSCALE;\n"
"    if (p == hbil_middle(q)) imageStore(u_bounce, q, uvec4(code));\n"
"#endif\n"
"}\n"
"#endif\n";
static const char hbil__glsl_light_hbil_shade[] =
"// Outputs of a pixel with a surface.\n"
"void hbil_shade(ivec2 p, float z) {\n"
"#if HBIL_LIGHT_AO\n"
"    float ao = texelFetch(u_ao, p, 0).r;\n"
"#endif\n"
"#if HBIL_OUTPUTS_CONE || HBIL_OUTPUTS_SPECULAR_OCCLUSION || (HBIL_FAR_HERE && !HBIL_ENVIRONMENT_CONSTANT)\n"
"    vec3 v = hbil_view_vector(hbil_centre(p));\n"
"#if HBIL_COARSE\n"
"    vec3 n = hbil_turned(hbil_decode_normal(texelFetch(u_full_normal, p, 0).r), v);\n"
"#else\n"
"    vec3 n = hbil_turned(hbil_load_normal(p), v);\n"
"#endif\n"
"#endif\n"
"#if HBIL_OUTPUTS_CONE || HBIL_OUTPUTS_SPECULAR_OCCLUSION || HBIL_FAR_BENT\n"
"    vec3 bent = texelFetch(u_bent, p, 0).xyz * vec3(1.0, 1.0, HBIL_VIEW_Z);\n"
"#endif\n"
"#if HBIL_OUTPUTS_CONE\n"
"    imageStore(u_cone, p, vec4(hbil_direction(bent, n) * vec3(1.0, 1.0, HBIL_VIEW_Z), hbil_cone_cosine(ao)));\n"
"#endif\n"
"#if HBIL_OUTPUTS_SPECULAR_OCCLUSION\n"
"#if HBIL_ROUGHNESS_0\n"
"    float roughness = hbil_finite(texelFetch(u_roughness, p, 0).rrr).r;\n"
"#else\n"
"    float roughness = HBIL_ROUGHNESS;\n"
"#endif\n"
"    imageStore(u_specular_occlusion, p, vec4(hbil_specular_occlusion(n, v, ao, hbil_direction(bent, n), roughness)));\n"
"#endif\n"
"#if HBIL_OUTPUTS_MULTI_BOUNCE\n"
"    imageStore(u_multi_bounce, p, vec4(hbil_multi_bounce(ao, hbil_load_albedo(p)), 1.0));\n"
"#endif\n"
"#if HBIL_FAR_HERE\n"
"    hbil_opening o;\n"
"    o.ao = ao;\n"
"#if HBIL_FAR_VISIBILITY_AO && !HBIL_ENVIRONMENT_CONSTANT\n"
"    o.axis = hbil_to_world(n);\n"
"#elif !HBIL_ENVIRONMENT_CONSTANT\n"
"    o.axis = hbil_to_world(hbil_direction(bent, n));\n"
"#endif\n"
"#if HBIL_FAR_SH && HBIL_FAR_VISIBILITY_BENT\n"
"    o.bent = length(bent);\n"
"#endif\n"
"#if HBIL_ENVIRONMENT_PROBES || HBIL_ENVIRONMENT_HOOK\n"
"    o.position = hbil_world_position(hbil_position(hbil_centre(p), z));\n"
"#endif\n"
"    vec3 irradiance = hbil_far_light(p, o);\n"
"#elif HBIL_FAR_BITS && HBIL_SUMMED\n"
"    vec3 irradiance = texelFetch(u_far, p, 0).rgb;\n"
"#elif HBIL_SUMMED\n"
"    vec3 irradiance = vec3(0.0);\n"
"#endif\n"
"#if HBIL_OUTPUTS_FAR && !HBIL_FAR_BITS\n"
"    imageStore(u_far, p, vec4(irradiance, 1.0));\n"
"#endif\n"
"#if HBIL_NEAR_LIGHT && HBIL_SUMMED\n"
"    irradiance += texelFetch(u_near, p, 0).rgb;\n"
"#endif\n"
"#if HBIL_OUTPUTS_IRRADIANCE\n"
"    imageStore(u_irradiance, p, vec4(irradiance, 1.0));\n"
"#endif\n"
"#if HBIL_BOUNCES_RECURSIVE\n"
"    hbil_store_bounce(p, irradiance);\n"
"#endif\n"
"#if HBIL_OUTPUTS_COMPOSITE\n"
"    vec3 direct = hbil_finite(texelFetch(u_direct, p, 0).rgb);\n"
"    imageStore(u_composite, p, vec4(direct + hbil_load_albedo(p) * irradiance, 1.0));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_light_hbil_shade_sky[] =
"// Outputs of a pixel without a surface.\n"
"void hbil_shade_sky(ivec2 p) {\n"
"#if HBIL_OUTPUTS_CONE\n"
"    imageStore(u_cone, p, vec4(0.0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_SPECULAR_OCCLUSION\n"
"    imageStore(u_specular_occlusion, p, vec4(1.0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_MULTI_BOUNCE\n"
"    imageStore(u_multi_bounce, p, vec4(1.0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_FAR && !HBIL_FAR_BITS\n"
"    imageStore(u_far, p, vec4(0.0, 0.0, 0.0, 1.0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_IRRADIANCE\n"
"    imageStore(u_irradiance, p, vec4(0.0, 0.0, 0.0, 1.0));\n"
"#endif\n"
"#if HBIL_BOUNCES_RECURSIVE\n"
"    hbil_store_bounce(p, vec3(0.0));\n"
"#endif\n"
"#if HBIL_OUTPUTS_COMPOSITE\n"
"    imageStore(u_composite, p, vec4(hbil_finite(texelFetch(u_direct, p, 0).rgb), 1.0));\n"
"#endif\n"
"}\n";
static const char hbil__glsl_light_main[] =
"void main() {\n"
"    ivec2 p = hbil_texel();\n"
"    if (any(greaterThanEqual(p, hbil_frame_size()))) return;\n"
"#if HBIL_COARSE\n"
"    float z = texelFetch(u_full_depth, p, 0).r;\n"
"#else\n"
"    float z = hbil_load_depth(p);\n"
"#endif\n"
"    if (z < HBIL_SKY) hbil_shade(p, z);\n"
"    else hbil_shade_sky(p);\n"
"}\n";
static const struct { const char *name, *file, *text; } hbil__chunks[] = {
    { "vertex", "triangle", hbil__glsl_triangle_vertex },
    { "HBIL_SKY", "common", hbil__glsl_common_HBIL_SKY },
    { "HBIL_RADIANCE_MAX", "common", hbil__glsl_common_HBIL_RADIANCE_MAX },
    { "HBIL_PI", "common", hbil__glsl_common_HBIL_PI },
    { "hbil_texel", "common", hbil__glsl_common_hbil_texel },
    { "hbil_position", "common", hbil__glsl_common_hbil_position },
    { "hbil_nearness", "common", hbil__glsl_common_hbil_nearness },
    { "hbil_depth_of", "common", hbil__glsl_common_hbil_depth_of },
    { "hbil_view_vector", "common", hbil__glsl_common_hbil_view_vector },
    { "hbil_finite", "common", hbil__glsl_common_hbil_finite },
    { "hbil_pack_snorm", "common", hbil__glsl_common_hbil_pack_snorm },
    { "hbil_unpack_snorm", "common", hbil__glsl_common_hbil_unpack_snorm },
    { "hbil_encode_normal", "common", hbil__glsl_common_hbil_encode_normal },
    { "hbil_decode_normal", "common", hbil__glsl_common_hbil_decode_normal },
    { "hbil_load_depth", "common", hbil__glsl_common_hbil_load_depth },
    { "hbil_load_normal", "common", hbil__glsl_common_hbil_load_normal },
    { "hbil_direction", "common", hbil__glsl_common_hbil_direction },
    { "hbil_diffuse", "common", hbil__glsl_common_hbil_diffuse },
    { "hbil_load_albedo", "common", hbil__glsl_common_hbil_load_albedo },
    { "hbil_to_world", "environment", hbil__glsl_environment_hbil_to_world },
    { "hbil_world_position", "environment", hbil__glsl_environment_hbil_world_position },
    { "hbil_sh", "environment", hbil__glsl_environment_hbil_sh },
    { "HBIL_SLABS", "environment", hbil__glsl_environment_HBIL_SLABS },
    { "hbil_load_sh", "environment", hbil__glsl_environment_hbil_load_sh },
    { "hbil_sh_sum", "environment", hbil__glsl_environment_hbil_sh_sum },
    { "hbil_cone_bands", "environment", hbil__glsl_environment_hbil_cone_bands },
    { "hbil_cone_cosine", "environment", hbil__glsl_environment_hbil_cone_cosine },
    { "hbil_fit", "environment", hbil__glsl_environment_hbil_fit },
    { "hbil_opening", "environment", hbil__glsl_environment_hbil_opening },
    { "hbil_far", "environment", hbil__glsl_environment_hbil_far },
    { "hbil_frame_turn", "lines", hbil__glsl_lines_hbil_frame_turn },
    { "hbil_line", "lines", hbil__glsl_lines_hbil_line },
    { "hbil_line_of", "lines", hbil__glsl_lines_hbil_line_of },
    { "hbil_shift", "lines", hbil__glsl_lines_hbil_shift },
    { "hbil_across", "lines", hbil__glsl_lines_hbil_across },
    { "hbil_pixel", "lines", hbil__glsl_lines_hbil_pixel },
    { "hbil_vertex", "lines", hbil__glsl_lines_hbil_vertex },
    { "hbil_code", "lines", hbil__glsl_lines_hbil_code },
    { "hbil_back", "lines", hbil__glsl_lines_hbil_back },
    { "hbil_rise_in", "lines", hbil__glsl_lines_hbil_rise_in },
    { "hbil_steeper", "lines", hbil__glsl_lines_hbil_steeper },
    { "hbil_rise", "lines", hbil__glsl_lines_hbil_rise },
    { "hbil_pack_radiance", "lines", hbil__glsl_lines_hbil_pack_radiance },
    { "hbil_unpack_radiance", "lines", hbil__glsl_lines_hbil_unpack_radiance },
    { "HBIL_LEVELS", "levels", hbil__glsl_levels_HBIL_LEVELS },
    { "hbil_level_at", "levels", hbil__glsl_levels_hbil_level_at },
    { "hbil_levels", "levels", hbil__glsl_levels_hbil_levels },
    { "hbil_hilbert", "slice", hbil__glsl_slice_hbil_hilbert },
    { "hbil_gradient", "slice", hbil__glsl_slice_hbil_gradient },
    { "hbil_block", "slice", hbil__glsl_slice_hbil_block },
    { "hbil_noise", "slice", hbil__glsl_slice_hbil_noise },
    { "hbil_arc", "slice", hbil__glsl_slice_hbil_arc },
    { "HBIL_STRIDE", "slice", hbil__glsl_slice_HBIL_STRIDE },
    { "hbil_offset", "slice", hbil__glsl_slice_hbil_offset },
    { "hbil_border", "slice", hbil__glsl_slice_hbil_border },
    { "hbil_reach", "slice", hbil__glsl_slice_hbil_reach },
    { "hbil_receiver", "slice", hbil__glsl_slice_hbil_receiver },
    { "HBIL_LEAST_NY", "slice", hbil__glsl_slice_HBIL_LEAST_NY },
    { "hbil_turned", "slice", hbil__glsl_slice_hbil_turned },
    { "hbil_receive", "slice", hbil__glsl_slice_hbil_receive },
    { "hbil_surface_depth", "slice", hbil__glsl_slice_hbil_surface_depth },
    { "hbil_side", "slice", hbil__glsl_slice_hbil_side },
    { "hbil_side_of", "slice", hbil__glsl_slice_hbil_side_of },
    { "hbil_horizon_at", "slice", hbil__glsl_slice_hbil_horizon_at },
    { "hbil_swept", "slice", hbil__glsl_slice_hbil_swept },
    { "hbil_visit", "slice", hbil__glsl_slice_hbil_visit },
    { "hbil_start", "slice", hbil__glsl_slice_hbil_start },
    { "HBIL_FINE", "slice", hbil__glsl_slice_HBIL_FINE },
    { "hbil_go", "slice", hbil__glsl_slice_hbil_go },
    { "hbil_fade", "slice", hbil__glsl_slice_hbil_fade },
    { "hbil_normal_at", "slice", hbil__glsl_slice_hbil_normal_at },
    { "hbil_load_radiance", "slice", hbil__glsl_slice_hbil_load_radiance },
    { "hbil_radiance_at", "slice", hbil__glsl_slice_hbil_radiance_at },
    { "HBIL_FILTER_LOW", "slice", hbil__glsl_slice_HBIL_FILTER_LOW },
    { "HBIL_FILTER_HIGH", "slice", hbil__glsl_slice_HBIL_FILTER_HIGH },
    { "hbil_source", "slice", hbil__glsl_slice_hbil_source },
    { "hbil_sums", "slice", hbil__glsl_slice_hbil_sums },
    { "hbil_add_moments", "slice", hbil__glsl_slice_hbil_add_moments },
    { "hbil_light", "horizon", hbil__glsl_horizon_hbil_light },
    { "hbil_dark", "horizon", hbil__glsl_horizon_hbil_dark },
    { "hbil_weight", "horizon", hbil__glsl_horizon_hbil_weight },
    { "hbil_lit", "horizon", hbil__glsl_horizon_hbil_lit },
    { "hbil_add_arc", "horizon", hbil__glsl_horizon_hbil_add_arc },
    { "hbil_step", "horizon", hbil__glsl_horizon_hbil_step },
    { "hbil_add_corner", "horizon", hbil__glsl_horizon_hbil_add_corner },
    { "hbil_add_cell", "horizon", hbil__glsl_horizon_hbil_add_cell },
    { "HBIL_DECAY_STEPS", "horizon", hbil__glsl_horizon_HBIL_DECAY_STEPS },
    { "hbil_horizon", "horizon", hbil__glsl_horizon_hbil_horizon },
    { "hbil_bent", "horizon", hbil__glsl_horizon_hbil_bent },
    { "hbil_add_light", "horizon", hbil__glsl_horizon_hbil_add_light },
    { "hbil_horizon_slice", "horizon", hbil__glsl_horizon_hbil_horizon_slice },
    { "hbil_fan", "bitmask", hbil__glsl_bitmask_hbil_fan },
    { "hbil_edge_light", "bitmask", hbil__glsl_bitmask_hbil_edge_light },
    { "hbil_fan_of", "bitmask", hbil__glsl_bitmask_hbil_fan_of },
    { "hbil_edge", "bitmask", hbil__glsl_bitmask_hbil_edge },
    { "hbil_bits", "bitmask", hbil__glsl_bitmask_hbil_bits },
    { "hbil_lit_bits", "bitmask", hbil__glsl_bitmask_hbil_lit_bits },
    { "hbil_turn", "bitmask", hbil__glsl_bitmask_hbil_turn },
    { "hbil_span", "bitmask", hbil__glsl_bitmask_hbil_span },
    { "hbil_span_to", "bitmask", hbil__glsl_bitmask_hbil_span_to },
    { "hbil_lowest_bit", "bitmask", hbil__glsl_bitmask_hbil_lowest_bit },
    { "hbil_bit_count", "bitmask", hbil__glsl_bitmask_hbil_bit_count },
    { "hbil_span_of", "bitmask", hbil__glsl_bitmask_hbil_span_of },
    { "hbil_add_bits", "bitmask", hbil__glsl_bitmask_hbil_add_bits },
    { "hbil_low_end", "bitmask", hbil__glsl_bitmask_hbil_low_end },
    { "hbil_fill", "bitmask", hbil__glsl_bitmask_hbil_fill },
    { "hbil_fill_swept", "bitmask", hbil__glsl_bitmask_hbil_fill_swept },
    { "hbil_far_arc", "bitmask", hbil__glsl_bitmask_hbil_far_arc },
    { "hbil_bitmask_slice", "bitmask", hbil__glsl_bitmask_hbil_bitmask_slice },
    { "hbil_attenuation", "hbao", hbil__glsl_hbao_hbil_attenuation },
    { "hbil_hidden", "hbao", hbil__glsl_hbao_hbil_hidden },
    { "hbil_hbao_slice", "hbao", hbil__glsl_hbao_hbil_hbao_slice },
    { "hbil_frame_size", "grid", hbil__glsl_grid_hbil_frame_size },
    { "hbil_centre", "grid", hbil__glsl_grid_hbil_centre },
    { "hbil_middle", "grid", hbil__glsl_grid_hbil_middle },
    { "hbil_quad", "grid", hbil__glsl_grid_hbil_quad },
    { "HBIL_SAME_DEPTH", "grid", hbil__glsl_grid_HBIL_SAME_DEPTH },
    { "hbil_depth_scale", "grid", hbil__glsl_grid_hbil_depth_scale },
    { "hbil_quad_weights", "grid", hbil__glsl_grid_hbil_quad_weights },
    { "hbil_grid_radiance", "grid", hbil__glsl_grid_hbil_grid_radiance },
    { "hbil_grid_albedo", "grid", hbil__glsl_grid_hbil_grid_albedo },
    { "HBIL_LAYERS", "signal", hbil__glsl_signal_HBIL_LAYERS },
    { "HBIL_AT_BENT", "signal", hbil__glsl_signal_HBIL_AT_BENT },
    { "HBIL_AT_FAR", "signal", hbil__glsl_signal_HBIL_AT_FAR },
    { "HBIL_AT_SH", "signal", hbil__glsl_signal_HBIL_AT_SH },
    { "hbil_signal", "signal", hbil__glsl_signal_hbil_signal },
    { "hbil_pass_on", "signal", hbil__glsl_signal_hbil_pass_on },
    { "hbil_store_sh_at", "signal", hbil__glsl_signal_hbil_store_sh_at },
    { "hbil_finish", "signal", hbil__glsl_signal_hbil_finish },
    { "hbil_finish_sky", "signal", hbil__glsl_signal_hbil_finish_sky },
    { "HBIL_FILTER_PLANE", "signal", hbil__glsl_signal_HBIL_FILTER_PLANE },
    { "HBIL_FILTER_NORMAL", "signal", hbil__glsl_signal_HBIL_FILTER_NORMAL },
    { "hbil_surface", "signal", hbil__glsl_signal_hbil_surface },
    { "hbil_surface_at", "signal", hbil__glsl_signal_hbil_surface_at },
    { "hbil_belongs", "signal", hbil__glsl_signal_hbil_belongs },
    { "HBIL_FILTER_RADIUS", "signal", hbil__glsl_signal_HBIL_FILTER_RADIUS },
    { "hbil_blend", "signal", hbil__glsl_signal_hbil_blend },
    { "hbil_filter_share", "signal", hbil__glsl_signal_hbil_filter_share },
    { "hbil_filter", "signal", hbil__glsl_signal_hbil_filter },
    { "HBIL_NOWHERE", "last", hbil__glsl_last_HBIL_NOWHERE },
    { "hbil_pack_seen", "last", hbil__glsl_last_hbil_pack_seen },
    { "hbil_seen_depth", "last", hbil__glsl_last_hbil_seen_depth },
    { "hbil_move", "last", hbil__glsl_last_hbil_move },
    { "hbil_last_position", "last", hbil__glsl_last_hbil_last_position },
    { "hbil_pixel_of", "last", hbil__glsl_last_hbil_pixel_of },
    { "hbil_landing", "last", hbil__glsl_last_hbil_landing },
    { "hbil_land", "last", hbil__glsl_last_hbil_land },
    { "hbil_depth_key", "last", hbil__glsl_last_hbil_depth_key },
    { "hbil_key_depth", "last", hbil__glsl_last_hbil_key_depth },
    { "hbil_claim", "last", hbil__glsl_last_hbil_claim },
    { "hbil_last_pixel", "last", hbil__glsl_last_hbil_last_pixel },
    { "HBIL_LAST_PLANE", "last", hbil__glsl_last_HBIL_LAST_PLANE },
    { "hbil_taps", "last", hbil__glsl_last_hbil_taps },
    { "hbil_find", "last", hbil__glsl_last_hbil_find },
    { "hbil_last_irradiance", "last", hbil__glsl_last_hbil_last_irradiance },
    { "hbil_pushed_at", "last", hbil__glsl_last_hbil_pushed_at },
    { "hbil_pushed_far_at", "last", hbil__glsl_last_hbil_pushed_far_at },
    { "HBIL_PUSHED", "last", hbil__glsl_last_HBIL_PUSHED },
    { "hbil_has_pushed", "last", hbil__glsl_last_hbil_has_pushed },
    { "hbil_push", "last", hbil__glsl_last_hbil_push },
    { "hbil_load_raw_depth", "prepare", hbil__glsl_prepare_hbil_load_raw_depth },
    { "HBIL_LEAST_DEPTH", "prepare", hbil__glsl_prepare_HBIL_LEAST_DEPTH },
    { "hbil_view_depth", "prepare", hbil__glsl_prepare_hbil_view_depth },
    { "hbil_unfold", "prepare", hbil__glsl_prepare_hbil_unfold },
    { "hbil_load_raw_normal", "prepare", hbil__glsl_prepare_hbil_load_raw_normal },
    { "hbil_neighbour", "prepare", hbil__glsl_prepare_hbil_neighbour },
    { "hbil_tangent", "prepare", hbil__glsl_prepare_hbil_tangent },
    { "hbil_view_normal", "prepare", hbil__glsl_prepare_hbil_view_normal },
    { "main", "prepare", hbil__glsl_prepare_main },
    { "main", "shrink", hbil__glsl_shrink_main },
    { "main", "scatter", hbil__glsl_scatter_main },
    { "main", "claim", hbil__glsl_claim_main },
    { "hbil_landed_light", "push", hbil__glsl_push_hbil_landed_light },
    { "hbil_push_near", "push", hbil__glsl_push_hbil_push_near },
    { "hbil_push_pair", "push", hbil__glsl_push_hbil_push_pair },
    { "main", "push", hbil__glsl_push_main },
    { "hbil_pushed", "push_2", hbil__glsl_push_2_hbil_pushed },
    { "hbil_push_far", "push_2", hbil__glsl_push_2_hbil_push_far },
    { "hbil_push_pair", "push_2", hbil__glsl_push_2_hbil_push_pair },
    { "main", "push_2", hbil__glsl_push_2_main },
    { "HBIL_GAIN_MAX", "reproject", hbil__glsl_reproject_HBIL_GAIN_MAX },
    { "hbil_pull", "reproject", hbil__glsl_reproject_hbil_pull },
    { "hbil_last_light", "reproject", hbil__glsl_reproject_hbil_last_light },
    { "main", "reproject", hbil__glsl_reproject_main },
    { "hbil_tile", "mips", hbil__glsl_mips_hbil_tile },
    { "hbil_tile_light", "mips", hbil__glsl_mips_hbil_tile_light },
    { "HBIL_SAME_SURFACE", "mips", hbil__glsl_mips_HBIL_SAME_SURFACE },
    { "hbil_weights", "mips", hbil__glsl_mips_hbil_weights },
    { "hbil_load_tile", "mips", hbil__glsl_mips_hbil_load_tile },
    { "hbil_reduce", "mips", hbil__glsl_mips_hbil_reduce },
    { "hbil_store_level", "mips", hbil__glsl_mips_hbil_store_level },
    { "main", "mips", hbil__glsl_mips_main },
    { "HBIL_BACK_LOW", "sweep", hbil__glsl_sweep_HBIL_BACK_LOW },
    { "HBIL_BACK_HIGH", "sweep", hbil__glsl_sweep_HBIL_BACK_HIGH },
    { "hbil_lit_step", "sweep", hbil__glsl_sweep_hbil_lit_step },
    { "hbil_jump", "sweep", hbil__glsl_sweep_hbil_jump },
    { "hbil_walk", "sweep", hbil__glsl_sweep_hbil_walk },
    { "main", "sweep", hbil__glsl_sweep_main },
    { "hbil_nothing", "march", hbil__glsl_march_hbil_nothing },
    { "hbil_add_sums", "march", hbil__glsl_march_hbil_add_sums },
    { "hbil_march_swept", "march", hbil__glsl_march_hbil_march_swept },
    { "hbil_march", "march", hbil__glsl_march_hbil_march },
    { "hbil_mean", "march", hbil__glsl_march_hbil_mean },
    { "hbil_store_sh", "march", hbil__glsl_march_hbil_store_sh },
    { "hbil_store", "march", hbil__glsl_march_hbil_store },
    { "main", "march", hbil__glsl_march_main },
    { "HBIL_RECTIFY_WIDTH", "temporal", hbil__glsl_temporal_HBIL_RECTIFY_WIDTH },
    { "hbil_rectify", "temporal", hbil__glsl_temporal_hbil_rectify },
    { "hbil_last_signal", "temporal", hbil__glsl_temporal_hbil_last_signal },
    { "HBIL_SANE", "temporal", hbil__glsl_temporal_HBIL_SANE },
    { "main", "temporal", hbil__glsl_temporal_main },
    { "main", "filter", hbil__glsl_filter_main },
    { "main", "filter_2", hbil__glsl_filter_2_main },
    { "main", "filter_3", hbil__glsl_filter_3_main },
    { "main", "upsample", hbil__glsl_upsample_main },
    { "hbil_angle", "light", hbil__glsl_light_hbil_angle },
    { "hbil_caps", "light", hbil__glsl_light_hbil_caps },
    { "hbil_specular_occlusion", "light", hbil__glsl_light_hbil_specular_occlusion },
    { "hbil_multi_bounce", "light", hbil__glsl_light_hbil_multi_bounce },
    { "hbil_far_light", "light", hbil__glsl_light_hbil_far_light },
    { "hbil_store_bounce", "light", hbil__glsl_light_hbil_store_bounce },
    { "hbil_shade", "light", hbil__glsl_light_hbil_shade },
    { "hbil_shade_sky", "light", hbil__glsl_light_hbil_shade_sky },
    { "main", "light", hbil__glsl_light_main },
};
/* >>gen glsl */

/* ======================================================================
 * >>sink       bounded text: counts on at the limit and writes nothing more
 * ====================================================================== */

typedef struct hbil__sink { char *buf; size_t cap, size, lines /* ends of lines so far */; } hbil__sink;

static hbil__sink hbil__sink_open(char *buf, size_t cap)
{
    hbil__sink s;
    s.buf = buf;
    s.cap = buf ? cap : 0;
    s.size = s.lines = 0;
    return s;
}

static void hbil__put(hbil__sink *s, const char *text, size_t len)
{
    size_t room = s->size < s->cap ? s->cap - s->size - 1 : 0; /* one byte stays for the terminator */
    size_t i;
    if (room) memcpy(s->buf + s->size, text, len < room ? len : room);
    s->size += len;
    for (i = 0; i < len; ++i) s->lines += text[i] == '\n';
}

static void hbil__puts(hbil__sink *s, const char *text) { hbil__put(s, text, strlen(text)); }

static void hbil__put_upper(hbil__sink *s, const char *text)
{
    for (; *text; ++text) {
        char c = *text >= 'a' && *text <= 'z' ? (char)(*text - 'a' + 'A') : *text;
        hbil__put(s, &c, 1);
    }
}

static void hbil__put_int(hbil__sink *s, int64_t v)
{
    char digits[24];
    int  n = 24;
    uint64_t u = v < 0 ? (uint64_t)0 - (uint64_t)v : (uint64_t)v;
    do digits[--n] = (char)('0' + u % 10); while (u /= 10);
    if (v < 0) digits[--n] = '-';
    hbil__put(s, digits + n, (size_t)(24 - n));
}

static void hbil__put_hex(hbil__sink *s, uint64_t v)
{
    int i;
    for (i = 60; i >= 0; i -= 4) hbil__put(s, &"0123456789abcdef"[v >> i & 15], 1);
}

static double hbil__power10(int n) /* n in [-22, 22]; exact for n >= 0 */
{
    double p = 1;
    int i;
    for (i = 0; i < (n < 0 ? -n : n); ++i) p *= 10;
    return n < 0 ? 1 / p : p;
}

/* Shortest decimal that reads back as the same float: no exponent, '.' under any locale. |v| in [1e-9, 1e16] or 0.
 * point: "2.0" instead of "2", as GLSL wants it. */
static void hbil__put_float(hbil__sink *s, float v, int point)
{
    double a = v < 0 ? -(double)v : (double)v;
    int e = 0, n, i;
    uint64_t m = 0;
    char digits[24];
    if (!(a > 0)) { hbil__puts(s, point ? "0.0" : "0"); return; }
    if (v < 0) hbil__puts(s, "-");
    while (e < 20 && a >= hbil__power10(e + 1)) ++e;
    while (e > -20 && a < hbil__power10(e)) --e;
    for (n = 1; n <= 9; ++n) { /* n significant digits; nine always suffice for a float */
        int k = n - 1 - e;
        m = (uint64_t)(k >= 0 ? a * hbil__power10(k) + 0.5 : a / hbil__power10(-k) + 0.5);
        if ((float)(k >= 0 ? (double)m / hbil__power10(k) : (double)m * hbil__power10(-k)) == (float)a) break;
    }
    if (n > 9) n = 9;
    if (m >= (uint64_t)hbil__power10(n)) { m /= 10; ++e; } /* 9.99 rounded up to 10.0 */
    for (i = n; i-- > 0; m /= 10) digits[i] = (char)('0' + m % 10);
    if (e < 0) {
        hbil__puts(s, "0.");
        for (i = -1; i > e; --i) hbil__puts(s, "0");
        hbil__put(s, digits, (size_t)n);
        return;
    }
    for (i = 0; i < n || i <= e; ++i) {
        if (i == e + 1) hbil__puts(s, ".");
        hbil__put(s, i < n ? digits + i : "0", 1);
    }
    if (point && n <= e + 1) hbil__puts(s, ".0");
}

/* The same for any float: what is not in that range is out of every option's. */
static void hbil__put_any_float(hbil__sink *s, float v)
{
    if (v > -1e16f && v < 1e16f) hbil__put_float(s, v, 0);
    else hbil__puts(s, v == v ? "huge" : "nan");
}

static hbil_result hbil__sink_close(hbil__sink *s, size_t *need)
{
    if (s->cap) s->buf[s->size < s->cap ? s->size : s->cap - 1] = 0;
    if (need) *need = s->size + 1;
    return s->size < s->cap ? HBIL_OK : HBIL_E_SPACE;
}

/* ======================================================================
 * >>words      words of blank-separated lists, option lookup, diagnostics
 * ====================================================================== */

static int hbil__same(const char *word, const char *s, size_t len)
{
    size_t i;
    for (i = 0; i < len; ++i)
        if (word[i] != s[i]) return 0; /* also where word ends */
    return word[len] == 0;
}

/* index-th blank-separated word of a list; 0: there is none */
static int hbil__word_at(const char *list, int index, const char **word, size_t *len)
{
    for (; *list; list += *len, list += *list == ' ') {
        *word = list;
        for (*len = 0; list[*len] && list[*len] != ' '; ++*len) { }
        if (index-- == 0) return 1;
    }
    return 0;
}

static int hbil__word_find(const char *list, const char *s, size_t len)
{
    const char *w;
    size_t n;
    int i;
    for (i = 0; hbil__word_at(list, i, &w, &n); ++i)
        if (n == len && memcmp(w, s, len) == 0) return i;
    return -1;
}

/* Edits between two names (Levenshtein); names are below 32 bytes, longer ones count as far away. */
static int hbil__distance(const char *a, const char *b, size_t blen)
{
    int row[33], i, j, diagonal, up, an = (int)strlen(a), bn = (int)blen;
    if (an > 32 || blen > 32) return 99;
    for (j = 0; j <= bn; ++j) row[j] = j;
    for (i = 1; i <= an; ++i) {
        diagonal = row[0];
        row[0] = i;
        for (j = 1; j <= bn; ++j) {
            int best = diagonal + (a[i - 1] != b[j - 1]);
            up = row[j];
            if (up + 1 < best) best = up + 1;
            if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
            diagonal = up;
            row[j] = best;
        }
    }
    return row[bn];
}

/* Start a finding; NULL where it only counts. The text goes to the sink, which hbil__report_end closes. */
static hbil_diag *hbil__report(hbil_diags *diags, hbil_severity severity, int32_t option, hbil__sink *s)
{
    hbil_diag *d = NULL;
    *s = hbil__sink_open(NULL, 0);
    if (!diags) return NULL;
    if (diags->count >= 0 && diags->count < diags->capacity && diags->items) {
        d = &diags->items[diags->count];
        d->severity = severity;
        d->option = option;
        *s = hbil__sink_open(d->text, sizeof d->text);
    }
    ++diags->count;
    return d;
}

static void hbil__say(hbil_diags *diags, hbil_severity severity, int32_t option, const char *a, const char *b)
{
    hbil__sink s;
    hbil__report(diags, severity, option, &s);
    hbil__puts(&s, a);
    hbil__puts(&s, b);
    hbil__sink_close(&s, NULL);
}

/* "[1, 64]", "{vulkan, gl}" or "any of {ao, near}" */
static void hbil__put_range(hbil__sink *s, const hbil_option *o)
{
    const char *w;
    size_t n;
    int i;
    if (o->kind == HBIL_KIND_INT || o->kind == HBIL_KIND_FLOAT) {
        hbil__puts(s, "[");
        hbil__put_float(s, (float)o->min, 0);
        hbil__puts(s, ", ");
        hbil__put_float(s, (float)o->max, 0);
        hbil__puts(s, "]");
        return;
    }
    hbil__puts(s, o->kind == HBIL_KIND_SET ? "any of {" : "one of {");
    for (i = 0; hbil__word_at(o->choices, i, &w, &n); ++i) {
        if (i) hbil__puts(s, ", ");
        hbil__put(s, w, n);
    }
    hbil__puts(s, "}");
}

/* "slices=99: must be in [1, 64]" */
static void hbil__say_range(hbil_diags *diags, const char *where, int32_t option, const char *value, size_t len)
{
    const hbil_option *o = &hbil__options[option];
    hbil__sink s;
    hbil__report(diags, HBIL_ERROR, option, &s);
    hbil__puts(&s, where);
    hbil__puts(&s, o->name);
    hbil__puts(&s, "=");
    hbil__put(&s, value, len < 24 ? len : 24);
    hbil__puts(&s, o->kind == HBIL_KIND_INT || o->kind == HBIL_KIND_FLOAT ? ": must be in " : ": must be ");
    hbil__put_range(&s, o);
    hbil__sink_close(&s, NULL);
}

/* ======================================================================
 * >>config     values as bits, text in, text out, resolve, hash
 * ====================================================================== */

typedef union hbil__value { int32_t i; uint32_t u; float f; } hbil__value;

static hbil__value hbil__get(const hbil_config *c, int32_t option)
{
    hbil__value v;
    memcpy(&v, (const char *)c + hbil__options[option].offset, sizeof v);
    return v;
}

static void hbil__set(hbil_config *c, int32_t option, hbil__value v)
{
    memcpy((char *)c + hbil__options[option].offset, &v, sizeof v);
}

static hbil__value hbil__default(int32_t option)
{
    const hbil_option *o = &hbil__options[option];
    hbil__value v;
    if (o->kind == HBIL_KIND_FLOAT) v.f = (float)o->def;
    else if (o->kind == HBIL_KIND_SET) v.u = (uint32_t)o->def;
    else v.i = (int32_t)o->def;
    return v;
}

static int hbil__in_range(int32_t option, hbil__value v)
{
    const hbil_option *o = &hbil__options[option];
    if (v.u == hbil__default(option).u) return 1;
    if (o->kind == HBIL_KIND_FLOAT) return v.f >= (float)o->min && v.f <= (float)o->max;
    if (o->kind == HBIL_KIND_SET) return v.u != 0 && (v.u & ~(uint32_t)o->max) == 0;
    return v.i >= (int32_t)o->min && v.i <= (int32_t)o->max;
}

static void hbil__put_value(hbil__sink *s, int32_t option, hbil__value v)
{
    const hbil_option *o = &hbil__options[option];
    const char *w;
    size_t n;
    int i, some = 0;
    if (o->kind == HBIL_KIND_FLOAT) { hbil__put_any_float(s, v.f); return; }
    if (o->kind == HBIL_KIND_INT || (o->kind == HBIL_KIND_CHOICE && (v.i < 1 || !hbil__word_at(o->choices, v.i - 1, &w, &n)))) {
        hbil__put_int(s, v.i);
        return;
    }
    if (o->kind == HBIL_KIND_CHOICE) { hbil__put(s, w, n); return; }
    for (i = 0; i < 32 && hbil__word_at(o->choices, i, &w, &n); ++i) {
        if (!(v.u >> i & 1)) continue;
        if (some++) hbil__puts(s, "+");
        hbil__put(s, w, n);
    }
    if (!some) hbil__puts(s, "none");
}

static void hbil__put_config(hbil__sink *s, const hbil_config *c, int all, const char *separator)
{
    int32_t i, some = 0;
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) {
        hbil__value v = hbil__get(c, i), def = hbil__default(i);
        if (v.u == 0) v = def;
        if (!all && v.u == def.u) continue;
        if (some++) hbil__puts(s, separator);
        hbil__puts(s, hbil__options[i].name);
        hbil__puts(s, "=");
        hbil__put_value(s, i, v);
    }
}

/* Decimal number, '.' under any locale, optional sign and exponent. Digits beyond 18 only shift the point. */
static int hbil__read_number(const char *s, size_t len, double *out)
{
    size_t i = 0;
    int negative = 0, digits = 0, shift = 0, point = 0;
    uint64_t m = 0;
    if (i < len && (s[i] == '-' || s[i] == '+')) negative = s[i++] == '-';
    for (; i < len && ((s[i] >= '0' && s[i] <= '9') || (s[i] == '.' && !point)); ++i) {
        if (s[i] == '.') { point = 1; continue; }
        ++digits;
        if (m < 100000000000000000u) { m = m * 10 + (uint64_t)(s[i] - '0'); shift -= point; }
        else shift += !point;
    }
    if (!digits) return 0;
    if (i < len && (s[i] == 'e' || s[i] == 'E')) {
        int sign = 1, e = 0;
        if (++i < len && (s[i] == '-' || s[i] == '+')) sign = s[i++] == '-' ? -1 : 1;
        if (i == len) return 0;
        for (; i < len && s[i] >= '0' && s[i] <= '9'; ++i) if (e < 1000) e = e * 10 + (s[i] - '0');
        shift += sign * e;
    }
    if (i != len || shift > 22 || shift < -40) return 0;
    *out = (double)m;
    if (shift >= 0) *out *= hbil__power10(shift);
    else if (shift >= -22) *out /= hbil__power10(-shift);
    else *out = *out / hbil__power10(22) / hbil__power10(-shift - 22);
    if (negative) *out = -*out;
    return 1;
}

static int hbil__read_value(int32_t option, const char *s, size_t len, hbil__value *v)
{
    const hbil_option *o = &hbil__options[option];
    double number;
    int k;
    if (hbil__same("default", s, len)) { v->u = 0; return 1; }
    if (o->kind == HBIL_KIND_INT || o->kind == HBIL_KIND_FLOAT) {
        if (!hbil__read_number(s, len, &number)) return 0;
        if (o->kind == HBIL_KIND_FLOAT) {
            v->f = (float)number;
            if (!(number == 0) && v->f == 0) return 0; /* too small for a float: must not turn into the default */
        } else {
            if (!(number >= -2147483647.0 && number <= 2147483647.0) || number != (double)(int32_t)number) return 0;
            v->i = (int32_t)number;
        }
        return hbil__in_range(option, *v);
    }
    if (o->kind == HBIL_KIND_CHOICE) return (v->i = hbil__word_find(o->choices, s, len) + 1) > 0;
    if (hbil__same("none", s, len)) { v->u = 0; return o->def == 0; }
    for (v->u = 0;; s += k + 1, len -= (size_t)k + 1) {
        const char *plus = (const char *)memchr(s, '+', len);
        int bit = hbil__word_find(o->choices, s, plus ? (size_t)(plus - s) : len);
        if (bit < 0) return 0;
        v->u |= 1u << bit;
        if (!plus) return 1;
        k = (int)(plus - s);
    }
}

static hbil_result hbil__assign(hbil_config *c, const char *where, const char *name, size_t name_len, const char *value,
                                size_t value_len, hbil_diags *diags)
{
    int32_t nearest, option = hbil_option_find(name, name_len, &nearest);
    hbil__value v;
    if (option < 0) {
        hbil__sink s;
        hbil__report(diags, HBIL_ERROR, -1, &s);
        hbil__puts(&s, where);
        hbil__put(&s, name, name_len < 32 ? name_len : 32);
        hbil__puts(&s, ": no such option; did you mean ");
        hbil__puts(&s, hbil__options[nearest].name);
        hbil__puts(&s, "?");
        hbil__sink_close(&s, NULL);
        return HBIL_E_CONFIG;
    }
    if (!hbil__read_value(option, value, value_len, &v)) {
        hbil__say_range(diags, where, option, value, value_len);
        return HBIL_E_CONFIG;
    }
    hbil__set(c, option, v);
    return HBIL_OK;
}

/* Cursor of hbil_config_parse; line counts from 1. */
typedef struct hbil__reader { const char *s; size_t len, at; int32_t line; } hbil__reader;

static int hbil__is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

static void hbil__skip_blanks(hbil__reader *r)
{
    while (r->at < r->len && hbil__is_blank(r->s[r->at])) ++r->at;
}

static void hbil__skip_separators(hbil__reader *r)
{
    for (; r->at < r->len; ++r->at) {
        char c = r->s[r->at];
        if (c == '#') while (r->at + 1 < r->len && r->s[r->at + 1] != '\n') ++r->at;
        else if (c == '\n') ++r->line;
        else if (!hbil__is_blank(c) && c != ',') return;
    }
}

static size_t hbil__take_word(hbil__reader *r)
{
    size_t from = r->at;
    while (r->at < r->len && !hbil__is_blank(r->s[r->at]) && !strchr("=,#\n", r->s[r->at])) ++r->at;
    return r->at - from;
}

/* One name=value pair. */
static hbil_result hbil__parse_pair(hbil__reader *r, hbil_config *c, hbil_diags *diags)
{
    char where[24];
    const char *name = r->s + r->at, *value;
    size_t name_len, value_len;
    hbil__sink s = hbil__sink_open(where, sizeof where);
    if (memchr(r->s, '\n', r->len)) {
        hbil__puts(&s, "line ");
        hbil__put_int(&s, r->line);
        hbil__puts(&s, ": ");
    }
    hbil__sink_close(&s, NULL);
    name_len = hbil__take_word(r);
    hbil__skip_blanks(r);
    if (r->at == r->len || r->s[r->at] != '=') {
        if (!name_len && r->at < r->len) ++r->at; /* a zero byte: no loop without progress */
        hbil__say(diags, HBIL_ERROR, -1, where, "expected name=value");
        return HBIL_E_CONFIG;
    }
    ++r->at;
    hbil__skip_blanks(r);
    value = r->s + r->at;
    value_len = hbil__take_word(r);
    if (r->at < r->len && r->s[r->at] == '=') ++r->at; /* a=b=c: leave no loop without progress */
    return hbil__assign(c, where, name, name_len, value, value_len, diags);
}

/* ======================================================================
 * >>filter     #if over option symbols; lines taken; what they refer to
 * ====================================================================== */

static int hbil__expression(const hbil_config *c, const char **at, int level);

/* Is the lower-case `word` of n letters what s spells in capitals? */
static int hbil__spells(const char *s, const char *word, size_t n)
{
    size_t i;
    for (i = 0; i < n; ++i)
        if ((word[i] >= 'a' && word[i] <= 'z' ? word[i] - 'a' + 'A' : word[i]) != s[i]) return 0;
    return 1;
}

/* HBIL_<OPTION>_<CHOICE, member or whole number>: 1 when that is the baked value; HBIL_<SYMBOL>: its expression. embed has
 * checked that it exists. */
static int hbil__symbol(const hbil_config *c, const char *s, size_t len)
{
    int32_t i;
    for (i = 0; i < HBIL__COUNT(hbil__symbols); ++i)
        if (hbil__same(hbil__symbols[i].name, s + 5, len - 5)) {
            const char *at = hbil__symbols[i].expression;
            return hbil__expression(c, &at, 0);
        }
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) {
        const hbil_option *o = &hbil__options[i];
        hbil__value v;
        size_t n, head;
        const char *w;
        int j;
        if (!hbil__spells(s + 5, o->name, 1)) continue; /* most end here */
        v = hbil__get(c, i);
        head = strlen(o->name) + 6;
        if (len <= head || s[head - 1] != '_' || !hbil__spells(s + 5, o->name, head - 6)) continue;
        if (o->kind == HBIL_KIND_INT || o->kind == HBIL_KIND_FLOAT) {
            double number;
            if (!hbil__read_number(s + head, len - head, &number)) continue;
            return !(c->dynamic & o->dynamic) && (o->kind == HBIL_KIND_INT ? (double)v.i : (double)v.f) == number;
        }
        for (j = 0, w = o->choices; *w; ++j, w += n + (w[n] == ' ')) { /* hbil__word_at would begin anew for each */
            for (n = 0; w[n] && w[n] != ' '; ++n) { }
            if (n == len - head && hbil__spells(s + head, w, n)) return o->kind == HBIL_KIND_SET ? (int)(v.u >> j & 1) : v.i == j + 1;
        }
    }
    return 0;
}

/* Expression of symbols, 0, 1, !, &&, ||, ( ). At: cursor; level 0 is ||, 1 is &&, 2 is a term. */
static int hbil__expression(const hbil_config *c, const char **at, int level)
{
    int value, right;
    while (**at == ' ') ++*at;
    if (level == 2) {
        size_t n = 0;
        if (**at == '!') { ++*at; return !hbil__expression(c, at, 2); }
        if (**at == '(') {
            ++*at;
            value = hbil__expression(c, at, 0);
            while (**at == ' ' || **at == ')') if (*(*at)++ == ')') break;
            return value;
        }
        while (((*at)[n] >= '0' && (*at)[n] <= '9') || ((*at)[n] >= 'A' && (*at)[n] <= 'Z') || (*at)[n] == '_') ++n;
        value = n == 1 ? **at == '1' : hbil__symbol(c, *at, n);
        *at += n;
        return value;
    }
    value = hbil__expression(c, at, level + 1);
    for (;;) {
        const char *s = *at;
        while (*s == ' ') ++s;
        if (memcmp(s, level == 0 ? "||" : "&&", 1) || s[0] != s[1]) return value;
        *at = s + 2;
        right = hbil__expression(c, at, level + 1);
        value = level == 0 ? value | right : value & right;
    }
}

static int hbil__holds(const hbil_config *c, const char *expression)
{
    return !*expression || hbil__expression(c, &expression, 0);
}

/* Walks the lines of a chunk that its #if lines let through. Bit d of taken/done: the branch at depth d is on / has been. */
typedef struct hbil__lines { const hbil_config *config; const char *at; uint32_t taken, done; int depth; } hbil__lines;

static hbil__lines hbil__lines_of(const hbil_config *c, const char *text)
{
    hbil__lines l;
    l.config = c;
    l.at = text;
    l.taken = l.done = 1;
    l.depth = 0;
    return l;
}

static void hbil__directive(hbil__lines *l, const char *s)
{
    uint32_t bit, parent;
    if (memcmp(s, "#if", 3) == 0) ++l->depth;
    bit = 1u << l->depth;
    parent = l->taken >> (l->depth - 1) & 1;
    if (memcmp(s, "#endif", 6) == 0) { --l->depth; return; }
    if (memcmp(s, "#if", 3) == 0) l->done &= ~bit;
    l->taken &= ~bit;
    if (parent && !(l->done & bit) &&
        (memcmp(s, "#else", 5) == 0 || hbil__holds(l->config, s + (s[1] == 'e' ? 5 : 3)))) {
        l->taken |= bit;
        l->done |= bit;
    }
}

/* Next line that is taken, without its line end; 0 at the end of the chunk. */
static int hbil__next_line(hbil__lines *l, const char **line, size_t *len)
{
    while (*l->at) {
        *line = l->at;
        for (*len = 0; l->at[*len] != '\n'; ++*len) { }
        l->at += *len + 1;
        if (**line == '#') hbil__directive(l, *line);
        else if (l->taken >> l->depth & 1) return 1;
    }
    return 0;
}

/* What the filtered text of a pass refers to: bits by table index. */
typedef struct hbil__used { uint32_t chunks[8], textures[2], last[2], uniforms, options[2], hook, from, to; } hbil__used;

static void hbil__mark(uint32_t *bits, int32_t i) { bits[i >> 5] |= 1u << (i & 31); }
static int  hbil__marked(const uint32_t *bits, int32_t i) { return (int)(bits[i >> 5] >> (i & 31) & 1); }

static void hbil__scan_chunk(const hbil_config *c, int32_t pass, int32_t chunk, hbil__used *used);

/* A chunk belongs to its own pass, or to all if its file is not a pass. */
static int hbil__may_use(int32_t pass, int32_t chunk)
{
    int32_t i;
    for (i = 0; i < HBIL__COUNT(hbil__passes); ++i)
        if (strcmp(hbil__chunks[chunk].file, hbil__passes[i].name) == 0) return i == pass;
    return 1;
}

static void hbil__scan_word(const hbil_config *c, int32_t pass, const char *s, size_t len, hbil__used *used)
{
    int32_t i;
    char name[40];
    hbil__sink k;
    if (s[0] == 'u') {
        int last = len > 7 && memcmp(s, "u_last_", 7) == 0;
        size_t head = last ? 7 : 2;
        if (hbil__same("u_from", s, len)) used->from = 1;
        if (hbil__same("u_to", s, len)) used->to = 1;
        for (i = 0; i < HBIL__COUNT(hbil__textures); ++i)
            if (hbil__same(hbil__textures[i].name, s + head, len - head)) hbil__mark(last ? used->last : used->textures, i);
        return;
    }
    for (i = 0; i < HBIL__COUNT(hbil__chunks); ++i)
        if (hbil__same(hbil__chunks[i].name, s, len) && hbil__may_use(pass, i)) {
            hbil__scan_chunk(c, pass, i, used);
            return;
        }
    if (hbil__same("hbil_far_hook", s, len)) { used->hook = 1; return; }
    for (i = 0; i < HBIL__COUNT(hbil__uniforms); ++i)
        if (hbil__same(hbil__uniforms[i].name, s, len)) { hbil__mark(&used->uniforms, i); return; }
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) {
        k = hbil__sink_open(name, sizeof name);
        hbil__put_upper(&k, hbil__options[i].name);
        if (k.size == len - 5 && memcmp(name, s + 5, len - 5) == 0) { hbil__mark(used->options, i); return; }
    }
}

static int hbil__is_word(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

static void hbil__scan_chunk(const hbil_config *c, int32_t pass, int32_t chunk, hbil__used *used)
{
    hbil__lines l = hbil__lines_of(c, hbil__chunks[chunk].text);
    const char *s;
    size_t len, i, n;
    if (hbil__marked(used->chunks, chunk)) return;
    hbil__mark(used->chunks, chunk);
    while (hbil__next_line(&l, &s, &len))
        for (i = 0; i < len; i += n) {
            if (s[i] == '/' && s[i + 1] == '/') break;
            if (!hbil__is_word(s[i])) { n = 1; continue; }
            for (n = 1; hbil__is_word(s[i + n]); ++n) { }
            if ((n > 2 && s[i] == 'u' && s[i + 1] == '_') ||
                (n > 5 && (memcmp(s + i, "hbil_", 5) == 0 || memcmp(s + i, "HBIL_", 5) == 0)))
                hbil__scan_word(c, pass, s + i, n, used);
        }
}

static void hbil__scan_pass(const hbil_config *c, int32_t pass, hbil__used *used)
{
    int32_t i;
    memset(used, 0, sizeof *used);
    for (i = 0; i < HBIL__COUNT(hbil__chunks); ++i)
        if (strcmp(hbil__chunks[i].name, "main") == 0 && strcmp(hbil__chunks[i].file, hbil__passes[pass].name) == 0)
            hbil__scan_chunk(c, pass, i, used);
}

/* ======================================================================
 * >>plan       config -> textures, passes, barriers, uniform block
 * ====================================================================== */

/* Sizes are literals when the config bakes them. */
static int hbil__size_baked(const hbil_config *c, int32_t uniform)
{
    return c->width && (strcmp(hbil__uniforms[uniform].name, "HBIL_SIZE") == 0 ||
                        strcmp(hbil__uniforms[uniform].name, "HBIL_FULL_SIZE") == 0);
}

/* Layers of a signal: see signal.glsl. */
static uint16_t hbil__signal_layers(const hbil_config *c)
{
    return (uint16_t)(hbil__holds(c, "HBIL_LIGHT_LAYER") + hbil__holds(c, "HBIL_BENT_LAYER") + hbil__holds(c, "HBIL_FAR_LAYER") +
                      4 * hbil__holds(c, "HBIL_OUTPUTS_SH"));
}

static int32_t hbil__plan_add_texture(hbil_plan *p, const hbil_config *c, int32_t texture)
{
    hbil_texture *t;
    int32_t i = hbil_plan_texture(p, hbil__textures[texture].name);
    if (i >= 0) return i;
    t = &p->textures[p->texture_count];
    memcpy(t->name, hbil__textures[texture].name, strlen(hbil__textures[texture].name));
    t->format = hbil__textures[texture].format;
    if (t->format == HBIL_FORMAT_SIGNAL && hbil__holds(c, "HBIL_ONLY_AO")) t->format = HBIL_FORMAT_R32F;
    if (t->format == HBIL_FORMAT_SIGNAL) t->format = c->storage == HBIL_STORAGE_HALF ? HBIL_FORMAT_RGBA16F : HBIL_FORMAT_RGBA32F;
    t->life = hbil__textures[texture].life;
    if (!hbil__holds(c, hbil__textures[texture].wanted)) t->life = HBIL_LIFE_TRANSIENT;
    t->div = hbil__textures[texture].grid;
    if (t->div == HBIL__DRAWN) t->div = c->stage == HBIL_STAGE_COMPUTE;
    t->div = t->div ? (uint16_t)(c->downscale * t->div) : 1;
    t->mips = 1;
    t->copies = t->life == HBIL_LIFE_HISTORY ? 2 : 1;
    t->dim = hbil__textures[texture].dim;
    if (t->dim == HBIL_DIM_2D_MULTISAMPLE && c->multisample != HBIL_MULTISAMPLE_YES) t->dim = HBIL_DIM_2D;
    t->layers = hbil__textures[texture].layers;
    if (t->layers == HBIL__LAYERS_SIDES) t->layers = (uint16_t)(2 * c->slices);
    if (t->layers == HBIL__LAYERS_SIGNAL) t->layers = hbil__signal_layers(c);
    return (int32_t)p->texture_count++;
}

/* Does the text of a pass name what a row of its bindings binds? */
static int hbil__names(const hbil__used *used, int32_t bind)
{
    switch (hbil__binds[bind].role) {
    case HBIL_ROLE_LAST: return hbil__marked(used->last, hbil__binds[bind].texture);
    case HBIL_ROLE_FROM: return (int)used->from;
    case HBIL_ROLE_TO:   return (int)used->to;
    default:             return hbil__marked(used->textures, hbil__binds[bind].texture);
    }
}

/* Units or render targets that a binding takes: a layer is a target of its own. */
static int32_t hbil__slots_of(const hbil_config *c, const hbil_texture *t, int32_t access)
{
    return c->stage == HBIL_STAGE_FRAGMENT && access == HBIL_ACCESS_WRITE ? t->layers : 1;
}

/* Render targets of one pass that every device has. */
static int32_t hbil__targets_most(const hbil_config *c) { return c->target == HBIL_TARGET_GLES ? 4 : 8; }

/* Are there targets for all that each pass draws? What is too much depends on most options, so it is counted. */
static int hbil__targets_fit(const hbil_plan *p, hbil_diags *diags)
{
    uint32_t i, b;
    if (p->config.stage != HBIL_STAGE_FRAGMENT) return 1;
    for (i = 0; i < p->pass_count; ++i) {
        int32_t count = 0;
        hbil__sink s;
        for (b = 0; b < p->passes[i].binding_count; ++b)
            if (p->passes[i].bindings[b].access == HBIL_ACCESS_WRITE) count += p->textures[p->passes[i].bindings[b].texture].layers;
        if (count <= hbil__targets_most(&p->config)) continue;
        hbil__report(diags, HBIL_ERROR, hbil_option_find("outputs", 7, NULL), &s);
        hbil__puts(&s, "outputs: pass ");
        hbil__puts(&s, p->passes[i].name);
        hbil__puts(&s, " draws into ");
        hbil__put_int(&s, count);
        hbil__puts(&s, " layers, stage=fragment has ");
        hbil__put_int(&s, hbil__targets_most(&p->config));
        hbil__puts(&s, " targets: ask for fewer; set outputs=ao");
        hbil__sink_close(&s, NULL);
        return 0;
    }
    return 1;
}

static void hbil__plan_add_pass(hbil_plan *p, const hbil_config *c, int32_t pass, const hbil__used *used)
{
    hbil_pass *out = &p->passes[p->pass_count++];
    uint16_t slots[3] = { 0, 0, 0 }; /* by access */
    int32_t i;
    memcpy(out->name, hbil__passes[pass].name, strlen(hbil__passes[pass].name));
    out->group[0] = c->stage == HBIL_STAGE_FRAGMENT ? 1 : hbil__passes[pass].group[0];
    out->group[1] = c->stage == HBIL_STAGE_FRAGMENT ? 1 : hbil__passes[pass].group[1];
    out->grid = hbil__passes[pass].grid;
    out->hook = (uint16_t)used->hook;
    for (i = 0; i < HBIL__COUNT(hbil__binds); ++i) {
        hbil_binding *b = &out->bindings[out->binding_count];
        if (hbil__binds[i].pass != pass || !hbil__names(used, i) || !hbil__holds(c, hbil__binds[i].when)) continue;
        b->texture = (uint16_t)hbil__plan_add_texture(p, c, hbil__binds[i].texture);
        b->role = (uint8_t)hbil__binds[i].role;
        b->access = hbil__roles[b->role].access;
        b->age = hbil__roles[b->role].age;
        /* GL has a name space of its own for textures, images and uniform blocks; Vulkan has one, block first */
        b->slot = c->target != HBIL_TARGET_VULKAN ? slots[b->access] : (uint16_t)(out->binding_count + 1);
        slots[b->access] = (uint16_t)(slots[b->access] + hbil__slots_of(c, &p->textures[b->texture], b->access));
        ++out->binding_count;
    }
    out->domain = (uint16_t)hbil__plan_add_texture(p, c, hbil__passes[pass].domain);
}

static void hbil__plan_add_constant(hbil_plan *p, const char *name, uint16_t type, int32_t option)
{
    hbil_constant *k = &p->constants[p->constant_count++];
    uint32_t align = hbil__types[type].align;
    hbil__sink s = hbil__sink_open(k->name, sizeof k->name);
    if (option >= 0) hbil__puts(&s, "HBIL_");
    hbil__put_upper(&s, name);
    hbil__sink_close(&s, NULL);
    k->offset = (uint16_t)((p->constants_size + align - 1) / align * align);
    k->type = type;
    k->option = option;
    p->constants_size = k->offset + (uint32_t)hbil__types[type].size;
}

static int hbil__is_dynamic(const hbil_config *c, int32_t option)
{
    return (c->dynamic & hbil__options[option].dynamic) != 0;
}

/* Does this pass read the uniform block? */
static int hbil__reads_block(const hbil_config *c, const hbil__used *used)
{
    int32_t i;
    for (i = 0; i < HBIL__COUNT(hbil__uniforms); ++i)
        if (hbil__marked(&used->uniforms, i) && !hbil__size_baked(c, i)) return 1;
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i)
        if (hbil__marked(used->options, i) && hbil__is_dynamic(c, i)) return 1;
    return 0;
}

/* Most copies of a history, and frames until every copy has been met in every role. */
enum { HBIL__COPIES_MAX = 2, HBIL__ROUNDS = 2 * HBIL__COPIES_MAX };

/* One round of all passes over the state of each copy of each texture: bit 0 written and not yet visible to samplers, bit 1
 * sampled since, bit 2 written at all. */
static void hbil__plan_barriers(hbil_plan *p, uint8_t state[HBIL_MAX_TEXTURES][HBIL__COPIES_MAX], uint32_t frame, int record)
{
    uint32_t i, b;
    for (i = 0; i < p->pass_count; ++i) {
        hbil_pass *pass = &p->passes[i];
        for (b = 0; b < pass->binding_count; ++b) {
            const hbil_binding *bind = &pass->bindings[b];
            uint32_t copies = p->textures[bind->texture].copies;
            uint8_t *s = &state[bind->texture][(frame + copies - bind->age) % copies], before = 0;
            if (bind->access == HBIL_ACCESS_SAMPLE) {
                if (*s & 1) before = HBIL_ACCESS_WRITE;
                *s = (uint8_t)((*s & ~1) | 2);
            } else {
                if (*s & 2) before = HBIL_ACCESS_SAMPLE;
                else if (*s & 4) before = HBIL_ACCESS_WRITE;
                *s = 1 | 4;
            }
            if (before && record) {
                hbil_barrier *out = &pass->barriers[pass->barrier_count++];
                out->texture = bind->texture;
                out->before = before;
                out->after = bind->access;
            }
        }
    }
}

static void hbil__plan_all_barriers(hbil_plan *p)
{
    uint8_t state[HBIL_MAX_TEXTURES][HBIL__COPIES_MAX];
    uint32_t t, frame;
    memset(state, 0, sizeof state);
    for (frame = 0; frame < HBIL__ROUNDS; ++frame) /* the frames before, whose transients and histories this one meets again */
        hbil__plan_barriers(p, state, frame, 0);
    for (t = 0; t < p->texture_count; ++t)
        if (p->textures[t].life <= HBIL_LIFE_OUTPUT) memset(state[t], 0, sizeof state[t]); /* yours between frames */
    hbil__plan_barriers(p, state, HBIL__ROUNDS, 1);
}

/* ======================================================================
 * >>emit       GLSL of one pass
 * ====================================================================== */

/* Dialects by target and stage. */
static const char *const hbil__version_lines[2][3] = {
    { "#version 450\n", "#version 430 core\n", "#version 310 es\n" },
    { "", "#version 330 core\n", "#version 300 es\n" } };

static int hbil__draws(const hbil_plan *p) { return p->config.stage == HBIL_STAGE_FRAGMENT; }

static void hbil__put_version(hbil__sink *s, const hbil_plan *p)
{
    hbil__puts(s, hbil__version_lines[hbil__draws(p)][p->config.target - 1]);
}

/* "layout(...binding = 3" or, of a render target, "layout(location = 3". */
static void hbil__put_slot(hbil__sink *s, const hbil_plan *p, uint32_t slot)
{
    hbil__puts(s, hbil__draws(p) ? "layout(location = " : p->config.target == HBIL_TARGET_VULKAN ? "layout(set = 0, binding = "
                                                                                              : "layout(binding = ");
    hbil__put_int(s, slot);
}

static int32_t hbil__texture_row(const char *name)
{
    int32_t i;
    for (i = 0; i < HBIL__COUNT(hbil__textures); ++i)
        if (strcmp(hbil__textures[i].name, name) == 0) return i;
    return 0;
}

static void hbil__put_binding_name(hbil__sink *s, const hbil_plan *p, const hbil_binding *bind)
{
    hbil__puts(s, hbil__roles[bind->role].name);
    if (hbil__roles[bind->role].named) hbil__puts(s, p->textures[bind->texture].name);
}

static void hbil__put_bindings_comment(hbil__sink *s, const hbil_plan *p, const hbil_pass *pass, hbil_access access)
{
    uint32_t b, some = 0;
    for (b = 0; b < pass->binding_count; ++b) {
        const hbil_texture *t = &p->textures[pass->bindings[b].texture];
        if (pass->bindings[b].access != access) continue;
        hbil__puts(s, some++ ? ", " : access == HBIL_ACCESS_SAMPLE ? "// reads    : " : hbil__draws(p) ? "// targets  : " : "// writes   : ");
        hbil__put_int(s, pass->bindings[b].slot);
        hbil__puts(s, " ");
        hbil__put_binding_name(s, p, &pass->bindings[b]);
        hbil__puts(s, " (");
        hbil__puts(s, hbil_format_name((hbil_format)t->format));
        hbil__puts(s, ")");
    }
    if (some) hbil__puts(s, "\n");
}

static void hbil__put_group(hbil__sink *s, const hbil_pass *pass, const char *a, const char *b, const char *c)
{
    hbil__puts(s, a);
    hbil__put_int(s, pass->group[0]);
    hbil__puts(s, b);
    hbil__put_int(s, pass->group[1]);
    hbil__puts(s, c);
}

/* What a dialect needs before the first declaration. */
static void hbil__emit_dialect(hbil__sink *s, const hbil_plan *p, const hbil_pass *pass)
{
    uint32_t b, updates = 0, stores = 0;
    for (b = 0; b < pass->binding_count; ++b) {
        const hbil_binding *bind = &pass->bindings[b];
        updates |= bind->role == HBIL_ROLE_UPDATE;
        stores |= bind->access == HBIL_ACCESS_WRITE && p->textures[bind->texture].dim == HBIL_DIM_2D;
    }
    if (p->config.target == HBIL_TARGET_GLES) {
        if (updates) hbil__puts(s, "#extension GL_OES_shader_image_atomic : enable\n");
        hbil__puts(s, "precision highp float;\nprecision highp int;\n\n");
    }
    if (hbil__draws(p) && stores) hbil__puts(s, "#define imageStore(target, pixel, value) target = value // a fragment is its own pixel\n\n");
}

static void hbil__emit_header(hbil__sink *s, const hbil_plan *p, int32_t index, int32_t row)
{
    const hbil_pass *pass = &p->passes[index];
    hbil__sink none = hbil__sink_open(NULL, 0);
    hbil__put_version(s, p);
    hbil__puts(s, "// hbil ");
    hbil__put_int(s, HBIL_VERSION_MAJOR);
    hbil__puts(s, ".");
    hbil__put_int(s, HBIL_VERSION_MINOR);
    hbil__puts(s, ".");
    hbil__put_int(s, HBIL_VERSION_PATCH);
    hbil__puts(s, " | pass ");
    hbil__put_int(s, index + 1);
    hbil__puts(s, "/");
    hbil__put_int(s, p->pass_count);
    hbil__puts(s, " \"");
    hbil__puts(s, pass->name);
    hbil__puts(s, "\" | GENERATED: change the config, not this text\n// ");
    hbil__puts(s, hbil__passes[row].meaning);
    hbil__puts(s, "\n// rebuild  : shadergen ");
    hbil__put_config(&none, &p->config, 0, ",");
    if (none.size) {
        hbil__puts(s, "--set ");
        hbil__put_config(s, &p->config, 0, ",");
        hbil__puts(s, " ");
    }
    hbil__puts(s, "--pass ");
    hbil__puts(s, pass->name);
    hbil__puts(s, pass->hook ? " --hook FILE\n" : "\n");
    hbil__put_bindings_comment(s, p, pass, HBIL_ACCESS_SAMPLE);
    hbil__put_bindings_comment(s, p, pass, HBIL_ACCESS_WRITE);
    if (pass->constants) {
        hbil__puts(s, "// uniforms : ");
        hbil__put_int(s, p->constants_slot);
        hbil__puts(s, " HbilFrame (std140, ");
        hbil__put_int(s, p->constants_size);
        hbil__puts(s, " bytes)\n");
    }
    hbil__puts(s, hbil__draws(p) ? "// draw     : 3 vertices of hbil_emit_vertex, viewport of the size of u_"
                  : pass->grid == HBIL_GRID_LINES ? "// dispatch : longer side x layers of u_" : "// dispatch : size of u_");
    hbil__puts(s, p->textures[pass->domain].name);
    if (hbil__draws(p)) hbil__puts(s, "\n\n");
    else hbil__put_group(s, pass, " / ", " x ", ", rounded up\n\n");
    hbil__emit_dialect(s, p, pass);
    if (!hbil__draws(p)) hbil__put_group(s, pass, "layout(local_size_x = ", ", local_size_y = ", ", local_size_z = 1) in;\n\n");
}

/* "layout(binding = 1) uniform sampler2D u_a", "layout(binding = 0, r32f) uniform writeonly image2D u_b" or "layout(location = 0)
 * out vec4 u_c". */
static void hbil__emit_binding(hbil__sink *s, const hbil_plan *p, const hbil_binding *bind)
{
    const hbil_texture *t = &p->textures[bind->texture];
    int write = bind->access == HBIL_ACCESS_WRITE, draw = write && hbil__draws(p);
    if (write || !hbil__draws(p)) {
        hbil__put_slot(s, p, bind->slot);
        if (write && !draw) {
            hbil__puts(s, ", ");
            hbil__puts(s, hbil_format_name((hbil_format)t->format));
        }
        hbil__puts(s, ") ");
    }
    hbil__puts(s, draw ? "out " : write && bind->role != HBIL_ROLE_UPDATE ? "uniform writeonly " : "uniform ");
    if (p->config.target == HBIL_TARGET_GLES) hbil__puts(s, "highp ");
    if (t->format == HBIL_FORMAT_R32UI) hbil__puts(s, "u");
    hbil__puts(s, draw ? "vec4" : write ? "image" : "sampler");
    if (!draw) hbil__puts(s, hbil__dims[t->dim]);
    hbil__puts(s, " ");
    hbil__put_binding_name(s, p, bind);
    if (draw && t->dim == HBIL_DIM_2D_ARRAY) {
        hbil__puts(s, "[");
        hbil__put_int(s, t->layers);
        hbil__puts(s, "]");
    }
}

static void hbil__emit_bindings(hbil__sink *s, const hbil_plan *p, const hbil_pass *pass)
{
    uint32_t b;
    for (b = 0; b < pass->binding_count; ++b) {
        const hbil_binding *bind = &pass->bindings[b];
        hbil__emit_binding(s, p, bind);
        hbil__puts(s, "; // ");
        hbil__puts(s, bind->age ? "last frame's copy: " : "");
        hbil__puts(s, hbil__textures[hbil__texture_row(p->textures[bind->texture].name)].meaning);
        hbil__puts(s, "\n");
    }
    hbil__puts(s, "\n");
}

static void hbil__put_meaning(hbil__sink *s, int32_t option)
{
    hbil__puts(s, " // ");
    hbil__puts(s, hbil__options[option].meaning);
    if (strcmp(hbil__options[option].unit, "1")) {
        hbil__puts(s, ". ");
        hbil__puts(s, hbil__options[option].unit);
    }
    hbil__puts(s, "\n");
}

/* -1: there is none */
static int32_t hbil__uniform_row(const char *name)
{
    int32_t i = HBIL__COUNT(hbil__uniforms);
    while (i-- > 0 && strcmp(hbil__uniforms[i].name, name)) { }
    return i;
}

static void hbil__emit_block(hbil__sink *s, const hbil_plan *p)
{
    uint32_t i;
    if (hbil__draws(p)) hbil__puts(s, "layout(");
    else hbil__put_slot(s, p, p->constants_slot);
    hbil__puts(s, hbil__draws(p) ? "std140) uniform HbilFrame {\n" : ", std140) uniform HbilFrame {\n");
    for (i = 0; i < p->constant_count; ++i) {
        const hbil_constant *k = &p->constants[i];
        hbil__puts(s, "    ");
        hbil__puts(s, hbil__types[k->type].glsl);
        hbil__puts(s, " ");
        hbil__puts(s, k->name);
        hbil__puts(s, hbil__array_ends[k->type]);
        hbil__puts(s, ";");
        if (k->option >= 0) {
            hbil__put_meaning(s, k->option);
            continue;
        }
        hbil__puts(s, " // ");
        hbil__puts(s, hbil__uniforms[hbil__uniform_row(k->name)].meaning);
        hbil__puts(s, "\n");
    }
    hbil__puts(s, "};\n\n");
}

static void hbil__emit_constants(hbil__sink *s, const hbil_config *c, const hbil__used *used)
{
    int32_t i, some = 0;
    for (i = 0; i < HBIL__COUNT(hbil__uniforms); ++i) {
        int32_t div = strcmp(hbil__uniforms[i].name, "HBIL_SIZE") ? 1 : c->downscale;
        if (!hbil__marked(&used->uniforms, i) || !hbil__size_baked(c, i)) continue;
        hbil__puts(s, "const ivec2 ");
        hbil__puts(s, hbil__uniforms[i].name);
        hbil__puts(s, " = ivec2(");
        hbil__put_int(s, (c->width + div - 1) / div);
        hbil__puts(s, ", ");
        hbil__put_int(s, (c->height + div - 1) / div);
        hbil__puts(s, "); // ");
        hbil__puts(s, hbil__uniforms[i].meaning);
        hbil__puts(s, "\n");
        ++some;
    }
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) {
        int is_int = hbil__options[i].kind == HBIL_KIND_INT;
        if (!hbil__marked(used->options, i) || hbil__is_dynamic(c, i)) continue;
        hbil__puts(s, is_int ? "const int HBIL_" : "const float HBIL_");
        hbil__put_upper(s, hbil__options[i].name);
        hbil__puts(s, " = ");
        if (is_int) hbil__put_int(s, hbil__get(c, i).i);
        else hbil__put_float(s, hbil__get(c, i).f, 1);
        hbil__puts(s, ";");
        hbil__put_meaning(s, i);
        ++some;
    }
    if (some) hbil__puts(s, "\n");
}

static void hbil__emit_chunks(hbil__sink *s, const hbil_config *c, const hbil__used *used)
{
    const char *file = "", *line;
    int32_t i;
    size_t len;
    for (i = 0; i < HBIL__COUNT(hbil__chunks); ++i) {
        hbil__lines l = hbil__lines_of(c, hbil__chunks[i].text);
        if (!hbil__marked(used->chunks, i)) continue;
        if (strcmp(file, hbil__chunks[i].file)) {
            file = hbil__chunks[i].file;
            hbil__puts(s, "// ---- ");
            hbil__puts(s, file);
            hbil__puts(s, ".glsl\n\n");
        }
        while (hbil__next_line(&l, &line, &len)) {
            hbil__put(s, line, len);
            hbil__puts(s, "\n");
        }
        if (i + 1 < HBIL__COUNT(hbil__chunks)) hbil__puts(s, "\n");
    }
}

/* Next token of GLSL text behind comments and blanks: a word, a directive's whole line or one character. 0 at the end. */
static size_t hbil__token(const char **at)
{
    const char *s = *at;
    size_t n;
    for (;;) {
        while (*s == ' ' || *s == '\t' || *s == '\r' || *s == '\n') ++s;
        if (s[0] == '/' && s[1] == '/') {
            while (*s && *s != '\n') ++s;
        } else if (s[0] == '/' && s[1] == '*') {
            const char *open = s;
            for (s += 2; *s && !(s[0] == '*' && s[1] == '/'); ++s) { }
            if (*s) s += 2;
            else { *at = open; return 2; } /* never closed: the opening itself */
        } else break;
    }
    *at = s;
    if (!*s) return 0;
    if (*s == '#') {
        for (n = 1; s[n] && s[n] != '\n'; ++n)
            if (s[n] == '\\' && s[n + 1]) n += s[n + 1] == '\r' && s[n + 2] ? 2 : 1; /* the line goes on */
        return n;
    }
    for (n = 0; hbil__is_word(s[n]); ++n) { }
    return n ? n : 1;
}

/* Skip qualifiers that may stand before a type, then take one token. */
static size_t hbil__type_token(const char **at)
{
    size_t n;
    while ((n = hbil__token(at)) > 0 && hbil__word_find("const in highp mediump lowp precise", *at, n) >= 0) *at += n;
    return n;
}

/* From the word vec3 on: vec3 hbil_far_hook(vec3 a, vec3 b, float c) { ? Names of parameters are free and may lack. */
static int hbil__hook_head(const char *s)
{
    static const char *const form[] = { "vec3", "hbil_far_hook", "(", "vec3", "", ",", "vec3", "", ",", "float", "", ")", "{" };
    int32_t i;
    for (i = 0; i < HBIL__COUNT(form); ++i) {
        size_t n = hbil__type_token(&s);
        if (!*form[i] && n > 0 && !hbil__is_word(*s)) continue; /* a parameter without a name */
        if (n == 0 || (*form[i] && !hbil__same(form[i], s, n))) return 0;
        s += n;
    }
    return 1;
}

/* Word of a directive "# word ...". */
static int hbil__is_directive(const char *s, const char *word)
{
    size_t n = strlen(word);
    if (*s++ != '#') return 0;
    while (*s == ' ' || *s == '\t') ++s;
    return strncmp(s, word, n) == 0 && !hbil__is_word(s[n]);
}

/* What is wrong with a hook, "" if nothing. What preprocessor branches leave of it is the compiler's to say. */
static const char *hbil__hook_fault(const char *hook)
{
    const char *s = hook;
    size_t n;
    int found = 0, depth = 0, branches = 0, ever = 0;
    for (; (n = hbil__token(&s)) > 0; s += n) {
        if (s[0] == '/' && s[1] == '*') return "a comment is not closed";
        if (hbil__is_directive(s, "version")) return "#version; leave it out, the text is pasted into a shader";
        if (hbil__is_directive(s, "if") || hbil__is_directive(s, "ifdef") || hbil__is_directive(s, "ifndef")) ++branches, ever = 1;
        if (hbil__is_directive(s, "endif")) --branches;
        if (*s == '{') ++depth;
        if (*s == '}' && --depth < 0 && !ever) return "braces do not match";
        if (depth > 0) continue;
        if (n == 4 && memcmp(s, "main", 4) == 0) return "a function main; leave it out, the text is pasted into a shader";
        if (n == 4 && memcmp(s, "vec3", 4) == 0) found += hbil__hook_head(s);
    }
    if (branches) return "#if and #endif do not match";
    if (depth && !ever) return "braces do not match";
    if (!found) return "no function vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {...}";
    return found > 1 && !ever ? "hbil_far_hook is defined twice" : "";
}

static int hbil__hook_fits(const char *hook, hbil_diags *diags)
{
    const char *fault;
    if (!hook) {
        hbil__say(diags, HBIL_ERROR, hbil_option_find("environment", 11, NULL), "environment=hook: no text given", "; see hbil_emit_glsl_hook");
        return 0;
    }
    fault = hbil__hook_fault(hook);
    if (*fault) hbil__say(diags, HBIL_ERROR, -1, "hook: ", fault);
    return !*fault;
}

/* The engine's text, numbered as source 1, so that errors of the compiler point at its own lines; then ours as before. */
static void hbil__emit_hook(hbil__sink *s, const char *hook)
{
    size_t n = strlen(hook);
    hbil__puts(s, "// ---- hook\n\n#line 1 1\n");
    hbil__put(s, hook, n);
    hbil__puts(s, n && hook[n - 1] == '\n' ? "#line " : "\n#line ");
    hbil__put_int(s, (int64_t)s->lines + 2); /* of the line below */
    hbil__puts(s, " 0\n\n");
}

/* -1: a pass of yours, which has no text here */
static int32_t hbil__pass_row(const char *name)
{
    int32_t i = HBIL__COUNT(hbil__passes);
    while (i-- > 0 && strcmp(hbil__passes[i].name, name)) { }
    return i;
}

/* ======================================================================
 * >>manifest   the plan as JSON
 * ====================================================================== */

static void hbil__json_key(hbil__sink *s, const char *key, int first)
{
    hbil__puts(s, first ? "\"" : ", \"");
    hbil__puts(s, key);
    hbil__puts(s, "\": ");
}

static void hbil__json_int(hbil__sink *s, const char *key, int64_t v, int first)
{
    hbil__json_key(s, key, first);
    hbil__put_int(s, v);
}

static void hbil__json_text(hbil__sink *s, const char *key, const char *v, int first)
{
    hbil__json_key(s, key, first);
    hbil__puts(s, "\"");
    hbil__puts(s, v); /* names, formats and config text hold nothing that JSON would escape */
    hbil__puts(s, "\"");
}

static void hbil__json_config(hbil__sink *s, const hbil_config *c)
{
    int32_t i;
    hbil__puts(s, "  \"config\": {");
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) {
        int number = hbil__options[i].kind == HBIL_KIND_INT || hbil__options[i].kind == HBIL_KIND_FLOAT;
        hbil__json_key(s, hbil__options[i].name, i == 0);
        if (!number) hbil__puts(s, "\"");
        hbil__put_value(s, i, hbil__get(c, i));
        if (!number) hbil__puts(s, "\"");
    }
    hbil__puts(s, "},\n");
}

static void hbil__json_block(hbil__sink *s, const hbil_plan *p)
{
    uint32_t i;
    hbil__puts(s, "  \"uniform_block\": {");
    hbil__json_int(s, "slot", p->constants_slot, 1);
    hbil__json_int(s, "bytes", p->constants_size, 0);
    hbil__puts(s, ", \"members\": [");
    for (i = 0; i < p->constant_count; ++i) {
        const hbil_constant *k = &p->constants[i];
        hbil__puts(s, i ? ",\n    {" : "\n    {");
        hbil__json_text(s, "name", k->name, 1);
        hbil__json_text(s, "type", hbil__types[k->type].glsl, 0);
        hbil__json_int(s, "offset", k->offset, 0);
        hbil__puts(s, "}");
    }
    hbil__puts(s, "]},\n");
}

static void hbil__json_textures(hbil__sink *s, const hbil_plan *p)
{
    uint32_t i;
    hbil__puts(s, "  \"textures\": [");
    for (i = 0; i < p->texture_count; ++i) {
        const hbil_texture *t = &p->textures[i];
        hbil__puts(s, i ? ",\n    {" : "\n    {");
        hbil__json_text(s, "name", t->name, 1);
        hbil__json_text(s, "life", hbil__life_names[t->life], 0);
        hbil__json_text(s, "format", hbil_format_name((hbil_format)t->format), 0);
        hbil__json_int(s, "div", t->div, 0);
        hbil__json_int(s, "mips", t->mips, 0);
        hbil__json_int(s, "copies", t->copies, 0);
        hbil__json_text(s, "dim", hbil__dim_names[t->dim], 0);
        hbil__json_int(s, "layers", t->layers, 0);
        hbil__json_text(s, "meaning", hbil__textures[hbil__texture_row(t->name)].meaning, 0);
        hbil__puts(s, "}");
    }
    hbil__puts(s, "],\n");
}

static void hbil__json_pass(hbil__sink *s, const hbil_plan *p, const hbil_pass *pass)
{
    uint32_t b;
    hbil__json_text(s, "name", pass->name, 1);
    hbil__put_group(s, pass, ", \"group\": [", ", ", "]");
    hbil__json_text(s, "grid", pass->grid == HBIL_GRID_LINES ? "lines" : "pixels", 0);
    hbil__json_text(s, "domain", p->textures[pass->domain].name, 0);
    hbil__json_int(s, "uniform_block", pass->constants, 0);
    hbil__puts(s, ",\n     \"bindings\": [");
    for (b = 0; b < pass->binding_count; ++b) {
        const hbil_binding *bind = &pass->bindings[b];
        hbil__puts(s, b ? ", {" : "{");
        hbil__json_int(s, "slot", bind->slot, 1);
        hbil__json_text(s, "texture", p->textures[bind->texture].name, 0);
        hbil__json_text(s, "access", hbil__access_names[bind->access], 0);
        hbil__json_int(s, "age", bind->age, 0);
        hbil__json_int(s, "mip", bind->mip, 0);
        hbil__json_text(s, "role", hbil__role_names[bind->role], 0);
        if (p->config.target == HBIL_TARGET_VULKAN) { /* what HLSL and MSL are made from */
            hbil__puts(s, bind->access == HBIL_ACCESS_SAMPLE ? ", \"hlsl\": \"t" : ", \"hlsl\": \"u");
            hbil__put_int(s, hbil_plan_register(p, (int32_t)(pass - p->passes), (int32_t)b));
            hbil__puts(s, "\", \"msl\": \"texture(");
            hbil__put_int(s, b);
            hbil__puts(s, ")\"");
        }
        hbil__puts(s, "}");
    }
    hbil__puts(s, "],\n     \"barriers\": [");
    for (b = 0; b < pass->barrier_count; ++b) {
        hbil__puts(s, b ? ", {" : "{");
        hbil__json_text(s, "texture", p->textures[pass->barriers[b].texture].name, 1);
        hbil__json_text(s, "before", hbil__access_names[pass->barriers[b].before], 0);
        hbil__json_text(s, "after", hbil__access_names[pass->barriers[b].after], 0);
        hbil__puts(s, "}");
    }
    hbil__puts(s, "]");
}

/* ======================================================================
 * >>frame      camera matrices -> uniform block
 * ====================================================================== */

/* What the uniforms need to know of a camera, in double precision. Depth d is 1 at the near and 0 at the far end. */
typedef struct hbil__camera {
    double pixel_to_ray[4];  /* HBIL_PIXEL_TO_RAY */
    double depth_to_view[2]; /* HBIL_DEPTH_TO_VIEW */
    double view_z;           /* HBIL_VIEW_Z */
    double last_to_ray[4];   /* HBIL_LAST_TO_RAY; this and below: only if the plan looks back */
    double last_from_view[12], view_from_last[12];
} hbil__camera;

static int hbil__frame_fault(hbil_diags *diags, const char *text, const char *fix)
{
    hbil__say(diags, HBIL_ERROR, -1, text, fix);
    return 0;
}

static int hbil__all_finite(const float *m, int n)
{
    int i;
    for (i = 0; i < n; ++i)
        if (!(m[i] - m[i] == 0.0f)) return 0;
    return 1;
}

/* Half the screen and its middle, at depth 1 or in m: so far off that squares in the shaders stay finite. */
static int hbil__rays_fit(const double ray[4], double least, double most)
{
    int i;
    for (i = 0; i < 4; ++i) {
        double size = ray[i] < 0 ? -ray[i] : ray[i];
        if (size > most || (i < 2 && size < least)) return 0;
    }
    return 1;
}

/* Rows 0 and 1 of a projection: view x alone makes clip x, view y alone clip y, z may shift both. To `ray`: view xy at depth 1 or
 * at any depth = ndc * xy + zw. 1, or 0: not such a matrix, *why and *fix say more. */
static int hbil__read_rays(const float *m, int perspective, double ray[4], double *view_z, const char **why, const char **fix)
{
    double w = perspective ? (m[11] < 0 ? -(double)m[11] : (double)m[11]) : (double)m[15];
    double z = perspective ? (m[11] < 0 ? -1.0 : 1.0) : 0.0;
    *why = "projection: holds NaN or infinity";
    *fix = "; fill all 16 numbers";
    if (!hbil__all_finite(m, 16)) return 0;
    *why = perspective ? "projection: not a perspective matrix" : "projection: not an orthographic matrix";
    *fix = perspective ? "; is it column-major? else set projection=orthographic" : "; is it column-major? else set projection=perspective";
    if (perspective ? m[3] != 0 || m[7] != 0 || m[11] == 0 || m[15] != 0 : m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] == 0) return 0;
    *why = "projection: view x must map to clip x and y to clip y";
    *fix = "; rotated screens: rotate the view instead";
    if (m[0] == 0 || m[5] == 0 || m[1] != 0 || m[4] != 0) return 0;
    *why = "projection: oblique orthographic cameras are not supported";
    *fix = "; remove the shear";
    if (!perspective && (m[8] != 0 || m[9] != 0)) return 0;
    *view_z = z; /* orthographic: found from the depth row */
    ray[0] = w / (double)m[0];
    ray[1] = w / (double)m[5];
    ray[2] = (perspective ? -z * (double)m[8] : -(double)m[12]) / (double)m[0];
    ray[3] = (perspective ? -z * (double)m[9] : -(double)m[13]) / (double)m[5];
    *why = perspective ? "projection: sees less than 1e-4 or more than 179.98 degrees" : "projection: sees less than 1e-6 or more than 1e9 m";
    *fix = perspective ? "; check m[0], m[5], m[8], m[9]" : "; check m[0], m[5], m[12], m[13]";
    return hbil__rays_fit(ray, 1e-6, perspective ? 1e4 : 1e9);
}

/* From ndc to pixels of the grid: ndc = 2 pixel / size - 1. */
static void hbil__rays_of_pixels(double ray[4], uint32_t w, uint32_t h, int32_t downscale)
{
    ray[2] -= ray[0];
    ray[3] -= ray[1];
    ray[0] *= 2.0 * downscale / w;
    ray[1] *= 2.0 * downscale / h;
}

/* Row 2: v(d) as d * x + y. ndc z at d = 0 and 1 follow from direction and clip. */
static int hbil__read_depth(const hbil_config *c, const float *m, hbil_diags *diags, hbil__camera *out)
{
    int perspective = c->projection == HBIL_PROJECTION_PERSPECTIVE, reversed = c->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED;
    double low = c->clip == HBIL_CLIP_GL ? -1.0 : 0.0, far_ndc = reversed ? low : 1.0, near_ndc = reversed ? 1.0 : low;
    double far_v, near_v;
    if (perspective && c->depth != HBIL_DEPTH_DEVICE) return 1;
    if (perspective) { /* ndc = (a z + b / depth) / w, a z from the matrix: 1/depth = (ndc w - a z) / b */
        double w = (double)m[11] * out->view_z, a = (double)m[10] * out->view_z, b = (double)m[14];
        if (b == 0) return hbil__frame_fault(diags, "projection: its z row gives no depth", "; set depth=linear or fill the row");
        far_v = (far_ndc * w - a) / b;
        near_v = (near_ndc * w - a) / b;
    } else {
        if (m[10] == 0) return hbil__frame_fault(diags, "projection: its z row gives no depth", "; fill the row");
        far_v = (far_ndc * (double)m[15] - (double)m[14]) / (double)m[10];
        near_v = (near_ndc * (double)m[15] - (double)m[14]) / (double)m[10];
        out->view_z = far_v < near_v ? -1.0 : 1.0; /* depth grows towards the far end */
        far_v *= out->view_z;
        near_v *= out->view_z;
    }
    if (perspective && !(near_v > far_v))
        return hbil__frame_fault(diags, "projection: its near end is behind its far end", reversed
                                 ? "; the matrix is not reversed: set depth_direction=forward" : "; a reversed matrix needs depth_direction=reversed");
    if (perspective && far_v < -1e-5 * near_v)
        return hbil__frame_fault(diags, "projection: its far end is behind the eye", "; check the options clip and depth_direction");
    if (perspective && c->depth_far == HBIL_DEPTH_FAR_INFINITE && far_v > 1e-5 * near_v)
        return hbil__frame_fault(diags, "projection: its far plane is finite", "; set depth_far=finite");
    if (!(near_v <= (perspective ? 1e9 : 1e15) && near_v >= -1e15 && far_v <= 1e15 && far_v >= -1e15))
        return hbil__frame_fault(diags, perspective ? "projection: its near end is below 1e-9 m" : "projection: its ends are beyond 1e15 m",
                                 "; fill the z row");
    out->depth_to_view[0] = near_v - far_v;
    out->depth_to_view[1] = far_v > 0 || !perspective ? far_v : 0.0;
    return 1;
}

/* A rigid world to view matrix, of an eye within 1e15 m? */
static int hbil__is_rigid(const float *m)
{
    int i, j, k;
    for (i = 0; i < 3; ++i)
        for (j = i; j < 3; ++j) {
            double dot = 0;
            for (k = 0; k < 3; ++k) dot += (double)m[k * 4 + i] * (double)m[k * 4 + j];
            if (i == j) dot -= 1;
            if (!(dot <= 1e-3 && dot >= -1e-3)) return 0;
        }
    for (i = 12; i < 15; ++i)
        if (!(m[i] <= 1e15f && m[i] >= -1e15f)) return 0; /* beyond any surface */
    return 1;
}

/* Rows of the motion from the space of view a to that of view b, z into the screen in both: b(world(x)). */
static void hbil__relate(const float *a, const float *b, double view_z, double out[12])
{
    int i, j, k;
    for (i = 0; i < 3; ++i) {
        out[4 * i + 3] = (double)b[12 + i];
        for (j = 0; j < 3; ++j) {
            double r = 0;
            for (k = 0; k < 3; ++k) r += (double)b[4 * k + i] * (double)a[4 * k + j];
            out[4 * i + 3] -= r * (double)a[12 + j];
            out[4 * i + j] = r * (i == 2 ? view_z : 1.0) * (j == 2 ? view_z : 1.0);
        }
        if (i == 2) out[4 * i + 3] *= view_z;
    }
}

/* The camera of the last frame, and the way from one to the other. After a reset: this frame's. */
static int hbil__read_last(const hbil_config *c, const hbil_frame *f, uint32_t w, uint32_t h, hbil_diags *diags, hbil__camera *out)
{
    const float *projection = f->reset ? f->projection : f->last_projection, *view = f->reset ? f->view : f->last_view;
    uint32_t lw = f->last_width && !f->reset ? f->last_width : w, lh = f->last_height && !f->reset ? f->last_height : h;
    const char *why, *fix;
    double view_z;
    if (lw > 16384 || lh > 16384) return hbil__frame_fault(diags, "frame: last_width and last_height must be in [0, 16384]", "");
    if (!hbil__read_rays(projection, c->projection == HBIL_PROJECTION_PERSPECTIVE, out->last_to_ray, &view_z, &why, &fix))
        return hbil__frame_fault(diags, "last_projection: not a matrix as projection is", "; fill it, or set reset=1 in the first frame");
    if (!hbil__all_finite(f->view, 16) || !hbil__is_rigid(f->view))
        return hbil__frame_fault(diags, "view: not a rotation and translation of at most 1e15 m", "; remove scale and shear; is it column-major?");
    if (!hbil__all_finite(view, 16) || !hbil__is_rigid(view))
        return hbil__frame_fault(diags, "last_view: not a rotation and translation of at most 1e15 m", "; fill it, or set reset=1 in the first frame");
    hbil__rays_of_pixels(out->last_to_ray, lw, lh, c->downscale);
    hbil__relate(f->view, view, out->view_z, out->last_from_view);
    hbil__relate(view, f->view, out->view_z, out->view_from_last);
    return 1;
}

static int hbil__read_camera(const hbil_plan *p, const hbil_frame *f, hbil_diags *diags, hbil__camera *out)
{
    const hbil_config *c = &p->config;
    uint32_t i, w = f->width ? f->width : (uint32_t)c->width, h = f->height ? f->height : (uint32_t)c->height;
    const char *why, *fix;
    memset(out, 0, sizeof *out);
    if (f->guard) return hbil__frame_fault(diags, "frame: guard is not 0", "; zero the struct before filling it");
    if (w < 1 || w > 16384 || h < 1 || h > 16384) return hbil__frame_fault(diags, "frame: width and height must be in [1, 16384]", "");
    if (c->width && (w != (uint32_t)c->width || h != (uint32_t)c->height))
        return hbil__frame_fault(diags, "frame: size differs from the baked one", "; set width and height to default");
    if (!hbil__read_rays(f->projection, c->projection == HBIL_PROJECTION_PERSPECTIVE, out->pixel_to_ray, &out->view_z, &why, &fix))
        return hbil__frame_fault(diags, why, fix);
    if (!hbil__read_depth(c, f->projection, diags, out)) return 0;
    hbil__rays_of_pixels(out->pixel_to_ray, w, h, c->downscale);
    for (i = 0; i < p->constant_count; ++i)
        if (strcmp(p->constants[i].name, "HBIL_RESET") == 0) return hbil__read_last(c, f, w, h, diags, out);
    return 1;
}

/* Columns of the rotation from world to view, third row turned into the screen. */
static int hbil__pack_rotation(const hbil_frame *f, double view_z, float out[12], hbil_diags *diags)
{
    int i;
    if (!hbil__all_finite(f->view, 16)) return hbil__frame_fault(diags, "view: holds NaN or infinity", "; fill all 16 numbers");
    if (!hbil__is_rigid(f->view))
        return hbil__frame_fault(diags, "view: not a rotation and translation of at most 1e15 m", "; remove scale and shear; is it column-major?");
    for (i = 0; i < 3; ++i) {
        out[i * 4 + 0] = f->view[i * 4 + 0];
        out[i * 4 + 1] = f->view[i * 4 + 1];
        out[i * 4 + 2] = f->view[i * 4 + 2] * (float)view_z;
        out[i * 4 + 3] = 0;
    }
    return 1;
}

/* Where the eye is in the world: the inverse of a rigid view applied to the origin. */
static void hbil__pack_eye(const hbil_frame *f, float out[3])
{
    int i, k;
    for (i = 0; i < 3; ++i) {
        double sum = 0;
        for (k = 0; k < 3; ++k) sum -= (double)f->view[i * 4 + k] * (double)f->view[12 + k];
        out[i] = (float)sum;
    }
}

/* The uniforms of far light. */
static int hbil__pack_environment(const hbil_frame *f, const char *name, float *out, hbil_diags *diags)
{
    int i, k;
    if (strcmp(name, "HBIL_FAR_COLOR") == 0) {
        if (!hbil__all_finite(f->far_color, 3)) return hbil__frame_fault(diags, "far_color: holds NaN or infinity", "; fill all 3 numbers");
        memcpy(out, f->far_color, sizeof f->far_color);
    } else if (strcmp(name, "HBIL_FAR_SH1") == 0 || strcmp(name, "HBIL_FAR_SH2") == 0) {
        int first = name[11] == '1' ? 0 : 4, count = name[11] == '1' ? 4 : 5;
        if (!hbil__all_finite(f->far_sh[first], 3 * count))
            return hbil__frame_fault(diags, "far_sh: holds NaN or infinity", "; fill 4 rows (sh_order=1) or 9");
        for (i = 0; i < count; ++i)
            for (k = 0; k < 3; ++k) out[i * 4 + k] = f->far_sh[first + i][k];
    } else if (strcmp(name, "HBIL_PROBE_ORIGIN") == 0) {
        if (!hbil__all_finite(f->probe_origin, 3)) return hbil__frame_fault(diags, "probe_origin: holds NaN or infinity", "; fill all 3 numbers");
        memcpy(out, f->probe_origin, sizeof f->probe_origin);
    } else { /* HBIL_PROBE_SCALE */
        for (i = 0; i < 3; ++i) {
            if (!(f->probe_step[i] > 1e-6f && f->probe_step[i] < 1e9f))
                return hbil__frame_fault(diags, "probe_step: must be in [1e-6, 1e9] m along each axis", "");
            out[i] = 1.0f / f->probe_step[i];
        }
    }
    return 1;
}

static int hbil__pack_option(const hbil_plan *p, const hbil_frame *f, int32_t option, hbil__value *out, hbil_diags *diags)
{
    char text[32];
    hbil__sink s = hbil__sink_open(text, sizeof text);
    *out = hbil__get(&p->config, option);
    if (!f->live) return 1;
    if (hbil__get(f->live, option).u) *out = hbil__get(f->live, option);
    if (hbil__in_range(option, *out)) return 1;
    if (hbil__options[option].kind == HBIL_KIND_INT) hbil__put_int(&s, out->i);
    else hbil__put_any_float(&s, out->f);
    hbil__sink_close(&s, NULL);
    hbil__say_range(diags, "live.", option, text, s.size);
    return 0;
}

static int hbil__pack_one(const hbil_plan *p, const hbil_frame *f, const hbil__camera *cam, const hbil_constant *k,
                          unsigned char *out, hbil_diags *diags)
{
    union { float f[20]; int32_t i[2]; uint32_t u; } v; /* as large as the largest type */
    int i, j;
    memset(&v, 0, sizeof v);
    if (k->option >= 0) {
        hbil__value o;
        if (!hbil__pack_option(p, f, k->option, &o, diags)) return 0;
        v.u = o.u;
    } else if (strcmp(k->name, "HBIL_PIXEL_TO_RAY") == 0) {
        for (i = 0; i < 4; ++i) v.f[i] = (float)cam->pixel_to_ray[i];
    } else if (strcmp(k->name, "HBIL_DEPTH_TO_VIEW") == 0) {
        for (j = 0; j < 2; ++j) v.f[j] = (float)cam->depth_to_view[j];
    } else if (strcmp(k->name, "HBIL_FULL_SIZE") == 0) {
        v.i[0] = (int32_t)f->width;
        v.i[1] = (int32_t)f->height;
    } else if (strcmp(k->name, "HBIL_SIZE") == 0 || strcmp(k->name, "HBIL_LAST_SIZE") == 0 || strcmp(k->name, "HBIL_LAST_FULL_SIZE") == 0) {
        int last = k->name[5] == 'L' && !f->reset, div = strcmp(k->name, "HBIL_LAST_FULL_SIZE") ? p->config.downscale : 1;
        uint32_t w = f->width ? f->width : (uint32_t)p->config.width, h = f->height ? f->height : (uint32_t)p->config.height;
        v.i[0] = ((int32_t)(last && f->last_width ? f->last_width : w) + div - 1) / div;
        v.i[1] = ((int32_t)(last && f->last_height ? f->last_height : h) + div - 1) / div;
    } else if (strcmp(k->name, "HBIL_LAST_TO_RAY") == 0) {
        for (i = 0; i < 4; ++i) v.f[i] = (float)cam->last_to_ray[i];
    } else if (strcmp(k->name, "HBIL_LAST_FROM_VIEW") == 0 || strcmp(k->name, "HBIL_VIEW_FROM_LAST") == 0) {
        for (i = 0; i < 12; ++i) v.f[i] = (float)(k->name[5] == 'L' ? cam->last_from_view[i] : cam->view_from_last[i]);
    } else if (strcmp(k->name, "HBIL_RESET") == 0) {
        v.u = f->reset != 0;
    } else if (strcmp(k->name, "HBIL_WORLD_TO_VIEW") == 0) {
        if (!hbil__pack_rotation(f, cam->view_z, v.f, diags)) return 0;
    } else if (strcmp(k->name, "HBIL_VIEW_Z") == 0) {
        v.f[0] = (float)cam->view_z;
    } else if (strcmp(k->name, "HBIL_FRAME_INDEX") == 0) {
        v.u = f->index;
    } else if (strcmp(k->name, "HBIL_EYE") == 0) {
        hbil__pack_eye(f, v.f);
    } else if (!hbil__pack_environment(f, k->name, v.f, diags)) {
        return 0;
    }
    if (k->type != HBIL_TYPE_INT && k->type != HBIL_TYPE_UINT && k->type != HBIL_TYPE_IVEC2 && !hbil__all_finite(v.f, hbil__types[k->type].size / 4))
        return hbil__frame_fault(diags, "frame: numbers beyond what a float holds make ", k->name);
    memcpy(out + k->offset, &v, hbil__types[k->type].size);
    return 1;
}

/* ======================================================================
 * >>check      plans that others have had in their hands
 * ====================================================================== */

/* Terminated, and fit for comments and JSON? */
static int hbil__is_name(const char *s, size_t cap)
{
    size_t n = 0;
    while (n < cap && s[n] >= ' ' && s[n] <= '~' && s[n] != '"' && s[n] != '\\') ++n;
    return n > 0 && n < cap && s[n] == 0;
}

/* "plan: texture ao: format is no hbil_format; ..." name: of so many bytes, or NULL. */
static int hbil__plan_fault(hbil_diags *diags, const char *table, uint32_t index, const char *name, size_t cap, const char *what)
{
    hbil__sink s;
    hbil__report(diags, HBIL_ERROR, -1, &s);
    hbil__puts(&s, "plan: ");
    hbil__puts(&s, table);
    if (*table) hbil__puts(&s, " ");
    if (name && hbil__is_name(name, cap)) hbil__puts(&s, name);
    else if (*table) hbil__put_int(&s, index);
    if (*table) hbil__puts(&s, ": ");
    hbil__puts(&s, what);
    hbil__puts(&s, "; build it anew by hbil_plan_build");
    hbil__sink_close(&s, NULL);
    return 0;
}

/* Resolved values: what text and arithmetic take for granted. */
static int hbil__check_config(const hbil_config *c, hbil_diags *diags)
{
    int32_t i;
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i)
        if (!hbil__in_range(i, hbil__get(c, i))) return hbil__plan_fault(diags, "option", (uint32_t)i, hbil__options[i].name, 32, "out of its range");
    return 1;
}

static int hbil__check_texture(const hbil_texture *t, uint32_t index, hbil_diags *diags)
{
    const char *fault = "";
    if (!hbil__is_name(t->name, sizeof t->name)) fault = "no name";
    else if (t->format < HBIL_FORMAT_ANY || t->format >= HBIL_FORMAT_COUNT) fault = "format is no hbil_format";
    else if (t->life < HBIL_LIFE_INPUT || t->life > HBIL_LIFE_HISTORY) fault = "life is no hbil_life";
    else if (t->format == HBIL_FORMAT_ANY && t->life != HBIL_LIFE_INPUT) fault = "any format, but no input";
    else if (t->dim < HBIL_DIM_2D || t->dim > HBIL_DIM_3D) fault = "dim is no hbil_dim";
    else if (!t->div || !t->copies) fault = "div and copies must be at least 1";
    else if (t->mips < 1 || t->mips > 15) fault = "mips must be in [1, 15]";
    return !*fault || hbil__plan_fault(diags, "texture", index, t->name, sizeof t->name, fault);
}

static int hbil__check_pass(const hbil_plan *p, uint32_t index, hbil_diags *diags)
{
    const hbil_pass *pass = &p->passes[index];
    const char *fault = "";
    uint32_t b, k;
    if (!hbil__is_name(pass->name, sizeof pass->name)) fault = "no name";
    else if (!pass->group[0] || !pass->group[1]) fault = "group must be at least 1 x 1";
    else if (pass->domain >= p->texture_count) fault = "domain is no texture";
    else if (pass->grid > HBIL_GRID_LINES) fault = "grid is no hbil_grid";
    else if (pass->grid == HBIL_GRID_LINES && !p->textures[pass->domain].layers) fault = "grid of lines over no layers";
    else if (pass->constants > 1 || pass->hook > 1) fault = "constants and hook must be 0 or 1";
    else if (pass->constants && !p->constants_size) fault = "it reads a uniform block of 0 bytes";
    else if (pass->binding_count > HBIL_MAX_BINDINGS || pass->barrier_count > HBIL_MAX_BINDINGS) fault = "more bindings or barriers than fit";
    for (b = 0; !*fault && b < pass->binding_count; ++b) {
        const hbil_binding *x = &pass->bindings[b];
        if (x->texture >= p->texture_count) fault = "a binding has no texture";
        else if (x->access < HBIL_ACCESS_SAMPLE || x->access > HBIL_ACCESS_WRITE) fault = "access of a binding is no hbil_access";
        else if (x->role < HBIL_ROLE_SAMPLE || x->role >= HBIL_ROLE_COUNT) fault = "role of a binding is no hbil_role";
        else if (x->age >= p->textures[x->texture].copies) fault = "age of a binding is not below copies";
        else if (x->mip >= p->textures[x->texture].mips) fault = "mip of a binding is not below mips";
        else if (p->config.target == HBIL_TARGET_VULKAN && pass->constants && x->slot == p->constants_slot) fault = "a binding has the slot of the uniform block";
        for (k = 0; k < b && !*fault; ++k)
            if (x->slot == pass->bindings[k].slot && (p->config.target == HBIL_TARGET_VULKAN || x->access == pass->bindings[k].access))
                fault = "two bindings have one slot";
    }
    for (b = 0; !*fault && b < pass->barrier_count; ++b) {
        const hbil_barrier *x = &pass->barriers[b];
        if (x->texture >= p->texture_count) fault = "a barrier has no texture";
        else if (x->before < 1 || x->before > 3 || x->after < 1 || x->after > 3) /* both at once may be asked for */
            fault = "before or after of a barrier is no hbil_access";
    }
    return !*fault || hbil__plan_fault(diags, "pass", index, pass->name, sizeof pass->name, fault);
}

/* The uniform block: inside its bytes, each member of the type that its name has. */
static int hbil__check_block(const hbil_plan *p, hbil_diags *diags)
{
    uint32_t i;
    if (p->constants_size > HBIL_CONSTANTS_MAX || p->constants_size % 16 || p->constant_count > HBIL_MAX_CONSTANTS)
        return hbil__plan_fault(diags, "", 0, NULL, 0, "constants_size or constant_count is no size of a block");
    for (i = 0; i < p->constant_count; ++i) {
        const hbil_constant *k = &p->constants[i];
        const char *fault = "";
        int32_t row = -1;
        if (!hbil__is_name(k->name, sizeof k->name)) fault = "no name";
        else if (k->option < -1 || k->option >= HBIL__COUNT(hbil__options)) fault = "there is no such option";
        else if (k->option < 0 && ((row = hbil__uniform_row(k->name)) < 0 || k->type != hbil__uniforms[row].type)) fault = "name and type fit no uniform";
        else if (k->option >= 0 && (!hbil__options[k->option].dynamic || (k->type != HBIL_TYPE_INT && k->type != HBIL_TYPE_FLOAT)))
            fault = "option and type fit no uniform";
        else if (k->offset % hbil__types[k->type].align || (uint32_t)k->offset + hbil__types[k->type].size > p->constants_size)
            fault = "outside of the block";
        if (*fault) return hbil__plan_fault(diags, "constant", i, k->name, sizeof k->name, fault);
    }
    return 1;
}

/* ======================================================================
 * >>public     thin, over the private ones
 * ====================================================================== */

#define HBIL__RESULT_TEXT(name, text) text,

uint32_t hbil_version(void) { return HBIL_VERSION; }

const char *hbil_result_name(hbil_result result)
{
    static const char *const names[] = { HBIL_RESULTS(HBIL__RESULT_TEXT) };
    return (uint32_t)result < HBIL_RESULT_COUNT ? names[result] : "unknown";
}

const char *hbil_format_name(hbil_format format)
{
    if ((uint32_t)format < 1 || (uint32_t)format >= HBIL_FORMAT_COUNT) return "unknown";
    return format == HBIL_FORMAT_ANY ? "any" : hbil__formats[format - 1].layout;
}

uint32_t hbil_format_bytes(hbil_format format)
{
    return (uint32_t)format < 1 || (uint32_t)format >= HBIL_FORMAT_COUNT ? 0 : hbil__formats[format - 1].bytes;
}

int32_t hbil_option_count(void) { return HBIL__COUNT(hbil__options); }

const hbil_option *hbil_option_at(int32_t index)
{
    return index >= 0 && index < HBIL__COUNT(hbil__options) ? &hbil__options[index] : NULL;
}

int32_t hbil_option_find(const char *name, size_t len, int32_t *nearest)
{
    int32_t i, best = 0, best_distance = 100;
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) {
        int d = hbil__distance(hbil__options[i].name, name, len);
        if (d < best_distance) best = i, best_distance = d;
    }
    if (nearest) *nearest = best;
    return best_distance == 0 ? best : -1;
}

const char *hbil_preset_name(int32_t index)
{
    return index >= 0 && index < HBIL__COUNT(hbil__presets) ? hbil__presets[index].name : NULL;
}

const char *hbil_preset_meaning(int32_t index)
{
    return index >= 0 && index < HBIL__COUNT(hbil__presets) ? hbil__presets[index].meaning : NULL;
}

const char *hbil_preset_sources(int32_t index)
{
    return index >= 0 && index < HBIL__COUNT(hbil__presets) ? hbil__presets[index].sources : NULL;
}

hbil_result hbil_config_preset(const char *name, hbil_config *out, hbil_diags *diags)
{
    int32_t i, best = 0, best_distance = 100;
    hbil__sink s;
    if (!name || !out) return HBIL_E_ARG;
    for (i = 0; i < HBIL__COUNT(hbil__presets); ++i) {
        int d = hbil__distance(hbil__presets[i].name, name, strlen(name));
        if (d < best_distance) best = i, best_distance = d;
    }
    if (best_distance == 0) {
        memset(out, 0, sizeof *out);
        return hbil_config_parse(out, hbil__presets[best].config, strlen(hbil__presets[best].config), diags);
    }
    hbil__report(diags, HBIL_ERROR, -1, &s);
    hbil__put(&s, name, strlen(name) < 32 ? strlen(name) : 32);
    hbil__puts(&s, ": no such preset; did you mean ");
    hbil__puts(&s, hbil__presets[best].name);
    hbil__puts(&s, "?");
    hbil__sink_close(&s, NULL);
    return HBIL_E_CONFIG;
}

hbil_result hbil_config_set(hbil_config *config, const char *name, const char *value, hbil_diags *diags)
{
    if (!config || !name || !value) return HBIL_E_ARG;
    return hbil__assign(config, "", name, strlen(name), value, strlen(value), diags);
}

hbil_result hbil_config_parse(hbil_config *config, const char *text, size_t len, hbil_diags *diags)
{
    hbil__reader r;
    hbil_result result = HBIL_OK;
    if (!config || (!text && len)) return HBIL_E_ARG;
    r.s = text;
    r.len = len;
    r.at = 0;
    r.line = 1;
    for (hbil__skip_separators(&r); r.at < r.len; hbil__skip_separators(&r)) {
        hbil_result one = hbil__parse_pair(&r, config, diags);
        if (one != HBIL_OK) result = one;
    }
    return result;
}

/* Faults of single values; zeros become defaults. */
static hbil_result hbil__resolve_values(hbil_config *c, hbil_diags *diags)
{
    hbil_result result = HBIL_OK;
    int32_t i;
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) {
        hbil__value v = hbil__get(c, i);
        char text[40];
        hbil__sink s = hbil__sink_open(text, sizeof text);
        if (v.u == 0 || (hbil__options[i].kind == HBIL_KIND_FLOAT && v.f == 0)) v = hbil__default(i);
        hbil__set(c, i, v);
        if (hbil__in_range(i, v)) continue;
        if (hbil__options[i].kind == HBIL_KIND_SET) { hbil__puts(&s, "0x"); hbil__put_hex(&s, v.u); }
        else if (hbil__options[i].kind != HBIL_KIND_FLOAT) hbil__put_int(&s, v.i);
        else hbil__put_any_float(&s, v.f);
        hbil__say_range(diags, "", i, text, s.size);
        result = HBIL_E_CONFIG;
    }
    return result;
}

/* Where 0 stands for another shader it is no value to vary from. */
static int hbil__check_dynamic(const hbil_config *c, hbil_diags *diags)
{
    int32_t i;
    int ok = 1;
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) {
        const hbil_option *o = &hbil__options[i];
        hbil__sink s;
        if (!(c->dynamic & o->dynamic) || o->def != 0 || hbil__get(c, i).u) continue;
        hbil__report(diags, HBIL_ERROR, hbil_option_find("dynamic", 7, NULL), &s);
        hbil__puts(&s, "dynamic=");
        hbil__puts(&s, o->name);
        hbil__puts(&s, ": 0 stands for a shader without it, which no uniform can change; set ");
        hbil__puts(&s, o->name);
        hbil__puts(&s, " to its first value");
        hbil__sink_close(&s, NULL);
        ok = 0;
    }
    return ok;
}

/* Combinations without a meaning: refused, never replaced by something else in silence. */
static int hbil__check_combination(const hbil_config *c, hbil_diags *diags)
{
    int32_t i;
    int ok = 1;
    for (i = 0; i < HBIL__COUNT(hbil__refused); ++i) {
        hbil__sink s;
        if (!hbil__holds(c, hbil__refused[i].expression)) continue;
        hbil__report(diags, HBIL_ERROR, hbil_option_find(hbil__refused[i].fix, strcspn(hbil__refused[i].fix, "="), NULL), &s);
        hbil__puts(&s, hbil__refused[i].why);
        hbil__puts(&s, "; set ");
        hbil__puts(&s, hbil__refused[i].fix);
        hbil__sink_close(&s, NULL);
        ok = 0;
    }
    return ok;
}

hbil_result hbil_config_resolve(const hbil_config *in, hbil_config *out, hbil_diags *diags)
{
    hbil_config c;
    hbil_result result;
    unsigned char idle[HBIL__COUNT(hbil__options)] = { 0 };
    int32_t i;
    if (!in || !out) return HBIL_E_ARG;
    c = *in;
    if (c.guard || c.guard_end) {
        hbil__say(diags, HBIL_ERROR, -1, "config: guard is not 0", "; zero the struct before filling it");
        return HBIL_E_CONFIG;
    }
    result = hbil__resolve_values(&c, diags);
    if (result != HBIL_OK) return result;
    if (!c.width != !c.height) {
        hbil__say(diags, HBIL_ERROR, hbil_option_find("width", 5, NULL), "width and height are baked together", "; set both or neither");
        result = HBIL_E_CONFIG;
    }
    if (c.slices * c.steps > 32000) /* two sides; gallivm counts the iterations of all loops of an invocation */
        hbil__say(diags, HBIL_WARNING, hbil_option_find("steps", 5, NULL), "slices * steps is above 32000",
                  ": Mesa's software rasterisers stop a shader after 65535 iterations");
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) {
        const hbil_option *o = &hbil__options[i];
        if (hbil__holds(&c, o->applies)) continue;
        idle[i] = hbil__get(&c, i).u != hbil__default(i).u || (c.dynamic & o->dynamic);
        hbil__set(&c, i, hbil__default(i));
        c.dynamic &= ~o->dynamic;
    }
    for (i = 0; i < HBIL__COUNT(hbil__members); ++i) {
        hbil__value v = hbil__get(&c, hbil__members[i].option);
        if (!(v.u & hbil__members[i].bit) || hbil__holds(&c, hbil__members[i].applies)) continue;
        v.u &= ~hbil__members[i].bit;
        hbil__set(&c, hbil__members[i].option, v);
        idle[hbil__members[i].option] = 2;
    }
    if (c.slices == 1 && (hbil__symbol(&c, "HBIL_BENT", 9) || hbil__symbol(&c, "HBIL_FAR_BITS", 13)))
        hbil__say(diags, HBIL_WARNING, hbil_option_find("slices", 6, NULL), "slices=1: one slice leans a bent vector by up to 60 degrees",
                  "; filter it, or take 2 from which on an open surface is exact");
    if (c.noise == HBIL_NOISE_IGN) /* make bounds */
        hbil__say(diags, HBIL_NOTE, hbil_option_find("noise", 5, NULL), "noise=ign: rounding moves it, so ao differs by up to 3e-3 between devices",
                  ", by .1 at 16384 pixels; hilbert_r2 is exact");
    if ((c.storage == HBIL_STORAGE_HALF || c.arithmetic == HBIL_ARITHMETIC_HALF) && c.outputs & (HBIL_OUTPUTS_CONE | HBIL_OUTPUTS_SPECULAR_OCCLUSION))
        hbil__say(diags, HBIL_NOTE, c.storage == HBIL_STORAGE_HALF ? hbil_option_find("storage", 7, NULL) : hbil_option_find("arithmetic", 10, NULL),
                  "half: a cone is the root of what is hidden, so half floats move cone by up to 2e-2, specular_occlusion by 3e-2",
                  ", where little is; full moves them by 2e-3 and 5e-4");
    if (c.bounces == HBIL_BOUNCES_RECURSIVE && c.facing == HBIL_FACING_NONE)
        hbil__say(diags, HBIL_NOTE, hbil_option_find("facing", 6, NULL), "facing=none with bounces=recursive: light of surfaces that face away adds up",
                  " from bounce to bounce; half_space cuts it off");
    if (c.sweep_stride > 1 && c.slices % 2) {
        hbil__sink s;
        hbil__report(diags, HBIL_ERROR, hbil_option_find("sweep_stride", 12, NULL), &s);
        hbil__puts(&s, "sweep_stride: half of the slices lie along x, half along y, so they must be even; set slices=");
        hbil__put_int(&s, c.slices + 1);
        hbil__sink_close(&s, NULL);
        result = HBIL_E_CONFIG;
    }
    if (!hbil__check_dynamic(&c, diags) || !hbil__check_combination(&c, diags)) result = HBIL_E_CONFIG;
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i) /* after the errors: a short list must not lose those */
        if (idle[i]) hbil__say(diags, HBIL_NOTE, i, hbil__options[i].name, idle[i] == 2 ? ": members without effect in this config were cleared" :
                               " has no effect in this config and was put back to its default");
    if (result == HBIL_OK) *out = c;
    return result;
}

hbil_result hbil_config_print(const hbil_config *config, int all, char *buf, size_t cap, size_t *need)
{
    hbil__sink s = hbil__sink_open(buf, cap);
    if (!config || (!buf && cap)) return HBIL_E_ARG;
    hbil__put_config(&s, config, all, " ");
    return hbil__sink_close(&s, need);
}

uint64_t hbil_config_hash(const hbil_config *config)
{
    char text[2048];
    hbil_config c;
    uint64_t hash = 14695981039346656037u; /* FNV-1a */
    size_t i, n;
    if (!config || hbil_config_resolve(config, &c, NULL) != HBIL_OK) return 0;
    hbil_config_print(&c, 0, text, sizeof text, &n);
    for (i = 0; i < 4; ++i) hash = (hash ^ (HBIL_VERSION >> (8 * i) & 255)) * 1099511628211u;
    for (i = 0; i + 1 < n && i < sizeof text; ++i) hash = (hash ^ (unsigned char)text[i]) * 1099511628211u;
    return hash;
}

hbil_result hbil_plan_build(const hbil_config *config, hbil_plan *out, hbil_diags *diags)
{
    hbil__used used, any;
    hbil_config c;
    hbil_result result;
    int32_t i;
    if (!config || !out) return HBIL_E_ARG;
    result = hbil_config_resolve(config, &c, diags);
    if (result != HBIL_OK) return result;
    memset(out, 0, sizeof *out);
    memset(&any, 0, sizeof any);
    out->config = c;
    out->hash = hbil_config_hash(&c);
    for (i = 0; i < HBIL__COUNT(hbil__passes); ++i) {
        if (!hbil__holds(&c, hbil__passes[i].exists)) continue;
        hbil__scan_pass(&c, i, &used);
        hbil__plan_add_pass(out, &c, i, &used);
        out->passes[out->pass_count - 1].constants = (uint16_t)hbil__reads_block(&c, &used);
        any.uniforms |= used.uniforms;
        any.options[0] |= used.options[0];
        any.options[1] |= used.options[1];
    }
    for (i = 0; i < HBIL__COUNT(hbil__uniforms); ++i)
        if (hbil__marked(&any.uniforms, i) && !hbil__size_baked(&c, i))
            hbil__plan_add_constant(out, hbil__uniforms[i].name, hbil__uniforms[i].type, -1);
    for (i = 0; i < HBIL__COUNT(hbil__options); ++i)
        if (hbil__marked(any.options, i) && hbil__is_dynamic(&c, i))
            hbil__plan_add_constant(out, hbil__options[i].name,
                                    hbil__options[i].kind == HBIL_KIND_INT ? HBIL_TYPE_INT : HBIL_TYPE_FLOAT, i);
    out->constants_size = (out->constants_size + 15) / 16 * 16;
    hbil__plan_all_barriers(out);
    if (hbil__targets_fit(out, diags)) return HBIL_OK;
    memset(out, 0, sizeof *out);
    return HBIL_E_CONFIG;
}

hbil_result hbil_plan_check(const hbil_plan *plan, hbil_diags *diags)
{
    uint32_t i;
    int ok;
    if (!plan) return HBIL_E_ARG;
    ok = plan->pass_count <= HBIL_MAX_PASSES && plan->texture_count <= HBIL_MAX_TEXTURES;
    if (!ok) hbil__plan_fault(diags, "", 0, NULL, 0, "more passes or textures than fit");
    ok = ok && hbil__check_config(&plan->config, diags) && hbil__check_block(plan, diags);
    for (i = 0; ok && i < plan->texture_count; ++i) ok = hbil__check_texture(&plan->textures[i], i, diags);
    for (i = 0; ok && i < plan->pass_count; ++i) ok = hbil__check_pass(plan, i, diags);
    return ok ? HBIL_OK : HBIL_E_ARG;
}

int32_t hbil_plan_texture(const hbil_plan *plan, const char *name)
{
    uint32_t i;
    if (!plan || !name) return -1;
    for (i = 0; i < plan->texture_count && i < HBIL_MAX_TEXTURES; ++i)
        if (strncmp(plan->textures[i].name, name, sizeof plan->textures[i].name) == 0) return (int32_t)i;
    return -1;
}

int32_t hbil_plan_register(const hbil_plan *plan, int32_t pass, int32_t binding)
{
    const hbil_pass *p;
    int32_t i, n = 0;
    if (!plan || pass < 0 || pass >= HBIL_MAX_PASSES || (uint32_t)pass >= plan->pass_count) return -1;
    p = &plan->passes[pass];
    if (binding < 0 || binding >= HBIL_MAX_BINDINGS || binding >= p->binding_count) return -1;
    for (i = 0; i < binding; ++i) n += p->bindings[i].access == p->bindings[binding].access;
    return n;
}

int32_t hbil_plan_pass(const hbil_plan *plan, const char *name)
{
    uint32_t i;
    if (!plan || !name) return -1;
    for (i = 0; i < plan->pass_count && i < HBIL_MAX_PASSES; ++i)
        if (strncmp(plan->passes[i].name, name, sizeof plan->passes[i].name) == 0) return (int32_t)i;
    return -1;
}

hbil_result hbil_plan_extent(const hbil_plan *plan, int32_t texture, uint32_t width, uint32_t height, uint32_t out[2])
{
    uint32_t div;
    if (!plan || !out || texture < 0 || texture >= HBIL_MAX_TEXTURES || (uint32_t)texture >= plan->texture_count) return HBIL_E_ARG;
    if (width < 1 || width > 16384 || height < 1 || height > 16384) return HBIL_E_ARG;
    div = plan->textures[texture].div;
    if (!div) return HBIL_E_ARG;
    out[0] = (width + div - 1) / div;
    out[1] = (height + div - 1) / div;
    return HBIL_OK;
}

uint64_t hbil_plan_memory(const hbil_plan *plan, uint32_t width, uint32_t height)
{
    uint64_t sum = 0;
    uint32_t i, m, wh[2];
    if (!plan) return 0;
    for (i = 0; i < plan->texture_count; ++i) {
        const hbil_texture *t = &plan->textures[i];
        if (hbil_plan_extent(plan, (int32_t)i, width, height, wh) != HBIL_OK) return 0;
        if (t->life < HBIL_LIFE_TRANSIENT) continue;
        if (t->mips > 15) return 0;
        for (m = 0; m < t->mips; ++m) {
            uint64_t w = wh[0] >> m ? wh[0] >> m : 1, h = wh[1] >> m ? wh[1] >> m : 1;
            sum += w * h * t->copies * t->layers * hbil_format_bytes((hbil_format)t->format);
        }
    }
    return sum;
}

hbil_result hbil_plan_frame(const hbil_plan *plan, const hbil_frame *frame, hbil_dispatch *out)
{
    uint32_t i, w, h, wh[2];
    if (!plan || !frame || !out) return HBIL_E_ARG;
    w = frame->width ? frame->width : (uint32_t)plan->config.width;
    h = frame->height ? frame->height : (uint32_t)plan->config.height;
    if (w < 1 || w > 16384 || h < 1 || h > 16384 || plan->pass_count > HBIL_MAX_PASSES) return HBIL_E_ARG;
    for (i = 0; i < plan->pass_count; ++i) { /* all of them first: on E_ARG out stays as it was */
        const hbil_pass *pass = &plan->passes[i];
        if (hbil_plan_extent(plan, pass->domain, w, h, wh) != HBIL_OK || !pass->group[0] || !pass->group[1]) return HBIL_E_ARG;
        if (pass->grid == HBIL_GRID_LINES && (plan->config.sweep_stride < 1 || plan->config.sweep_stride > 16384)) return HBIL_E_ARG;
    }
    for (i = 0; i < plan->pass_count; ++i) {
        const hbil_pass *pass = &plan->passes[i];
        hbil_plan_extent(plan, pass->domain, w, h, wh);
        if (pass->grid == HBIL_GRID_LINES) {
            uint32_t stride = (uint32_t)plan->config.sweep_stride, lines = wh[0] > wh[1] ? wh[0] : wh[1];
            wh[0] = (lines + stride - 1) / stride * stride;
            wh[1] = plan->textures[pass->domain].layers;
        }
        out[i].groups[0] = (wh[0] + pass->group[0] - 1) / pass->group[0];
        out[i].groups[1] = (wh[1] + pass->group[1] - 1) / pass->group[1];
        out[i].groups[2] = 1;
    }
    return HBIL_OK;
}

hbil_result hbil_emit_glsl_hook(const hbil_plan *plan, int32_t pass, const char *hook, char *buf, size_t cap, size_t *need,
                                hbil_diags *diags)
{
    hbil__sink s = hbil__sink_open(buf, cap);
    hbil__used used;
    int32_t row;
    if (!plan || pass < 0 || (uint32_t)pass >= plan->pass_count || (!buf && cap)) return HBIL_E_ARG;
    if (hbil_plan_check(plan, diags) != HBIL_OK) return HBIL_E_ARG;
    row = hbil__pass_row(plan->passes[pass].name);
    if (row < 0) return HBIL_E_ARG;
    if (!plan->passes[pass].hook) hook = NULL;
    else if (!hbil__hook_fits(hook, diags)) return HBIL_E_HOOK;
    hbil__scan_pass(&plan->config, row, &used);
    hbil__emit_header(&s, plan, pass, row);
    hbil__emit_bindings(&s, plan, &plan->passes[pass]);
    if (plan->passes[pass].constants) hbil__emit_block(&s, plan);
    hbil__emit_constants(&s, &plan->config, &used);
    if (hook) hbil__emit_hook(&s, hook);
    hbil__emit_chunks(&s, &plan->config, &used);
    return hbil__sink_close(&s, need);
}

hbil_result hbil_emit_glsl(const hbil_plan *plan, int32_t pass, char *buf, size_t cap, size_t *need)
{
    return hbil_emit_glsl_hook(plan, pass, NULL, buf, cap, need, NULL);
}

hbil_result hbil_emit_vertex(const hbil_plan *plan, char *buf, size_t cap, size_t *need)
{
    hbil__sink s = hbil__sink_open(buf, cap);
    int32_t i;
    if (!plan || !hbil__draws(plan) || (!buf && cap) || hbil_plan_check(plan, NULL) != HBIL_OK) return HBIL_E_ARG;
    hbil__put_version(&s, plan);
    for (i = 0; i < HBIL__COUNT(hbil__chunks); ++i)
        if (strcmp(hbil__chunks[i].name, "vertex") == 0) hbil__puts(&s, hbil__chunks[i].text);
    return hbil__sink_close(&s, need);
}

hbil_result hbil_emit_manifest(const hbil_plan *plan, char *buf, size_t cap, size_t *need)
{
    hbil__sink s = hbil__sink_open(buf, cap);
    uint32_t i;
    if (!plan || (!buf && cap) || hbil_plan_check(plan, NULL) != HBIL_OK) return HBIL_E_ARG;
    hbil__puts(&s, "{\n  ");
    hbil__json_int(&s, "schema", 1, 1);
    hbil__json_int(&s, "version", HBIL_VERSION, 0);
    hbil__puts(&s, ", \"hash\": \"");
    hbil__put_hex(&s, plan->hash);
    hbil__puts(&s, "\",\n");
    hbil__json_config(&s, &plan->config);
    hbil__json_block(&s, plan);
    hbil__json_textures(&s, plan);
    hbil__puts(&s, "  \"passes\": [");
    for (i = 0; i < plan->pass_count; ++i) {
        hbil__puts(&s, i ? ",\n    {" : "\n    {");
        hbil__json_pass(&s, plan, &plan->passes[i]);
        hbil__puts(&s, "}");
    }
    hbil__puts(&s, "]\n}\n");
    return hbil__sink_close(&s, need);
}

hbil_result hbil_pack_constants(const hbil_plan *plan, const hbil_frame *frame, void *buf, size_t cap, size_t *need,
                                hbil_diags *diags)
{
    hbil__camera camera;
    unsigned char block[HBIL_CONSTANTS_MAX];
    uint32_t i;
    if (!plan || !frame || (!buf && cap)) return HBIL_E_ARG;
    if (!hbil__check_config(&plan->config, diags) || !hbil__check_block(plan, diags)) return HBIL_E_ARG;
    if (!hbil__read_camera(plan, frame, diags, &camera)) return HBIL_E_FRAME;
    memset(block, 0, sizeof block);
    for (i = 0; i < plan->constant_count; ++i)
        if (!hbil__pack_one(plan, frame, &camera, &plan->constants[i], block, diags)) return HBIL_E_FRAME;
    if (need) *need = plan->constants_size;
    if (cap < plan->constants_size) return HBIL_E_SPACE;
    if (plan->constants_size) memcpy(buf, block, plan->constants_size);
    return HBIL_OK;
}

/* The plan must stay plain data of a known size. */
typedef char hbil__static_assert_plan[sizeof(hbil_plan) <= 8192 ? 1 : -1];
typedef char hbil__static_assert_options[HBIL__COUNT(hbil__options) <= 64 ? 1 : -1];
typedef char hbil__static_assert_chunk_bits[HBIL__COUNT(hbil__chunks) <= 256 ? 1 : -1];
typedef char hbil__static_assert_tables[HBIL__COUNT(hbil__textures) <= 64 &&
                                        HBIL__COUNT(hbil__passes) <= HBIL_MAX_PASSES &&
                                        HBIL__COUNT(hbil__uniforms) <= 32 &&
                                        HBIL__COUNT(hbil__array_ends) == HBIL__COUNT(hbil__types) ? 1 : -1];

#endif /* HBIL_IMPLEMENTED */
#endif /* HBIL_IMPLEMENTATION */
