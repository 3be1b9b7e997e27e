/* hbil-ogre - hbil.h inside OGRE 1.12: what a renderer that somebody else wrote has to add. OGRE owns the context, the
 * scene, the G-buffer and hbil's outputs; hbil runs as one custom pass of OGRE's compositor.
 *
 *   gbuffer    OGRE draws the scene into four textures: albedo, direct light, view normal, view depth in m
 *   hbil       reads depth, normal and direct light, writes ao and irradiance. Search for >>hbil
 *   composite  OGRE draws a quad: direct + albedo * irradiance
 *
 * How OGRE's conventions map to those of hbil.h
 *   texels     On GL, OGRE renders to textures upside down: row 0 is the top of the picture, as in Direct3D. For that
 *              it negates row 1 of the projection (RenderTarget::requiresTextureFlipping); texel row 0 is ndc y = -1
 *              of the negated matrix: hbil's convention, if hbil gets that matrix. Camera::getProjectionMatrix is not
 *              negated.
 *   matrices   of column vectors, as hbil's, but stored by rows: transpose.
 *   depth      depth=linear: the fragment shader writes metres; cleared to 0, which is sky. OGRE's depth buffer is a
 *              renderbuffer, which no shader reads. If yours is a texture: depth=device clip=gl, and the matrix of
 *              Camera::getProjectionMatrixWithRSDepth.
 *   normals    normals=view: OGRE's view space is hbil's, right-handed, looking along -z. The negation is part of the
 *              projection, so normals are as they are.
 *   radiance   the texture of direct light, with what glows in it.
 *
 * OGRE caches GL's state and calls GL only where it believes to change something. hbil_gl.h puts back what it touches:
 * the cache stays true, and nothing has to be told to OGRE.
 */
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include <Ogre.h>
#include <OgreCustomCompositionPass.h>
#include <OgreScriptCompiler.h>
#include <Bites/OgreWindowEventUtilities.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h> /* OGRE's STBI codec frees with delete[] what malloc gave */

#define HBIL_IMPLEMENTATION
#include "../../hbil.h"
#define HBIL_GL_IMPLEMENTATION
#include "../../backends/hbil_gl.h"

/* Declared here, as <GL/glx.h> would define None, Bool and more. OGRE does not hand out its own loader. */
extern "C" void (*glXGetProcAddressARB(const unsigned char *name))(void);

enum { DONE = 0, REFUSED = 1, USAGE = 2, FILES = 3, BACKEND = 5 };

struct Failure : std::runtime_error {
    int code;
    Failure(int exit_code, const std::string &text) : std::runtime_error(text), code(exit_code) {}
};

static const char *const views[] = {"composite", "direct", "ao", "split"}; /* as the composite shader counts them */

struct Arguments {
    std::string              preset = "balanced", png;
    std::vector<std::string> sets;
    unsigned                 width = 640, height = 360, frames = 0;
    int                      view = 0;
};

/* ---- OGRE's part: shaders, materials, compositor, scene ---------------------------------------------------------- */

static const char surface_vertex[] = R"(#version 330 core
uniform mat4 to_clip, to_world;
uniform mat4 normal_to_view, normal_to_world, to_view, to_shadow;
in vec4 vertex;
in vec3 normal;
out vec3 world, world_normal, view_normal;
out vec4 shadow;
out float depth;
void main()
{
    gl_Position = to_clip * vertex;
    world = (to_world * vertex).xyz;
    world_normal = normalize(mat3(normal_to_world) * normal);
    view_normal = mat3(normal_to_view) * normal;
    depth = -(to_view * vertex).z;
    shadow = to_shadow * vec4(world + 0.03 * world_normal, 1.0); /* m: no surface shadows itself */
}
)";

static const char surface_fragment[] = R"(#version 330 core
uniform vec4 albedo, emission;
uniform vec4 light_position, light_direction, light_colour; /* world */
uniform vec4 light_cone;                                    /* cosines of the half angles, inner and outer */
uniform sampler2D shadow_map;                               /* distance to the light, m */
in vec3 world, world_normal, view_normal;
in vec4 shadow;
in float depth;
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out vec4 out_direct;
layout(location = 2) out vec4 out_normal;
layout(location = 3) out float out_depth;
void main()
{
    vec3 to_light = light_position.xyz - world;
    float range = length(to_light), lit = 0.0;
    to_light /= range;
    for (int i = 0; i < 9; ++i) {
        vec2 at = shadow.xy / shadow.w + (vec2(i % 3, i / 3) - 1.0) / vec2(textureSize(shadow_map, 0));
        lit += range < textureLod(shadow_map, at, 0.0).r + 0.05 ? 1.0 / 9.0 : 0.0;
    }
    lit *= smoothstep(light_cone.y, light_cone.x, -dot(to_light, light_direction.xyz));
    lit *= max(dot(to_light, normalize(world_normal)), 0.0);
    out_albedo = albedo;
    out_direct = vec4(emission.rgb + albedo.rgb * light_colour.rgb * lit, 1.0);
    out_normal = vec4(normalize(view_normal), 0.0);
    out_depth = depth;
}
)";

static const char caster_vertex[] = R"(#version 330 core
uniform mat4 to_clip, to_world;
in vec4 vertex;
out vec3 world;
void main()
{
    gl_Position = to_clip * vertex;
    world = (to_world * vertex).xyz;
}
)";

static const char caster_fragment[] = R"(#version 330 core
uniform vec3 eye;
in vec3 world;
layout(location = 0) out float range;
void main() { range = distance(world, eye); }
)";

static const char quad_vertex[] = R"(#version 330 core
uniform mat4 to_clip;
in vec4 vertex;
in vec2 uv0;
out vec2 uv;
void main()
{
    gl_Position = to_clip * vertex;
    uv = uv0;
}
)";

static const char composite_fragment[] = R"(#version 330 core
uniform int view;
uniform vec4 sky;
uniform sampler2D albedo, direct, depth, ao, irradiance;
in vec2 uv;
layout(location = 0) out vec4 colour;
void main()
{
    vec3 light = texture(direct, uv).rgb;
    if (view == 0 || (view == 3 && uv.x > 0.5)) light += texture(albedo, uv).rgb * texture(irradiance, uv).rgb;
    if (texture(depth, uv).r <= 0.0) light = sky.rgb;
    light = pow(1.0 - exp(-light), vec3(1.0 / 2.2));
    if (view == 2) light = texture(ao, uv).rrr;
    if (view == 3 && abs(uv.x - 0.5) * float(textureSize(ao, 0).x) < 1.0) light = vec3(1.0);
    colour = vec4(light, 1.0);
}
)";

/* The textures of the compositor are OGRE's: it makes them at the size of the target, and again when that changes.
 * Nothing renders to ao and irradiance: the pass hbil writes them. */
static const char script[] = R"(
material caster { technique { pass {
    vertex_program_ref caster_vertex { param_named_auto to_clip worldviewproj_matrix
                                       param_named_auto to_world world_matrix }
    fragment_program_ref caster_fragment { param_named_auto eye camera_position }
} } }

material surface { technique { shadow_caster_material caster
pass {
    vertex_program_ref surface_vertex {
        param_named_auto to_clip worldviewproj_matrix
        param_named_auto to_world world_matrix
        param_named_auto to_view worldview_matrix
        param_named_auto normal_to_view inverse_transpose_worldview_matrix
        param_named_auto normal_to_world inverse_transpose_world_matrix
        param_named_auto to_shadow texture_viewproj_matrix 0
    }
    fragment_program_ref surface_fragment {
        param_named_auto albedo surface_diffuse_colour
        param_named_auto emission surface_emissive_colour
        param_named_auto light_position light_position 0
        param_named_auto light_direction light_direction 0
        param_named_auto light_colour light_diffuse_colour 0
        param_named_auto light_cone spotlight_params 0
    }
    texture_unit { content_type shadow
                   filtering none
                   tex_address_mode clamp }
} } }

material composite { technique { pass {
    depth_check off
    depth_write off
    vertex_program_ref quad_vertex { param_named_auto to_clip worldviewproj_matrix }
    fragment_program_ref composite_fragment {
        param_named albedo int 0
        param_named direct int 1
        param_named depth int 2
        param_named ao int 3
        param_named irradiance int 4
    }
    texture_unit { filtering none }
    texture_unit { filtering none }
    texture_unit { filtering none }
    texture_unit { filtering none }
    texture_unit { filtering none }
} } }

compositor hbil { technique {
    texture gbuffer target_width target_height PF_A8B8G8R8 PF_FLOAT16_RGBA PF_FLOAT16_RGBA PF_FLOAT32_R
    texture ao target_width target_height PF_FLOAT32_R
    texture irradiance target_width target_height PF_FLOAT32_RGBA
    target gbuffer {
        input none
        pass clear { colour_value 0 0 0 0 }
        pass render_scene { }
    }
    target_output {
        input none
        pass render_custom hbil { }
        pass render_quad {
            material composite
            input 0 gbuffer 0
            input 1 gbuffer 1
            input 2 gbuffer 3
            input 3 ao
            input 4 irradiance
        }
    }
} }
)";

static const float sky[3] = {0.18f, 0.26f, 0.40f}; /* radiance of all that the scene leaves open */

static void make_program(const char *name, Ogre::GpuProgramType type, const char *source)
{
    Ogre::HighLevelGpuProgramPtr program =
        Ogre::HighLevelGpuProgramManager::getSingleton().createProgram(name, Ogre::RGN_DEFAULT, "glsl", type);
    program->setSource(source);
}

static void make_materials(int view)
{
    make_program("surface_vertex", Ogre::GPT_VERTEX_PROGRAM, surface_vertex);
    make_program("surface_fragment", Ogre::GPT_FRAGMENT_PROGRAM, surface_fragment);
    make_program("caster_vertex", Ogre::GPT_VERTEX_PROGRAM, caster_vertex);
    make_program("caster_fragment", Ogre::GPT_FRAGMENT_PROGRAM, caster_fragment);
    make_program("quad_vertex", Ogre::GPT_VERTEX_PROGRAM, quad_vertex);
    make_program("composite_fragment", Ogre::GPT_FRAGMENT_PROGRAM, composite_fragment);
    Ogre::DataStreamPtr stream(
        new Ogre::MemoryDataStream("hbil-ogre", const_cast<char *>(script), sizeof script - 1, false, true));
    Ogre::ScriptCompilerManager::getSingleton().parseScript(stream, Ogre::RGN_DEFAULT);
    Ogre::MaterialPtr composite = Ogre::MaterialManager::getSingleton().getByName("composite");
    composite->load();
    Ogre::GpuProgramParametersSharedPtr parameters =
        composite->getTechnique(0)->getPass(0)->getFragmentProgramParameters();
    parameters->setNamedConstant("view", view);
    parameters->setNamedConstant("sky", Ogre::Vector4(sky[0], sky[1], sky[2], 1));
}

/* A box or sphere of OGRE's, of this size around this place, m. OGRE's own are 100 units wide. */
static void add(Ogre::SceneManager *scene, Ogre::SceneManager::PrefabType type, const Ogre::Vector3 &at,
                const Ogre::Vector3 &size, float degrees, const Ogre::ColourValue &albedo,
                const Ogre::ColourValue &emission = Ogre::ColourValue::Black)
{
    Ogre::Entity     *entity = scene->createEntity(type);
    Ogre::SceneNode  *node = scene->getRootSceneNode()->createChildSceneNode(at);
    Ogre::MaterialPtr material = Ogre::MaterialManager::getSingleton().getByName("surface")->clone(entity->getName());
    material->getTechnique(0)->getPass(0)->setDiffuse(albedo);
    material->getTechnique(0)->getPass(0)->setSelfIllumination(emission);
    entity->setMaterial(material);
    node->attachObject(entity);
    node->setScale(size / 100);
    node->yaw(Ogre::Degree(degrees));
}

/* A room of 4 x 3 x 4 m, open in front and over its right half, y up. A spot light comes in from above, a panel glows
 * on the right wall. */
static void make_scene(Ogre::SceneManager *scene)
{
    const Ogre::SceneManager::PrefabType box = Ogre::SceneManager::PT_CUBE, ball = Ogre::SceneManager::PT_SPHERE;
    const Ogre::ColourValue white(0.73f, 0.71f, 0.68f), red(0.63f, 0.06f, 0.05f), green(0.12f, 0.45f, 0.10f);
    const Ogre::ColourValue yellow(0.65f, 0.50f, 0.15f), black(0, 0, 0), glow(5, 2.2f, 0.6f);

    add(scene, box, {0, -0.1f, 1}, {4.4f, 0.2f, 6}, 0, white);
    add(scene, box, {0, 1.5f, -2.1f}, {4.4f, 3, 0.2f}, 0, white);
    add(scene, box, {-2.1f, 1.5f, 0}, {0.2f, 3, 4}, 0, red);
    add(scene, box, {2.1f, 1.5f, 0}, {0.2f, 3, 4}, 0, green);
    add(scene, box, {-1.1f, 3.1f, 0}, {2.2f, 0.2f, 4}, 0, white);
    add(scene, box, {-0.9f, 0.8f, -0.9f}, {0.9f, 1.6f, 0.9f}, 20, white);
    add(scene, box, {1.0f, 0.3f, -0.2f}, {0.6f, 0.6f, 0.6f}, -25, white);
    add(scene, ball, {-0.35f, 0.4f, 0.5f}, {0.8f, 0.8f, 0.8f}, 0, white);
    add(scene, ball, {1.0f, 0.9f, -0.2f}, {0.6f, 0.6f, 0.6f}, 0, yellow);
    add(scene, box, {1.97f, 0.6f, -1.2f}, {0.06f, 0.7f, 0.9f}, 0, black, glow);

    Ogre::Light     *light = scene->createLight("light");
    Ogre::SceneNode *node = scene->getRootSceneNode()->createChildSceneNode(Ogre::Vector3(3.2f, 6.5f, 2.6f));
    light->setType(Ogre::Light::LT_SPOTLIGHT);
    light->setDiffuseColour(Ogre::ColourValue(2.4f, 2.2f, 1.9f));
    light->setSpotlightRange(Ogre::Degree(42), Ogre::Degree(50));
    node->attachObject(light);
    node->lookAt(Ogre::Vector3(-0.7f, 0, -0.4f), Ogre::Node::TS_WORLD);

    scene->setShadowTechnique(Ogre::SHADOWTYPE_TEXTURE_ADDITIVE_INTEGRATED);
    scene->setShadowTextureSettings(1024, 1, Ogre::PF_FLOAT32_R);
    scene->setShadowTextureSelfShadow(true);
    scene->setShadowCasterRenderBackFaces(false);
    scene->setShadowFarDistance(30);
}

/* ---- >>hbil    the integration ----------------------------------------------------------------------------------- */

static void *get_proc(void *, const char *name)
{
    return reinterpret_cast<void *>(glXGetProcAddressARB(reinterpret_cast<const unsigned char *>(name)));
}

/* OGRE's matrices are stored by rows. */
static void copy(const Ogre::Matrix4 &from, float to[16])
{
    for (size_t i = 0; i < 16; ++i) to[i] = from[i % 4][i / 4];
}

/* The pass `render_custom hbil` of the compositor. */
struct Lighting : Ogre::CustomCompositionPass {
    hbil_gl    gl;
    hbil_frame frame;

    explicit Lighting(const hbil_plan &plan) : gl(), frame()
    {
        std::vector<char> scratch(HBIL_GLSL_MAX);
        hbil_gl_info info = {};
        info.plan = &plan;
        info.get_proc = get_proc;
        info.scratch = scratch.data();
        info.scratch_size = scratch.size();
        if (hbil_gl_init(&info, &gl) != HBIL_GL_OK) throw Failure(BACKEND, gl.message);
        std::memcpy(frame.far_color, sky, sizeof sky);
        frame.reset = 1;
    }
    ~Lighting() { hbil_gl_shutdown(&gl); }
    Lighting(const Lighting &) = delete;
    Lighting &operator=(const Lighting &) = delete;

    /* Each frame, after the G-buffer. Textures are looked up anew: OGRE makes others when the window is resized. */
    void run(Ogre::CompositorInstance *compositor)
    {
        static const struct { const char *plan, *ogre; size_t index; } names[] = {
            {"albedo", "gbuffer", 0}, {"radiance", "gbuffer", 1}, {"normal", "gbuffer", 2}, {"depth", "gbuffer", 3},
            {"ao", "ao", 0},          {"irradiance", "irradiance", 0}};
        unsigned textures[HBIL_MAX_TEXTURES] = {};
        for (const auto &name : names) {
            const int32_t i = hbil_plan_texture(&gl.plan, name.plan); /* -1: this config does without */
            if (i >= 0) compositor->getTextureInstance(name.ogre, name.index)->getCustomAttribute("GLID", &textures[i]);
        }
        const Ogre::RenderTarget *target = compositor->getRenderTarget("gbuffer");
        const Ogre::Camera *camera = compositor->getChain()->getViewport()->getCamera();
        Ogre::Matrix4 projection = camera->getProjectionMatrix();
        for (size_t i = 0; i < 4 && target->requiresTextureFlipping(); ++i) projection[1][i] = -projection[1][i];

        std::memcpy(frame.last_projection, frame.projection, sizeof frame.projection);
        std::memcpy(frame.last_view, frame.view, sizeof frame.view);
        copy(projection, frame.projection);
        copy(camera->getViewMatrix(), frame.view);
        frame.width = target->getWidth();
        frame.height = target->getHeight();
        if (hbil_gl_resize(&gl, frame.width, frame.height, textures) != HBIL_GL_OK ||
            hbil_gl_run(&gl, &frame) != HBIL_GL_OK)
            throw Failure(BACKEND, gl.message);
        /* GL_TEXTURE_FETCH_BARRIER_BIT: the quad samples what was stored as images. Drawn textures need no barrier */
        if (gl.plan.config.stage == HBIL_STAGE_COMPUTE) gl.gl.memoryBarrier(0x08);
        frame.reset = 0;
        ++frame.index;
    }

    struct Operation : Ogre::CompositorInstance::RenderSystemOperation {
        Lighting                 *lighting;
        Ogre::CompositorInstance *compositor;
        void execute(Ogre::SceneManager *, Ogre::RenderSystem *) override { lighting->run(compositor); }
    };
    Ogre::CompositorInstance::RenderSystemOperation *createOperation(Ogre::CompositorInstance *compositor,
                                                                     const Ogre::CompositionPass *) override
    {
        Operation *operation = OGRE_NEW Operation; /* OGRE deletes it */
        operation->lighting = this;
        operation->compositor = compositor;
        return operation;
    }
};

/* What the command line asks for, and on top of it what this engine has to give and how. */
static hbil_plan make_plan(const Arguments &arguments)
{
    hbil_diag   items[16];
    hbil_diags  diags = {items, 16, 0};
    hbil_config config = {};
    hbil_plan   plan;
    bool        ok = hbil_config_preset(arguments.preset.c_str(), &config, &diags) == HBIL_OK;

    for (const std::string &set : arguments.sets)
        ok = hbil_config_parse(&config, set.c_str(), set.size(), &diags) == HBIL_OK && ok;
    config.target = HBIL_TARGET_GL;
    config.outputs = HBIL_OUTPUTS_AO | HBIL_OUTPUTS_IRRADIANCE;
    config.depth = HBIL_DEPTH_LINEAR;
    config.normals = HBIL_NORMALS_VIEW;
    config.normal_encoding = HBIL_NORMAL_ENCODING_XYZ;
    config.multisample = HBIL_MULTISAMPLE_NO;
    config.environment = HBIL_ENVIRONMENT_CONSTANT;
    config.projection = HBIL_PROJECTION_PERSPECTIVE;
    config.reproject = HBIL_REPROJECT_CAMERA; /* nothing else moves */
    config.f0 = HBIL_F0_NONE;                 /* and nothing is of metal */
    ok = ok && hbil_plan_build(&config, &plan, &diags) == HBIL_OK;
    std::string text;
    for (int32_t i = 0; i < diags.count && i < diags.capacity; ++i) text += std::string(i ? "; " : "") + items[i].text;
    if (!ok) throw Failure(REFUSED, text);
    if (!text.empty()) std::fprintf(stderr, "hbil-ogre: %s\n", text.c_str());
    return plan;
}

/* ---- the program ------------------------------------------------------------------------------------------------- */

/* Takes note that the window shall close, and keeps OGRE from destroying it with the context before hbil is gone. */
struct Closing : OgreBites::WindowEventListener {
    bool asked = false;
    bool windowClosing(Ogre::RenderWindow *) override { return asked = true, false; }
};

/* Members go in reverse order: hbil's programs and textures while OGRE's context is there, OGRE's log last. */
struct Engine {
    Ogre::LogManager          logs;
    Ogre::Log                *log;
    Ogre::Root                root;
    Ogre::RenderWindow       *window;
    Ogre::RenderTarget       *target; /* the window, or with --png a texture: nobody resizes that */
    Ogre::SceneNode          *camera;
    std::unique_ptr<Lighting> lighting;

    Engine()
        : log(logs.createLog("hbil-ogre", true, false, true)), root("", "", ""), window(NULL), target(NULL),
          camera(NULL)
    {
        log->setLogDetail(Ogre::LL_LOW); /* nothing but errors, and no file */
    }

    void open(const Arguments &arguments, const hbil_plan &plan)
    {
        Ogre::ResourceGroupManager &resources = Ogre::ResourceGroupManager::getSingleton();
        open_target(arguments.width, arguments.height, !arguments.png.empty());
        lighting.reset(new Lighting(plan));
        Ogre::CompositorManager::getSingleton().registerCustomCompositionPass("hbil", lighting.get());
        make_materials(arguments.view);
        /* OGRE compiles programs for shadow volumes, too, even if shadows come from a texture */
        resources.addResourceLocation(HBIL_OGRE_MEDIA "/ShadowVolume", "FileSystem", Ogre::RGN_INTERNAL);
        resources.initialiseAllResourceGroups();
        Ogre::SceneManager *scene = root.createSceneManager();
        make_scene(scene);
        open_eye(scene);
    }

    /* GL3Plus asks GLX for a 3.0 core context and takes what the driver gives. Mesa gives its latest, 4.5, and with it
     * compute shaders. Where it is older than 4.3, hbil_gl_init says so, and --set stage=fragment still works. */
    void open_target(unsigned width, unsigned height, bool to_file)
    {
        Ogre::NameValuePairList options;
        root.loadPlugin(HBIL_OGRE_PLUGINS "/RenderSystem_GL3Plus");
        root.setRenderSystem(root.getRenderSystemByName("OpenGL 3+ Rendering Subsystem"));
        root.initialise(false);
        options["hidden"] = to_file ? "true" : "false";
        window = root.createRenderWindow("hbil-ogre", width, height, false, &options);
        target = window;
        if (!to_file) return;
        window->setAutoUpdated(false);
        Ogre::TexturePtr picture =
            Ogre::TextureManager::getSingleton().createManual("picture", Ogre::RGN_DEFAULT, Ogre::TEX_TYPE_2D, width,
                                                              height, 0, Ogre::PF_BYTE_RGBA, Ogre::TU_RENDERTARGET);
        target = picture->getBuffer()->getRenderTarget();
    }

    void open_eye(Ogre::SceneManager *scene)
    {
        Ogre::Camera *eye = scene->createCamera("eye");
        camera = scene->getRootSceneNode()->createChildSceneNode();
        camera->attachObject(eye);
        eye->setNearClipDistance(0.1f);
        eye->setFarClipDistance(50);
        eye->setFOVy(Ogre::Degree(40));
        eye->setAutoAspectRatio(true);
        Ogre::Viewport *viewport = target->addViewport(eye);
        Ogre::CompositorManager::getSingleton().addCompositor(viewport, "hbil");
        Ogre::CompositorManager::getSingleton().setCompositorEnabled(viewport, "hbil", true);
    }

    /* The camera swings in front of the room. */
    void draw(unsigned index)
    {
        const float angle = 0.2f * std::sin(0.02f * static_cast<float>(index));
        const Ogre::Vector3 middle(0, 1.15f, 0);
        camera->setPosition(middle + Ogre::Vector3(6.0f * std::sin(angle), 0.75f, 6.0f * std::cos(angle)));
        camera->lookAt(middle, Ogre::Node::TS_WORLD);
        root.renderOneFrame();
    }

    /* Through a temporary file beside it: the picture is there as a whole or not at all. */
    void write_png(const std::string &path)
    {
        const int width = static_cast<int>(target->getWidth()), height = static_cast<int>(target->getHeight());
        const std::string temporary = path + "." + std::to_string(getpid()) + ".tmp";
        Ogre::Image image(Ogre::PF_BYTE_RGB, target->getWidth(), target->getHeight());
        int size = 0;
        target->copyContentsToMemory(Ogre::Box(0, 0, target->getWidth(), target->getHeight()), image.getPixelBox());
        unsigned char *bytes = stbi_write_png_to_mem(image.getData(), 3 * width, width, height, 3, &size);
        std::FILE *file = std::fopen(temporary.c_str(), "wb");
        bool ok = file && bytes && std::fwrite(bytes, 1, static_cast<size_t>(size), file) == static_cast<size_t>(size);
        std::free(bytes);
        if (file && std::fclose(file) != 0) ok = false;
        struct stat there;
        if (stat(path.c_str(), &there) == 0 && !S_ISREG(there.st_mode)) ok = false, errno = EINVAL; // a device: not to be replaced
        if (ok && std::rename(temporary.c_str(), path.c_str()) == 0) return;
        const std::string why = std::strerror(errno);
        if (file) std::remove(temporary.c_str());
        throw Failure(FILES, path + ": cannot be written (" + why + "). Make its folder or choose another path");
    }
};

static void print_help()
{
    std::fputs(
        "usage: hbil-ogre [options]\n"
        "A room drawn by OGRE 1.12 and lit by hbil.h, in a window until that is closed, or into a file.\n\n"
        "  --preset NAME     where the config begins; default: balanced\n"
        "  --set NAME=VALUE  option of the config; may be repeated. Inputs, outputs and environment are set by the\n"
        "                    program\n"
        "  --size WxH        in pixels, default 640x360\n"
        "  --view V          composite (default); direct, the light without hbil's; ao; split, direct on the left and\n"
        "                    composite on the right\n"
        "  --png FILE        no window: write the last frame. Wants an X display all the same: xvfb-run -a hbil-ogre\n"
        "  --frames N        so many frames, then end; default: 8 with --png, else no end. The camera swings a little\n"
        "  --help\n\n"
        "exit: 0 done; 1 config refused; 2 usage; 3 the file cannot be written; 5 OGRE, display or driver is missing\n"
        "      or failed\n\n"
        "presets:\n", stdout);
    for (int32_t i = 0; hbil_preset_name(i); ++i)
        std::printf("  %-17s %s\n", hbil_preset_name(i), hbil_preset_meaning(i));
    std::puts("\noptions for --set: see hbil.h, or shadergen --help");
}

/* Whole number in [1, max] and nothing behind it. */
static unsigned read_number(const std::string &option, const std::string &text, long max)
{
    char *end;
    const long value = std::strtol(text.c_str(), &end, 10);
    if (text.empty() || *end || value < 1 || value > max)
        throw Failure(USAGE, option + ": must be whole and in [1, " + std::to_string(max) + "], not '" + text + "'");
    return static_cast<unsigned>(value);
}

static void read_argument(Arguments &a, const std::string &name, const std::string &value)
{
    if (name == "--preset") {
        a.preset = value;
    } else if (name == "--set") {
        a.sets.push_back(value);
    } else if (name == "--png") {
        a.png = value;
    } else if (name == "--frames") {
        a.frames = read_number(name, value, 1000000);
    } else if (name == "--size") {
        const size_t x = value.find('x');
        if (x == std::string::npos) throw Failure(USAGE, "--size: must be WxH, as in 640x360, not '" + value + "'");
        a.width = read_number(name, value.substr(0, x), 16384);
        a.height = read_number(name, value.substr(x + 1), 16384);
    } else if (name == "--view") {
        for (a.view = 0; a.view < 4 && value != views[a.view];) ++a.view;
        if (a.view == 4) throw Failure(USAGE, "--view: must be composite, direct, ao or split, not '" + value + "'");
    } else {
        throw Failure(USAGE, name + ": unknown; hbil-ogre --help lists all");
    }
}

static void run(const Arguments &arguments)
{
    const hbil_plan plan = make_plan(arguments);
    const bool to_file = !arguments.png.empty();
    const unsigned frames = arguments.frames ? arguments.frames : to_file ? 8 : 0;
    std::time_t shown = std::time(NULL);
    Closing closing;
    Engine engine;

    try {
        engine.open(arguments, plan);
        if (!to_file) {
            OgreBites::WindowEventUtilities::_addRenderWindow(engine.window);
            OgreBites::WindowEventUtilities::addWindowEventListener(engine.window, &closing);
        }
        for (unsigned i = 0; (!frames || i < frames) && !closing.asked; ++i) {
            engine.draw(i);
            if (!to_file) OgreBites::WindowEventUtilities::messagePump();
            if (!frames || std::time(NULL) - shown < 2) continue;
            shown = std::time(NULL);
            std::fprintf(stderr, "frame %u of %u\n", i + 1, frames);
        }
        if (to_file) engine.write_png(arguments.png);
    } catch (const Ogre::Exception &failure) { /* points into a plugin, which goes with the engine */
        throw Failure(BACKEND, failure.getDescription());
    }
}

int main(int argc, char **argv)
{
    Arguments arguments;
    int code = BACKEND;
    try {
        for (int i = 1; i < argc; ++i) {
            const std::string name = argv[i];
            if (name == "--help") return print_help(), DONE;
            if (i + 1 == argc || std::strncmp(argv[i + 1], "--", 2) == 0)
                throw Failure(USAGE, name + ": unknown, or without its value; hbil-ogre --help lists all");
            read_argument(arguments, name, argv[++i]);
        }
        run(arguments);
        return DONE;
    } catch (const Failure &failure) {
        code = failure.code;
        std::fprintf(stderr, "hbil-ogre: %s\n", failure.what());
    } catch (const std::exception &failure) {
        std::fprintf(stderr, "hbil-ogre: %s\n", failure.what());
    }
    return code;
}
