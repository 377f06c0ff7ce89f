# SPDX-License-Identifier: MIT
"""A small rigged scene for the check of genrender_maps.py: a column that an armature bends, a block without UVs before it
that turns, a floor, a camera that moves, and settings that maps must not have.

Run with the bpy package: python make_scene.py FILE.blend
"""

import math
import sys

import bpy


def column():
    """A prism of 16 sides with 12 rings, UVs around and along it."""
    sides, rings = 16, 12
    vertices = [(0.5 * math.cos(2 * math.pi * s / sides), 0.5 * math.sin(2 * math.pi * s / sides), 3 * r / rings)
                for r in range(rings + 1) for s in range(sides)]
    faces = [(r * sides + s, r * sides + (s + 1) % sides, (r + 1) * sides + (s + 1) % sides, (r + 1) * sides + s)
             for r in range(rings) for s in range(sides)]
    mesh = bpy.data.meshes.new("column")
    mesh.from_pydata(vertices, [], faces)
    layer = mesh.uv_layers.new(name="around")
    for face, corners in enumerate(mesh.polygons):
        r, s = divmod(face, sides)
        for corner, (u, v) in zip(corners.loop_indices, ((s, r), (s + 1, r), (s + 1, r + 1), (s, r + 1))):
            layer.data[corner].uv = (u / sides, v / rings)
    return mesh


def add(name, data, location=(0, 0, 0)):
    o = bpy.data.objects.new(name, data)
    o.location = location
    bpy.context.scene.collection.objects.link(o)
    return o


def main(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene

    # The column and its two bones
    rig = add("rig", bpy.data.armatures.new("rig"))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    lower = rig.data.edit_bones.new("lower")
    lower.head, lower.tail = (0, 0, 0), (0, 0, 1.5)
    upper = rig.data.edit_bones.new("upper")
    upper.head, upper.tail, upper.parent = (0, 0, 1.5), (0, 0, 3), lower
    bpy.ops.object.mode_set(mode="OBJECT")
    bending = add("bending column", column())
    bending.scale = (1.2, 1.2, 1)
    for bone in ("lower", "upper"):
        group = bending.vertex_groups.new(name=bone)
        for vertex in bending.data.vertices:
            upper_share = min(1, max(0, (vertex.co.z - 1) / 1))
            group.add([vertex.index], upper_share if bone == "upper" else 1 - upper_share, "REPLACE")
    bending.modifiers.new("rig", "ARMATURE").object = rig
    turned = rig.pose.bones["upper"]
    turned.rotation_mode = "XYZ"
    for frame, angle in ((1, 0), (8, 70)):
        turned.rotation_euler = (math.radians(angle), 0, 0)
        turned.keyframe_insert("rotation_euler", frame=frame)

    # A block without UVs, and a floor whose UVs run over the whole texture several times
    bpy.ops.mesh.primitive_cube_add(size=0.9, location=(1.4, -0.9, 0.6))
    block = bpy.context.object
    block.name = "block"
    while block.data.uv_layers:
        block.data.uv_layers.remove(block.data.uv_layers[0])
    for frame, angle in ((1, 0), (8, 100)):
        block.rotation_euler = (0.2, 0.1, math.radians(angle))
        block.keyframe_insert("rotation_euler", frame=frame)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=7)
    bpy.context.object.name = "floor"
    bpy.context.object.pass_index = 7

    # The eye
    eye = bpy.data.cameras.new("eye")
    eye.lens = 42
    eye.dof.use_dof = True
    eye.dof.aperture_fstop = 0.5
    camera = add("eye", eye)
    camera.rotation_euler = (math.radians(72), 0, math.radians(12))
    for frame, x in ((1, 1.6), (8, 2.4)):
        camera.location = (x, -7.4, 3.6)
        camera.keyframe_insert("location", frame=frame)
    scene.camera = camera

    # What an artist may have set, and maps must not have
    scene.render.engine = "BLENDER_EEVEE_NEXT" if (4, 2) <= bpy.app.version[:2] < (5, 0) else "BLENDER_EEVEE"
    scene.render.use_motion_blur = True
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 384, 216, 50
    scene.render.fps = 30
    scene.frame_start, scene.frame_end, scene.frame_step = 1, 8, 1
    scene.frame_current = 5
    scene.render.filepath = "//pictures/"
    bpy.ops.wm.save_as_mainfile(filepath=path, compress=True)


if __name__ == "__main__":
    main(sys.argv[-1])
