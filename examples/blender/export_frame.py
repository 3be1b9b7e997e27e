"""export_frame.py - writes frames of a Blender scene as hbil-frame reads them: G-buffer and direct light in a
multilayer EXR, the camera as JSON. Rendered by Cycles on the CPU, every sample at the pixel's centre. Never saves the
.blend.

  blender -b FILE.blend --python export_frame.py -- --out DIR [--frames A:B] [--samples N] [--size WxH]
  blender -b --python export_frame.py -- --demo --out DIR

exit: 0 done; 2 usage; 3 a file cannot be written; 4 the scene has no camera that fits; 5 no Cycles, or rendering failed
"""
import argparse
import json
import math
import os
import re
import sys
import traceback

import bpy
import bmesh
from mathutils import Matrix, Vector

DONE, FILES, MISFIT, RENDER = 0, 3, 4, 5     # 2, usage: argparse's own
USAGE_LINES = '''blender -b FILE.blend --python export_frame.py -- --out DIR [options]
       blender -b --python export_frame.py -- --demo --out DIR [options]'''


class Fault(Exception):
    """A message for the user, and the exit code."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


# ---- command line ----------------------------------------------------------------------------------------------------

def size(text):
    match = re.fullmatch(r'(\d{1,5})x(\d{1,5})', text)
    if not match or not all(4 <= int(side) <= 16384 for side in match.groups()):
        raise argparse.ArgumentTypeError(f'{text}: must be WxH, each in [4, 16384], as in 640x360')
    return tuple(int(side) for side in match.groups())


def span(text):
    match = re.fullmatch(r'(\d{1,5}):(\d{1,5})', text)
    if not match or int(match[1]) > int(match[2]):
        raise argparse.ArgumentTypeError(f'{text}: must be A:B with whole numbers 0 <= A <= B <= 99999, as in 0:11')
    return int(match[1]), int(match[2])


def positive(text):
    if not re.fullmatch(r'\d{1,6}', text) or int(text) < 1:
        raise argparse.ArgumentTypeError(f'{text}: must be a whole number in [1, 999999]')
    return int(text)


def read_arguments():
    given = sys.argv[sys.argv.index('--') + 1:] if '--' in sys.argv else []
    parser = argparse.ArgumentParser(
        prog='export_frame', usage=USAGE_LINES, allow_abbrev=False,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description='Writes DIR/frame-NNN.exr and DIR/camera-NNN.json for hbil-frame. NNN: the number of the frame.',
        epilog=__doc__[__doc__.index('exit:'):])
    parser.add_argument('--out', metavar='DIR', required=True, help='made if need be')
    parser.add_argument('--frames', metavar='A:B', type=span, help='every frame from A to B; default: the current one')
    parser.add_argument('--samples', metavar='N', type=positive, default=64, help='per pixel; default 64')
    parser.add_argument('--size', metavar='WxH', type=size, help='in pixels; default: what the scene says')
    parser.add_argument('--no-world', action='store_true',
                        help="leave the world's light out of the direct light, to add it by hbil-frame --env")
    parser.add_argument('--truth', action='store_true',
                        help='path-traced ambient occlusion and near light, too; wants some hundred samples')
    parser.add_argument('--demo', action='store_true',
                        help='a built-in scene instead of FILE.blend; frames 0 to 10 move')
    args = parser.parse_args(given)
    if args.demo and bpy.data.filepath:
        parser.error(f'--demo: there is {bpy.data.filepath} already. Leave one of them out')
    if not args.demo and not bpy.data.filepath:
        parser.error('no scene: name FILE.blend in front of --python, or add --demo')
    return args


# ---- the built-in scene ----------------------------------------------------------------------------------------------

def diffuse(name, colour):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    shader = nodes.new('ShaderNodeBsdfDiffuse')
    shader.inputs['Color'].default_value = (*colour, 1)
    links.new(shader.outputs[0], nodes.new('ShaderNodeOutputMaterial').inputs['Surface'])
    return material


def emissive(name, radiance):
    material = diffuse(name, (0, 0, 0))
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = nodes.new('ShaderNodeEmission')
    shader.inputs['Color'].default_value = (*radiance, 1)
    links.new(shader.outputs[0], next(n for n in nodes if n.type == 'OUTPUT_MATERIAL').inputs['Surface'])
    return material


def add_mesh(name, mesh, material):
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_faces(name, corners, faces, material):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    return add_mesh(name, mesh, material)


def add_box(name, centre, sides, turn, material):
    """Its origin is the middle of its base."""
    x, y, z = (side / 2 for side in sides)
    corners = [(sx * x, sy * y, z + sz * z) for sz in (-1, 1) for sy in (-1, 1) for sx in (-1, 1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    box = add_faces(name, corners, faces, material)
    box.location = (*centre, 0)
    box.rotation_euler.z = math.radians(turn)
    return box


def add_sphere(name, centre, radius, material):
    mesh, shape = bpy.data.meshes.new(name), bmesh.new()
    bmesh.ops.create_uvsphere(shape, u_segments=96, v_segments=48, radius=radius)
    for face in shape.faces:
        face.smooth = True
    shape.to_mesh(mesh)
    shape.free()
    add_mesh(name, mesh, material).location = centre


def look(camera, eye, target):
    camera.location = eye
    camera.rotation_euler = (target - eye).to_track_quat('-Z', 'Y').to_euler()


def make_demo():
    """A corner of floor z = 0 and walls x = 0, y = 0, in metres; tests/blender/check.c knows it, too. The world is
    black."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new('black')
    scene.world.color = (0, 0, 0)

    white, red = diffuse('white', (.75, .75, .72)), diffuse('red', (.65, .07, .05))
    add_faces('floor', [(0, -6, 0), (6, -6, 0), (6, 0, 0), (0, 0, 0)], [(0, 1, 2, 3)], white)
    add_faces('back', [(0, 0, 0), (6, 0, 0), (6, 0, 2.2), (0, 0, 2.2)], [(0, 1, 2, 3)], white)
    add_faces('left', [(0, -6, 0), (0, 0, 0), (0, 0, 2.2), (0, -6, 2.2)], [(0, 1, 2, 3)], red)
    add_faces('panel', [(3.2, -.02, 1.1), (4.6, -.02, 1.1), (4.6, -.02, 1.8), (3.2, -.02, 1.8)], [(0, 1, 2, 3)],
              emissive('glow', (6, 4.2, 2.4)))
    add_box('tall', (1.1, -1.2), (.9, .9, 1.9), 18, diffuse('green', (.12, .5, .14)))
    add_box('low', (2.6, -.9), (1.2, .8, .6), -12, diffuse('yellow', (.75, .55, .08)))
    slider = add_box('slider', (1.0, -3.3), (.7, .7, .7), 30, diffuse('blue', (.1, .2, .7)))
    add_sphere('ball', (2.5, -2.2, .5), .5, white)
    add_sphere('marble', (3.6, -1.6, .3), .3, diffuse('orange', (.8, .3, .05)))

    sun = bpy.data.objects.new('sun', bpy.data.lights.new('sun', 'SUN'))
    sun.data.energy = 3                # W/m2
    sun.data.angle = math.radians(2)
    sun.rotation_euler = Vector((-.5, .3, -.9)).to_track_quat('-Z', 'Y').to_euler()
    camera = bpy.data.objects.new('camera', bpy.data.cameras.new('camera'))
    camera.data.angle = math.radians(60)
    for thing in sun, camera:
        scene.collection.objects.link(thing)
    scene.camera = camera
    eyes, targets = (Vector((5.4, -5.8, 2.3)), Vector((5, -6, 2))), (Vector((1.9, -1.5, .75)), Vector((2.2, -1.3, .7)))
    for frame in range(11):             # a key each: then no interpolation matters
        look(camera, eyes[0].lerp(eyes[1], frame / 10), targets[0].lerp(targets[1], frame / 10))
        slider.location.x = 1 + .06 * frame
        for thing in camera, slider:
            thing.keyframe_insert('location', frame=frame)
            thing.keyframe_insert('rotation_euler', frame=frame)
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 960, 540, 100
    scene.frame_set(0)


# ---- settings --------------------------------------------------------------------------------------------------------

def set_layer(scene, layer, truth):
    for other in scene.view_layers:
        other.use = other == layer
        if other != layer and other.name == 'truth':
            other.name = 'other'
    layer.samples = 0                   # no number of its own
    for name in 'z', 'normal', 'diffuse_color', 'diffuse_direct', 'emit', 'vector':
        setattr(layer, 'use_pass_' + name, True)
    layer.use_pass_diffuse_indirect = layer.use_pass_ambient_occlusion = truth
    if truth:                           # hbil-frame takes these two for truth in a layer of this name only
        layer.name = 'truth'


def set_scene(scene, args):
    render = scene.render
    try:
        render.engine = 'CYCLES'
    except TypeError:
        raise Fault(RENDER, 'this Blender has no Cycles. Switch its add-on "Cycles Render Engine" on, or take another '
                    'build')
    # What blurs the G-buffer or spreads it over other pixels is off.
    render.use_motion_blur = render.use_border = render.use_multiview = render.use_freestyle = False
    render.use_compositing = render.use_sequencer = False
    image = render.image_settings
    if hasattr(image, 'media_type'):    # Blender 5
        image.media_type = 'MULTI_LAYER_IMAGE'
    image.file_format, image.color_depth, image.exr_codec = 'OPEN_EXR_MULTILAYER', '32', 'ZIP'
    if hasattr(image, 'use_exr_interleave'):
        image.use_exr_interleave = True # all passes in one part of the file
    if args.size:
        render.resolution_x, render.resolution_y = args.size
        render.resolution_percentage = 100
    cycles = scene.cycles
    cycles.device = 'CPU'
    cycles.samples = args.samples
    cycles.time_limit = 0
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_fast_gi = False
    cycles.pixel_filter_type = 'BLACKMAN_HARRIS'
    cycles.filter_width = 0.01          # pixels: the least. All samples at the centre, where depth and normal are, too
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.max_bounces = 1 if args.truth else 0
    if scene.world:
        scene.world.light_settings.distance = 1e6   # m, of ambient occlusion
        if args.no_world:
            scene.world.cycles_visibility.diffuse = False


# ---- camera ----------------------------------------------------------------------------------------------------------

def pixels(render):
    sides = render.resolution_x, render.resolution_y
    return tuple(max(int(side * render.resolution_percentage / 100), 1) for side in sides)


def describe_camera(scene, graph):
    """Matrices as rows, for column vectors; OpenGL clip. A scaled camera sees what an unscaled one does."""
    if not scene.camera or scene.camera.type != 'CAMERA':
        raise Fault(MISFIT, 'the scene has no active camera. Set one under Scene Properties > Camera')
    camera = scene.camera.evaluated_get(graph)
    lens, render = camera.data, scene.render
    if lens.type not in ('PERSP', 'ORTHO'):
        raise Fault(MISFIT, f'camera {camera.name} is of type {lens.type}. Make it Perspective or Orthographic')
    world = camera.matrix_world.normalized()
    turn = world.to_3x3()
    skew = turn @ turn.transposed() - Matrix.Identity(3)
    if turn.determinant() < 0 or max(abs(x) for row in skew for x in row) > 1e-5:
        raise Fault(MISFIT, f'camera {camera.name} is mirrored or sheared, by itself or a parent. Apply its scale')
    width, height = pixels(render)
    rows = [list(row) for row in camera.calc_matrix_camera(graph, x=width, y=height, scale_x=render.pixel_aspect_x,
                                                           scale_y=render.pixel_aspect_y)]
    near, far = lens.clip_start, lens.clip_end
    # the depth row again, in double: floats of Blender lose a distant far plane
    rows[2] = [0, 0, -2 / (far - near), -(far + near) / (far - near)] if lens.type == 'ORTHO' else \
              [0, 0, -(far + near) / (far - near), -2 * far * near / (far - near)]
    return {'width': width, 'height': height, 'near': near, 'far': far, 'projection_rows': rows,
            'view_rows': [list(row) for row in world.inverted()]}


# ---- frames ----------------------------------------------------------------------------------------------------------

def export(scene, number, folder):
    exr, text = (os.path.join(folder, name) for name in (f'frame-{number:03d}.exr', f'camera-{number:03d}.json'))
    temp = os.path.join(folder, f'.{number:03d}-{os.getpid()}')
    scene.frame_set(number)
    camera = describe_camera(scene, bpy.context.evaluated_depsgraph_get())
    scene.camera.data.dof.use_dof = False
    scene.render.filepath = temp + '.exr'
    try:
        bpy.ops.render.render(write_still=True)
        os.replace(temp + '.exr', exr)
        with open(temp + '.json', 'w', encoding='ascii') as file:
            lines = [f' {json.dumps(key)}: {json.dumps(value)}' for key, value in camera.items()]
            file.write('{\n' + ',\n'.join(lines) + '\n}\n')
        os.replace(temp + '.json', text)
    except RuntimeError as error:
        raise Fault(RENDER, f'frame {number} was not rendered: {str(error).strip()}')
    finally:
        for end in '.exr', '.json':
            if os.path.exists(temp + end):
                os.remove(temp + end)
    print(f'export_frame: {exr}, {text}', file=sys.stderr, flush=True)


def main():
    args = read_arguments()
    try:
        if args.demo:
            make_demo()
        scene, layer, folder = bpy.context.scene, bpy.context.view_layer, os.path.abspath(args.out)
        os.makedirs(folder, exist_ok=True)
        set_scene(scene, args)
        set_layer(scene, layer, args.truth)
        first, last = args.frames or (scene.frame_current, scene.frame_current)
        for number in range(first, last + 1):
            export(scene, number, folder)
    except Fault as fault:
        print(f'export_frame: {fault}', file=sys.stderr)
        return fault.code
    except OSError as error:
        print(f'export_frame: {error}. Choose a folder that can be written, with room in it', file=sys.stderr)
        return FILES
    except Exception:                   # a Blender with another API: it would end with 0 itself
        traceback.print_exc()
        return RENDER
    return DONE


if __name__ == '__main__':
    sys.exit(main())
