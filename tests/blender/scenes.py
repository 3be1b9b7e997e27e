"""scenes.py - saves the built-in scene of export_frame.py as perspective.blend and orthographic.blend, with settings
that are in the way of a clean G-buffer. Then sees what export_frame.py refuses.

  blender -b --python scenes.py -- FOLDER-OF-EXPORT_FRAME FOLDER

exit: 0 done; 1 something was not refused, or not by its exit code; 77 this Blender has no Cycles
"""
import contextlib
import io
import os
import sys

import bpy

source, folder = sys.argv[sys.argv.index('--') + 1:]
sys.path.insert(0, source)
sys.dont_write_bytecode = True
import export_frame

try:
    bpy.context.scene.render.engine = 'CYCLES'
except TypeError:
    sys.exit(77)
failed = 0


def refused(code, words, *arguments):
    """Run as `blender -b --python export_frame.py -- ARGUMENTS`: does it end with this code, and say this?"""
    global failed
    sys.argv[1:] = '--', *arguments
    message = io.StringIO()
    with contextlib.redirect_stderr(message):
        try:
            got = export_frame.main()
        except SystemExit as end:       # of argparse
            got = end.code
    right = got == code and words in message.getvalue()
    failed |= not right
    print('ok   ' if right else 'FAIL ', f'refused with {got}: {message.getvalue().strip().splitlines()[-1:]}')


refused(2, 'no scene', '--out', folder)
refused(2, 'as in 640x360', '--demo', '--out', folder, '--size', '640')
refused(2, 'as in 0:11', '--demo', '--out', folder, '--frames', '3:2')
refused(2, '--out', '--demo')
export_frame.make_demo()
scene = bpy.context.scene
camera, render, cycles = scene.camera, scene.render, scene.cycles
bpy.context.view_layer.name = 'Truth.Depth 1'     # dots, blanks, and the name of a pass
bpy.context.view_layer.use_pass_diffuse_indirect = True
bpy.context.view_layer.samples = 1
scene.view_layers.new('truth').use_pass_z = True
render.engine = 'BLENDER_EEVEE'
render.resolution_x, render.resolution_y, render.resolution_percentage = 384, 270, 50
render.pixel_aspect_y = 1.25
render.use_motion_blur = render.use_border = render.use_crop_to_border = render.use_multiview = True
render.border_max_x = render.border_max_y = .5
render.image_settings.file_format, render.filter_size = 'PNG', 3
scene.use_nodes = True                             # a compositor that gives nothing
scene.node_tree.nodes.clear()
scene.node_tree.nodes.new('CompositorNodeComposite')
cycles.filter_width, cycles.sample_clamp_direct, cycles.light_sampling_threshold, cycles.max_bounces = 5, .1, .5, 12
camera.scale = 2, 2, 2
camera.data.shift_x, camera.data.shift_y = .05, -.03
camera.data.clip_start, camera.data.clip_end = .01, 5000
camera.data.dof.use_dof, camera.data.dof.focus_distance, camera.data.dof.aperture_fstop = True, 1, .05
camera.data.ortho_scale = 6.2


def save(name):
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, name + '.blend'))


save('perspective')
camera.data.type = 'ORTHO'
save('orthographic')
refused(2, 'Leave one of them out', '--demo', '--out', folder)
refused(3, 'orthographic.blend', '--out', os.path.join(folder, 'orthographic.blend', 'sub'))
camera.data.type = 'PANO'
refused(4, 'of type PANO', '--out', folder)
camera.data.type, camera.scale.x = 'PERSP', -1
refused(4, 'mirrored', '--out', folder)
scene.camera = None
refused(4, 'no active camera', '--out', folder)
sys.exit(failed)
