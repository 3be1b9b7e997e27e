/* model.c - built-in scenes through examples/frame/scene.c, files through assimp. */
#include "model.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../frame/capture.h"

/* What a scene of examples/frame lacks here: its own cameras are for pictures of one surface, not for walking about. */
static const struct { const char *name; float eye[3], pivot[3], half_fov, sun[3], sun_light[3], radius; } scenes[] = {
    {"cornell", {0.0f, -5.2f, 2.73f}, {0.0f, 2.8f, 2.55f}, 0.42f, {-0.35f, -0.55f, 0.75f}, {2.9f, 2.45f, 1.85f}, 5.0f},
    {"fence", {0.9f, -4.2f, 3.4f}, {0.1f, 0.2f, 0.5f}, 0.30f, {-0.55f, -0.72f, 0.55f}, {2.9f, 2.45f, 1.85f}, 5.0f},
    {"terrain", {0.0f, 0.0f, 2.4f}, {0.0f, 20.0f, 1.6f}, 0.33f, {-0.80f, -0.15f, 0.45f}, {2.9f, 2.45f, 1.85f}, 60.0f},
    {"metals", {0.5f, -3.6f, 1.65f}, {0.05f, 0.5f, 0.62f}, 0.30f, {0.55f, -0.62f, 0.60f}, {2.9f, 2.45f, 1.85f}, 5.0f},
};

/* glTF ends emission at 1, what is white on a screen; the extension that lifts it is not read by assimp 5.2. The
 * sun here is at 6. */
#define GLOW 8.0f

static void unit(float v[3])
{
    const float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    int c;

    for (c = 0; c < 3; c++) v[c] = length > 0.0f ? v[c] / length : 0.0f;
}

static void cross(const float a[3], const float b[3], float out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* The sky of the captures. */
static void set_sky(model *m)
{
    static const float ground[3] = {0.30f, 0.22f, 0.14f}, zenith[3] = {0.45f, 0.75f, 1.30f};

    memcpy(m->sky_ground, ground, sizeof ground);
    memcpy(m->sky_zenith, zenith, sizeof zenith);
    m->exposure = 0.5f;
}

void model_free(model *m)
{
    free(m->vertices);
    memset(m, 0, sizeof *m);
}

/* ---- built-in scenes --------------------------------------------------------------------------------------------- */

const char *model_scene_name(int index) { return capture_scene_name(index); }

static void fill_triangle(gpu_vertex *v, const float corners[9], const float albedo[3], const float emission[3])
{
    float a[3], b[3], normal[3];
    int   i, c;

    for (c = 0; c < 3; c++) {
        a[c] = corners[3 + c] - corners[c];
        b[c] = corners[6 + c] - corners[c];
    }
    cross(a, b, normal);
    unit(normal);
    for (i = 0; i < 3; i++) {
        memcpy(v[i].position, corners + 3 * i, sizeof v[i].position);
        memcpy(v[i].normal, normal, sizeof normal);
        memcpy(v[i].albedo, albedo, sizeof v[i].albedo);
        memcpy(v[i].emission, emission, sizeof v[i].emission);
        v[i].metallic = 0.0f;
        v[i].roughness = 0.7f;
    }
}

int model_scene(model *out, const char *name, char *error, size_t error_size)
{
    scene_mesh mesh;
    unsigned   t;
    size_t     i = 0;

    memset(out, 0, sizeof *out);
    if (!capture_scene_mesh(&mesh, name, error, error_size)) return 0;
    while (i + 1 < sizeof scenes / sizeof *scenes && strcmp(scenes[i].name, name) != 0) i++;
    memcpy(out->eye, scenes[i].eye, sizeof out->eye);
    memcpy(out->pivot, scenes[i].pivot, sizeof out->pivot);
    memcpy(out->sun, scenes[i].sun, sizeof out->sun);
    memcpy(out->sun_light, scenes[i].sun_light, sizeof out->sun_light);
    unit(out->sun);
    out->half_fov = scenes[i].half_fov;
    out->near_z = 0.1f;
    out->far_z = 100.0f;
    out->radius = scenes[i].radius;
    set_sky(out);
    out->count = 3 * (size_t)mesh.count;
    out->vertices = malloc(out->count * sizeof *out->vertices);
    for (t = 0; out->vertices && t < mesh.count; t++)
        fill_triangle(out->vertices + 3 * t, mesh.corners + 9 * t, mesh.albedo + 3 * t, mesh.emission + 3 * t);
    scene_mesh_free(&mesh);
    return out->vertices || frame_error(error, error_size, "scene %s: out of memory", name);
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

/* +Y up to +Z up. */
static void turn_up(struct aiVector3D v, float out[3])
{
    out[0] = v.x;
    out[1] = -v.z;
    out[2] = v.y;
}

static void read_material(const struct aiMaterial *material, gpu_vertex *out)
{
    const struct aiColor4D grey = {0.8f, 0.8f, 0.8f, 1.0f}, black = {0.0f, 0.0f, 0.0f, 1.0f};
    struct aiColor4D base = grey, emission = black;
    int c;

    memset(out, 0, sizeof *out);
    out->roughness = 1.0f;
    if (aiGetMaterialColor(material, AI_MATKEY_BASE_COLOR, &base) != aiReturn_SUCCESS)
        aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, &base);
    aiGetMaterialColor(material, AI_MATKEY_COLOR_EMISSIVE, &emission);
    /* not aiGetMaterialFloat: an inline function, of which C has no other copy in builds that do not inline */
    aiGetMaterialFloatArray(material, AI_MATKEY_METALLIC_FACTOR, &out->metallic, NULL);
    aiGetMaterialFloatArray(material, AI_MATKEY_ROUGHNESS_FACTOR, &out->roughness, NULL);
    out->albedo[0] = base.r, out->albedo[1] = base.g, out->albedo[2] = base.b;
    out->emission[0] = emission.r, out->emission[1] = emission.g, out->emission[2] = emission.b;
    for (c = 0; c < 3; c++) out->emission[c] *= GLOW;
}

static size_t count_corners(const struct aiScene *scene)
{
    size_t   count = 0;
    unsigned i;

    for (i = 0; i < scene->mNumMeshes; i++)
        if (scene->mMeshes[i]->mPrimitiveTypes == aiPrimitiveType_TRIANGLE)
            count += 3 * (size_t)scene->mMeshes[i]->mNumFaces;
    return count;
}

static void read_meshes(const struct aiScene *scene, gpu_vertex *to)
{
    gpu_vertex as_material;
    unsigned   i, f, c;

    for (i = 0; i < scene->mNumMeshes; i++) {
        const struct aiMesh *mesh = scene->mMeshes[i];
        if (mesh->mPrimitiveTypes != aiPrimitiveType_TRIANGLE) continue;
        read_material(scene->mMaterials[mesh->mMaterialIndex], &as_material);
        for (f = 0; f < mesh->mNumFaces; f++)
            for (c = 0; c < 3; c++, to++) {
                const unsigned corner = mesh->mFaces[f].mIndices[c];
                *to = as_material;
                turn_up(mesh->mVertices[corner], to->position);
                turn_up(mesh->mNormals[corner], to->normal);
            }
    }
}

static const struct aiNode *find_node(const struct aiNode *node, const struct aiString *name)
{
    const struct aiNode *found = strcmp(node->mName.data, name->data) == 0 ? node : NULL;
    unsigned i;

    for (i = 0; i < node->mNumChildren && !found; i++) found = find_node(node->mChildren[i], name);
    return found;
}

/* Where the node of that name is and where its -z points. To be asked before aiProcess_PreTransformVertices takes
 * the nodes away. Cameras and lights of glTF have no place of their own in it, whatever assimp 5.2 writes into
 * mPosition. */
static int place_of(const struct aiScene *scene, const struct aiString *name, float origin[3], float forward[3])
{
    const struct aiNode *node = find_node(scene->mRootNode, name);
    struct aiMatrix4x4   to_world, above;
    struct aiMatrix3x3   rotation;
    struct aiVector3D    at = {0.0f, 0.0f, 0.0f}, along = {0.0f, 0.0f, -1.0f};

    if (!node) return 0;
    for (aiIdentityMatrix4(&to_world); node; node = node->mParent) {
        above = node->mTransformation;
        aiMultiplyMatrix4(&above, &to_world);
        to_world = above;
    }
    aiTransformVecByMatrix4(&at, &to_world);
    aiMatrix3FromMatrix4(&rotation, &to_world);
    aiTransformVecByMatrix3(&along, &rotation);
    turn_up(at, origin);
    turn_up(along, forward);
    unit(forward);
    return 1;
}

/* The first camera of the file; 0: it has none. */
static int read_camera(const struct aiScene *scene, float eye[3], float forward[3], float *half_fov)
{
    const struct aiCamera *camera = scene->mNumCameras > 0 ? scene->mCameras[0] : NULL;

    if (!camera || !place_of(scene, &camera->mName, eye, forward)) return 0;
    *half_fov = atanf(tanf(0.5f * camera->mHorizontalFOV) / (camera->mAspect > 0.0f ? camera->mAspect : 16.0f / 9.0f));
    return 1;
}

/* The first directional light of the file (glTF: KHR_lights_punctual) is the sun; without one there is ours. */
static void read_sun(const struct aiScene *scene, model *m)
{
    static const float sun[3] = {-0.45f, -0.60f, 0.66f}, sun_light[3] = {5.8f, 4.9f, 3.7f};
    float              origin[3], forward[3];
    unsigned           i;
    int                c;

    memcpy(m->sun, sun, sizeof sun);
    memcpy(m->sun_light, sun_light, sizeof sun_light);
    for (i = 0; i < scene->mNumLights; i++) {
        const struct aiLight *light = scene->mLights[i];
        const float irradiance[3] = {light->mColorDiffuse.r, light->mColorDiffuse.g, light->mColorDiffuse.b};
        if (light->mType != aiLightSource_DIRECTIONAL || !place_of(scene, &light->mName, origin, forward)) continue;
        for (c = 0; c < 3; c++) {
            m->sun[c] = -forward[c];
            m->sun_light[c] = irradiance[c] / 3.14159265f;
        }
        break;
    }
    unit(m->sun);
}

/* Camera, planes and sky for a model of this size. */
static void set_view(model *m, int has_camera, const float forward[3])
{
    float  low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f}, radius = 0.0f;
    size_t i;
    int    c;

    for (i = 0; i < m->count; i++)
        for (c = 0; c < 3; c++) {
            low[c] = fminf(low[c], m->vertices[i].position[c]);
            high[c] = fmaxf(high[c], m->vertices[i].position[c]);
        }
    for (c = 0; c < 3; c++) {
        m->pivot[c] = 0.5f * (low[c] + high[c]);
        radius += 0.25f * (high[c] - low[c]) * (high[c] - low[c]);
    }
    m->radius = fmaxf(sqrtf(radius), 1e-3f);
    if (has_camera) { /* turn about the point on its axis that is nearest to the middle */
        float along = 0.0f;
        for (c = 0; c < 3; c++) along += (m->pivot[c] - m->eye[c]) * forward[c];
        along = fmaxf(along, 0.1f * m->radius);
        for (c = 0; c < 3; c++) m->pivot[c] = m->eye[c] + along * forward[c];
    } else {
        m->half_fov = 0.40f;
        memcpy(m->eye, m->pivot, sizeof m->eye);
        m->eye[1] -= m->radius / sinf(m->half_fov);
        m->eye[2] += 0.5f * m->radius;
    }
    m->near_z = 0.01f * m->radius;
    m->far_z = 20.0f * m->radius;
    set_sky(m);
}

int model_file(model *out, const char *path, char *error, size_t error_size)
{
    const unsigned flags = aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_GenNormals;
    const struct aiScene *scene = aiImportFile(path, flags);
    float forward[3];
    int   has_camera;

    memset(out, 0, sizeof *out);
    if (!scene) return frame_error(error, error_size, "%s: %s", path, aiGetErrorString());
    has_camera = read_camera(scene, out->eye, forward, &out->half_fov);
    read_sun(scene, out);
    scene = aiApplyPostProcessing(scene, aiProcess_PreTransformVertices);
    if (!scene) return frame_error(error, error_size, "%s: %s", path, aiGetErrorString());
    out->count = count_corners(scene);
    out->vertices = malloc((out->count ? out->count : 1) * sizeof *out->vertices);
    if (out->vertices && out->count) {
        read_meshes(scene, out->vertices);
        set_view(out, has_camera, forward);
    }
    aiReleaseImport(scene);
    if (!out->vertices) return frame_error(error, error_size, "%s: out of memory", path);
    return out->count > 0 || frame_error(error, error_size, "%s: holds no triangles", path);
}
