# SPDX-License-Identifier: MIT
"""What genrender_maps.py should have seen, as text: camera and triangles of every frame, from Blender's evaluated meshes.

Run with the bpy package: python export_meshes.py FILE.blend WIDTH HEIGHT OUT.txt
"""

import os
import sys

import bpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../examples/blender"))
import genrender_maps  # noqa: E402


def corners_of(mesh, to_world):
    """A line a corner of every triangle: place in the world, UV, rest position."""
    uvs = mesh.uv_layers.active.data
    rest = mesh.attributes[genrender_maps.REST_ATTRIBUTE].data
    mesh.calc_loop_triangles()
    for triangle in mesh.loop_triangles:
        for corner, vertex in zip(triangle.loops, triangle.vertices):
            place = to_world @ mesh.vertices[vertex].co
            yield " ".join(f"{x:.9g}" for x in (*place, *uvs[corner].uv, *rest[vertex].vector))


def main(blend, width, height, out):
    bpy.ops.wm.open_mainfile(filepath=os.path.abspath(blend))
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    frames = range(scene.frame_start, scene.frame_end + 1, scene.frame_step)
    scene.frame_set(frames[0])
    changes = genrender_maps.Changes()
    objects = genrender_maps.surfaces_of(scene)
    genrender_maps.number_objects(objects, changes, [])
    genrender_maps.prepare_objects(scene, objects, changes, [])
    with open(out, "w", encoding="ascii") as file:
        print(len(frames), height, width, file=file)
        for frame in frames:
            scene.frame_set(frame)
            eye = genrender_maps.camera_at(scene)
            view = scene.camera.matrix_world.inverted()
            print(f"{eye['vertical_fov']:.9g}", *(f"{x:.9g}" for row in view for x in row), len(objects), file=file)
            depsgraph = bpy.context.evaluated_depsgraph_get()
            for o in objects:
                evaluated = o.evaluated_get(depsgraph)
                lines = list(corners_of(evaluated.to_mesh(), evaluated.matrix_world))
                print(o.pass_index, len(lines) // 3, file=file)
                print("\n".join(lines), file=file)
                evaluated.to_mesh_clear()


if __name__ == "__main__":
    main(sys.argv[-4], int(sys.argv[-3]), int(sys.argv[-2]), sys.argv[-1])
