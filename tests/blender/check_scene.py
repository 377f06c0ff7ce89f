# SPDX-License-Identifier: MIT
"""genrender_maps.py leaves a scene as it was, refuses in sentences, and works as an add-on.

Run with the bpy package: python check_scene.py FILE.blend FOLDER
"""

import json
import os
import sys

import bpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../examples/blender"))
import genrender_maps  # noqa: E402

checks = 0


def check(holds, text):
    global checks
    checks += 1
    if not holds:
        sys.exit(f"check_scene.py: {text}")


# What Blender itself keeps of a render: the picture, evaluated copies, and the colour space of a file format once chosen.
OF_RENDERING = {"depsgraph", "linear_colorspace_settings"}


def values_of(owner, skip=()):
    """Every property of a Blender structure that is no structure itself, and the names of those it refers to."""
    values = {}
    for p in owner.bl_rna.properties:
        if p.identifier in skip or p.identifier in OF_RENDERING or p.identifier == "rna_type":
            continue
        value = getattr(owner, p.identifier)
        if p.type in {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}:
            values[p.identifier] = (tuple(map(str, value)) if hasattr(value, "__len__") and not isinstance(value, str)
                                    else value)
        elif p.type == "POINTER":
            values[p.identifier] = getattr(value, "name", value is not None)
    return values


def snapshot():
    """All that write_maps could touch."""
    state = {"data": {kind: sorted(i.name for i in getattr(bpy.data, kind) if i.name != "Render Result")
                      for kind in ("objects", "meshes", "materials", "scenes", "cameras", "images", "node_groups")}}
    for scene in bpy.data.scenes:
        of_scene = state[scene.name] = {"scene": values_of(scene), "render": values_of(scene.render),
                                        "image": values_of(scene.render.image_settings),
                                        "cycles": values_of(scene.cycles),
                                        "markers": [(m.name, m.frame, m.camera and m.camera.name)
                                                    for m in scene.timeline_markers]}
        for layer in scene.view_layers:
            of_scene[layer.name] = (values_of(layer), values_of(layer.cycles),
                                    [(a.name, a.type) for a in layer.aovs])
    for o in bpy.data.objects:
        state[o.name] = values_of(o)
    for camera in bpy.data.cameras:
        state[camera.name] = (values_of(camera), values_of(camera.dof))
    for mesh in bpy.data.meshes:
        # Blender keeps internal attributes, with names that begin with a point
        state[mesh.name] = (values_of(mesh, skip={"is_editmode"}),
                            sorted(a.name for a in mesh.attributes if not a.name.startswith(".")),
                            [u.name for u in mesh.uv_layers])
    return state


def differences(before, after, where=""):
    """Where two states differ, as text."""
    if isinstance(before, dict) and isinstance(after, dict):
        return [d for key in sorted(set(before) | set(after), key=str)
                for d in differences(before.get(key), after.get(key), f"{where}/{key}")]
    if isinstance(before, (list, tuple)) and isinstance(after, (list, tuple)) and len(before) == len(after):
        return [d for i, pair in enumerate(zip(before, after)) for d in differences(*pair, f"{where}/{i}")]
    return [] if before == after else [f"{where} was {before} and is {after}"]


def refusal(scene, out, **options):
    """What write_maps says, once it is clear that it changed nothing."""
    before = snapshot()
    try:
        genrender_maps.write_maps(scene, out, **options)
    except genrender_maps.MapsError as error:
        check(not differences(before, snapshot()), f"a refusal changed the scene: {differences(before, snapshot())}")
        return str(error)
    return "nothing"


def second_layer(scene):
    """A second view layer, text, instances of a collection and of geometry nodes, and a marker that binds the camera."""
    text = bpy.data.objects.new("text", bpy.data.curves.new("text", "FONT"))
    text.data.body = "A"
    text.location = (-2, -2, 0.5)
    text.rotation_euler = (1.5, 0, 0)
    scene.collection.objects.link(text)
    hidden = bpy.data.collections.new("hidden")
    mesh = bpy.data.meshes.new("tetrahedron")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [], [(0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)])
    hidden.objects.link(bpy.data.objects.new("tetrahedron", mesh))
    instance = bpy.data.objects.new("instance", None)
    instance.instance_type, instance.instance_collection, instance.location = "COLLECTION", hidden, (-2.5, 0, 0)
    scene.collection.objects.link(instance)
    ball = bpy.data.objects.new("ball", bpy.data.objects["floor"].data.copy())
    group = bpy.data.node_groups.new("scatter", "GeometryNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    else:  # Blender 3
        group.outputs.new("NodeSocketGeometry", "Geometry")
    info = group.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = ball
    info.inputs["As Instance"].default_value = True
    group.links.new(info.outputs["Geometry"], group.nodes.new("NodeGroupOutput").inputs[0])
    carrier = bpy.data.objects.new("carrier", bpy.data.meshes.new("carrier"))
    carrier.location = (0, 3, 0)
    carrier.rotation_euler = (1.5, 0, 0)
    carrier.modifiers.new("scatter", "NODES").node_group = group
    scene.collection.objects.link(carrier)
    scene.view_layers.new("Second")
    scene.timeline_markers.new("cut", frame=2).camera = scene.camera


def main(blend, folder):
    bpy.ops.wm.open_mainfile(filepath=os.path.abspath(blend))
    scene = bpy.context.scene
    second_layer(scene)
    bpy.context.view_layer.objects.active = scene.objects["block"]
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.view_layer.update()

    before = snapshot()
    check(before["block"]["mode"] == "EDIT", "the block is not being edited")
    notes = genrender_maps.write_maps(scene, folder, start=2, end=6, step=2, size=(64, 48))
    changed = differences(before, snapshot())
    check(not changed, f"the scene is not as it was: {changed}")
    check(len(notes) == 2, notes)
    check(any(n.startswith("No UVs that span a texture come out of text ") for n in notes), f"text's UVs: {notes}")
    check(any("block" in n and "tetrahedron" in n for n in notes), f"new UVs are not said: {notes}")

    with open(os.path.join(folder, "scene.json"), encoding="utf-8") as file:
        told = json.load(file)
    check(sorted(os.listdir(folder)) == ["0002.exr", "0004.exr", "0006.exr", "scene.json"], os.listdir(folder))
    check((told["frames_per_second"], told["start"], told["end"], told["step"]) == (30, 2, 6, 2), "times are wrong")
    check([c["frame"] for c in told["camera"]["frames"]] == [2, 4, 6], "cameras are of other frames")
    check(told["camera"]["frames"][0]["camera_to_world"] != told["camera"]["frames"][1]["camera_to_world"],
          "the camera stands still")
    check(sorted(told["objects"].values()) == ["ball", "bending column", "block", "carrier", "floor", "tetrahedron", "text"],
          told["objects"])
    check(told["view_layers"] == ["ViewLayer", "Second"], told["view_layers"])

    # Another run in its place, of one view layer
    genrender_maps.write_maps(scene, folder, view_layer="Second", start=3, end=3, size=(64, 48))
    check(sorted(os.listdir(folder)) == ["0003.exr", "scene.json"], f"an earlier run left {os.listdir(folder)}")
    check(not differences(before, snapshot()), "the scene is not as it was after a second run")

    # Refusals
    check(refusal(scene, folder, camera="lens").startswith("--camera is lens, expected one of eye"), "camera")
    check(refusal(scene, folder, view_layer="Third") == "--view-layer is Third, expected one of ViewLayer, Second", "layer")
    check(refusal(scene, folder, start=5, end=4).startswith("There is no frame between"), "frames")
    with open(os.path.join(folder, "foreign.exr"), "w", encoding="ascii") as file:
        file.write("foreign")
    check("foreign.exr" in refusal(scene, folder, start=3, end=3, size=(64, 48)), "a foreign file is not refused")
    check(os.path.exists(os.path.join(folder, "0003.exr")), "a refusal removed a file")
    os.remove(os.path.join(folder, "foreign.exr"))

    # A failure in the middle
    def fail(done, count):
        raise KeyboardInterrupt

    try:
        genrender_maps.write_maps(scene, folder, size=(64, 48), progress=fail)
        check(False, "the failure is lost")
    except KeyboardInterrupt:
        check(not differences(before, snapshot()), "the scene is not as it was after a failure")

    # The add-on
    genrender_maps.register()
    scene.genrender_maps_folder = os.path.join(folder, "button")
    scene.frame_end = 2
    scene.render.resolution_percentage = 10
    before = snapshot()
    check(bpy.ops.genrender.write_maps() == {"FINISHED"}, "the button fails")
    check(not differences(before, snapshot()), f"the button changed {differences(before, snapshot())}")
    check(sorted(os.listdir(scene.genrender_maps_folder)) == ["0001.exr", "0002.exr", "scene.json"], "the button's files")
    genrender_maps.unregister()
    check(not hasattr(scene, "genrender_maps_folder"), "unregister leaves a property")
    print(f"check_scene.py: {checks} checks passed")


if __name__ == "__main__":
    main(sys.argv[-2], sys.argv[-1])
