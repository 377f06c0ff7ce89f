# SPDX-License-Identifier: MIT
"""Writes what generative_rendering --maps reads from a Blender scene: UV, depth, object index and rest position.

As a script, with Blender or with the bpy package of the Python index:
    blender -b shot.blend -P genrender_maps.py -- --out DIR
    python genrender_maps.py --blend shot.blend --out DIR
As an add-on (Preferences, Add-ons, Install from Disk): Render Properties, panel "Maps for genrender".

DIR gets one multilayer EXR file a frame, named by the frame's number, and scene.json. The scene is left as it was.
"""

import argparse
import json
import math
import os
import sys
import traceback

import bpy

bl_info = {
    "name": "Maps for genrender",
    "author": "the authors of genrender",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Maps for genrender",
    "description": "Writes UV, depth, object index and rest position as EXR files",
    "category": "Render",
}

REST = "Rest"  # the output variable: channels LAYER.Rest.R, G and B
REST_ATTRIBUTE = "genrender_rest"
KNOWN_ATTRIBUTE = "genrender_has_rest"  # 1 where there is a rest position; Cycles takes 0 for an attribute that is missing
UV_NAME = "genrender_uv"
SURFACES = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD"}
OWN_PASSES = {"use_pass_uv", "use_pass_z", "use_pass_object_index"}


class MapsError(Exception):
    """What keeps maps from being written, as a sentence."""


class Changes:
    """Changes to a scene that are taken back in reverse order."""

    def __init__(self):
        self._undo = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        failure = None
        for undo in reversed(self._undo):
            try:
                undo()
            except Exception as error:  # the others are to be taken back all the same
                failure = failure or error
        self._undo.clear()
        if failure is not None:
            raise failure

    def later(self, undo):
        """Calls `undo` at the end."""
        self._undo.append(undo)

    def set(self, owner, name, value):
        """Sets an attribute that exists; whether it is `value` now."""
        if not hasattr(owner, name):
            return False
        before = getattr(owner, name)
        if before == value:
            return True
        try:
            setattr(owner, name, value)
        except (AttributeError, TypeError):  # read-only here, or of linked data
            return False
        self._undo.append(lambda: setattr(owner, name, before))
        return True

    def keep_all(self, owner, first):
        """Remembers every property that can be written; those named `first` are put back before the others."""
        names = [p.identifier for p in owner.bl_rna.properties
                 if not p.is_readonly and p.type in {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}]
        names = [n for n in first if n in names] + [n for n in names if n not in first]
        values = []
        for name in names:
            value = getattr(owner, name)
            values.append((name, tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value))

        def undo():
            for name, value in values:
                try:
                    setattr(owner, name, value)
                except (AttributeError, TypeError):  # of a format that is not chosen
                    pass

        self._undo.append(undo)


# -- what objects get ------------------------------------------------------------------------------------------------------


def surfaces_of(scene):
    """The objects that may show a surface, by name: those of the scene and those that it shows as instances."""
    found = {}
    collections = []
    pending = list(scene.objects)
    while pending:
        o = pending.pop()
        if o.name_full in found:
            continue
        found[o.name_full] = o
        pending.extend(o.children)
        for instanced in instanced_by(o):
            if isinstance(instanced, bpy.types.Object):
                pending.append(instanced)
            elif instanced is not None and instanced not in collections:
                collections.append(instanced)
                pending.extend(instanced.all_objects)
    return [found[name] for name in sorted(found) if found[name].type in SURFACES]


def instanced_by(o):
    """The objects and collections that an object shows as instances."""
    if o.instance_type == "COLLECTION":
        yield o.instance_collection
    for system in o.particle_systems:
        yield system.settings.instance_object
        yield system.settings.instance_collection
    groups = []
    for modifier in o.modifiers:
        if modifier.type == "NODES":
            groups.append(modifier.node_group)
            for key in modifier.keys():
                if isinstance(modifier[key], (bpy.types.Object, bpy.types.Collection)):
                    yield modifier[key]
    for group in groups:  # grows
        for node in group.nodes if group is not None else ():
            inner = getattr(node, "node_tree", None)
            if inner is not None and inner not in groups:
                groups.append(inner)
            for socket in node.inputs:
                if socket.type in {"OBJECT", "COLLECTION"}:
                    yield socket.default_value


def number_objects(objects, changes, notes):
    """Gives each object a pass index of its own; names by index."""
    names = {}
    for index, o in enumerate(objects, 1):
        if not changes.set(o, "pass_index", index):
            notes.append(f"{o.name} cannot be given a pass index of its own.")
        names.setdefault(o.pass_index, o.name)
    return names


def meshes_of(objects):
    """The meshes of the objects, each once, with the first object that has it."""
    meshes = {}
    for o in objects:
        if o.type == "MESH" and o.data.name_full not in meshes:
            meshes[o.data.name_full] = (o.data, o)
    return list(meshes.values())


def add_rest_positions(mesh, scale, changes):
    """Adds the mesh's own positions, in the object's size, as an attribute that modifiers carry along, unless there is
    one of that name."""
    positions = [0.0] * (3 * len(mesh.vertices))
    mesh.vertices.foreach_get("co", positions)
    for axis in range(3):
        positions[axis::3] = [x * abs(scale[axis]) for x in positions[axis::3]]
    for name, kind, field, values in ((REST_ATTRIBUTE, "FLOAT_VECTOR", "vector", positions),
                                      (KNOWN_ATTRIBUTE, "FLOAT", "value", [1.0] * len(mesh.vertices))):
        if name in mesh.attributes:
            continue
        mesh.attributes.new(name, kind, "POINT").data.foreach_set(field, values)
        changes.later(lambda name=name: mesh.attributes.remove(mesh.attributes[name]))


def add_face_uvs(mesh, changes):
    """Lays every face of the mesh flat into a cell of its own, all at one scale."""
    charts = []
    largest = 0.0
    for face in mesh.polygons:
        points = [mesh.vertices[v].co for v in face.vertices]
        across = max((points[i] - points[i - 1] for i in range(len(points))), key=lambda edge: edge.length)
        x = across.normalized()
        y = face.normal.cross(x)
        flat = [(p.dot(x), p.dot(y)) for p in points]
        left, bottom = (min(p[axis] for p in flat) for axis in range(2))
        flat = [(p[0] - left, p[1] - bottom) for p in flat]
        largest = max(largest, max(max(p) for p in flat))
        charts.append((face.loop_start, flat))
    layer = mesh.uv_layers.new(name=UV_NAME, do_init=False)
    name = layer.name
    changes.later(lambda: mesh.uv_layers.remove(mesh.uv_layers[name]))
    columns = max(1, math.ceil(math.sqrt(len(charts))))
    inside = 0.9 / columns  # a twentieth of a cell between a face and its neighbours on each side
    coordinates = [0.0] * (2 * len(mesh.loops))
    for cell, (start, flat) in enumerate(charts):
        for corner, point in enumerate(flat):
            for axis, place in enumerate((cell % columns, cell // columns)):
                shift = (place + 0.05) / columns
                coordinates[2 * (start + corner) + axis] = shift + inside * point[axis] / max(largest, 1e-30)
    layer.data.foreach_set("uv", coordinates)


def prepare_objects(scene, objects, changes, notes):
    """Rest positions for all meshes, UVs for those that have none."""
    without_uvs = []
    for mesh, o in meshes_of(objects):
        if not mesh.vertices:
            continue
        try:
            add_rest_positions(mesh, o.matrix_world.to_scale(), changes)
            if not mesh.uv_layers and mesh.polygons:
                add_face_uvs(mesh, changes)
                without_uvs.append(o.name)
        except (AttributeError, RuntimeError, TypeError):  # of linked data
            notes.append(f"{o.name} comes from a library that cannot be changed: its rest positions are not written.")
    if without_uvs:
        notes.append(f"{len(without_uvs)} objects without UVs got a chart for every face while the maps were made: "
                     + ", ".join(without_uvs[:8]) + (", ..." if len(without_uvs) > 8 else "") + ".")


def note_missing_uvs(scene, objects, notes):
    """Says which objects show no UVs after all, as modifiers may drop them and make surfaces that have none."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    names = []
    for o in objects:
        if o.hide_render or o.name_full not in scene.objects:
            continue
        evaluated = o.evaluated_get(depsgraph)
        try:
            mesh = evaluated.to_mesh()
        except RuntimeError:
            continue
        if mesh is not None and len(mesh.polygons) > 0 and not spans_texture(mesh):
            names.append(o.name)
        evaluated.to_mesh_clear()
    if names:
        notes.append("No UVs that span a texture come out of " + ", ".join(names)
                     + " (of curves, text and modifiers that make surfaces): render with --canonical position.")


def spans_texture(mesh):
    """Whether a mesh has UVs that vary in both directions."""
    if not mesh.uv_layers:
        return False
    layer = next((layer for layer in mesh.uv_layers if layer.active_render), mesh.uv_layers[0])
    coordinates = [0.0] * (2 * len(mesh.loops))
    layer.data.foreach_get("uv", coordinates)
    return all(max(coordinates[axis::2]) - min(coordinates[axis::2]) > 1e-6 for axis in range(2))


def rest_material(changes):
    """A material that writes rest positions: the attribute, or generated coordinates where there is none."""
    material = bpy.data.materials.new("genrender_rest")
    changes.later(lambda: bpy.data.materials.remove(material))
    if bpy.app.version < (5, 0):  # later materials always have nodes
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    rest = tree.nodes.new("ShaderNodeAttribute")
    rest.attribute_name = REST_ATTRIBUTE
    is_known = tree.nodes.new("ShaderNodeAttribute")
    is_known.attribute_name = KNOWN_ATTRIBUTE
    generated = tree.nodes.new("ShaderNodeTexCoord")
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type = "VECTOR"
    mix.clamp_factor = True
    written = tree.nodes.new("ShaderNodeOutputAOV")
    if hasattr(written, "aov_name"):
        written.aov_name = REST
    else:
        written.name = REST
    shown = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    vectors = [s for s in mix.inputs if s.type == "VECTOR" and s.enabled]
    tree.links.new(is_known.outputs["Fac"], next(s for s in mix.inputs if s.type == "VALUE" and s.enabled))
    tree.links.new(generated.outputs["Generated"], vectors[0])
    tree.links.new(rest.outputs["Vector"], vectors[1])
    tree.links.new(next(s for s in mix.outputs if s.enabled), written.inputs["Color"])
    tree.links.new(shown.outputs["Emission"], output.inputs["Surface"])
    return material


def leave_edit_mode(changes):
    """Meshes cannot be changed while they are edited."""
    active = bpy.context.view_layer.objects.active
    if active is not None and active.mode != "OBJECT":
        mode = active.mode
        bpy.ops.object.mode_set(mode="OBJECT")
        changes.later(lambda: bpy.ops.object.mode_set(mode=mode))


# -- what the scene gets ---------------------------------------------------------------------------------------------------


def set_passes(layer, material, changes):
    """UV, depth, object index and the output variable of rest positions, and nothing else."""
    for p in layer.bl_rna.properties:
        if p.identifier.startswith("use_pass_") and not p.is_readonly:
            changes.set(layer, p.identifier, p.identifier in OWN_PASSES)
    cycles = getattr(layer, "cycles", None)
    for p in cycles.bl_rna.properties if cycles else ():
        if p.identifier in {"denoising_store_passes", "use_denoising", "pass_debug_sample_count"}:
            changes.set(cycles, p.identifier, False)
    changes.set(layer, "material_override", material)
    changes.set(layer, "samples", 0)
    variable = layer.aovs.get(REST)
    if variable is None:
        before = layer.active_aov_index
        variable = layer.aovs.add()
        variable.name = REST

        def undo():
            if hasattr(layer.aovs, "remove"):
                layer.aovs.remove(layer.aovs[REST])
            else:  # Blender 3
                layer.active_aov_index = layer.aovs.find(REST)
                with bpy.context.temp_override(view_layer=layer):
                    bpy.ops.scene.view_layer_remove_aov()
            layer.active_aov_index = before

        changes.later(undo)
    changes.set(variable, "type", "COLOR")


def set_scene(scene, camera, view_layer, size, changes):
    """One sharp sample a pixel, without what a camera or a compositor adds."""
    render = scene.render
    changes.keep_all(render.image_settings, ["media_type", "file_format", "color_mode", "color_depth"])
    changes.set(render, "engine", "CYCLES")
    for name, value in (("use_motion_blur", False), ("use_compositing", False), ("use_sequencer", False),
                        ("use_border", False), ("use_crop_to_border", False), ("use_multiview", False),
                        ("use_file_extension", True), ("use_overwrite", True), ("use_placeholder", False),
                        ("use_single_layer", False), ("use_freestyle", False), ("use_stamp", False)):
        changes.set(render, name, value)
    before_path = render.filepath
    changes.later(lambda: setattr(render, "filepath", before_path))
    if size is not None:
        for name, value in (("resolution_x", size[0]), ("resolution_y", size[1]), ("resolution_percentage", 100),
                            ("pixel_aspect_x", 1.0), ("pixel_aspect_y", 1.0)):
            changes.set(render, name, value)
    for name, value in (("samples", 1), ("use_adaptive_sampling", False), ("use_denoising", False),
                        ("pixel_filter_type", "BLACKMAN_HARRIS"), ("filter_width", 0.01), ("max_bounces", 0),
                        ("use_auto_tile", False), ("film_exposure", 1.0), ("time_limit", 0.0)):
        changes.set(scene.cycles, name, value)

    if camera:
        if camera not in scene.objects or scene.objects[camera].type != "CAMERA":
            raise MapsError(f"--camera is {camera}, expected one of "
                            + (", ".join(o.name for o in scene.objects if o.type == "CAMERA") or "no camera at all"))
        for marker in scene.timeline_markers:  # which would change the camera
            changes.set(marker, "camera", None)
        changes.set(scene, "camera", scene.objects[camera])
    if scene.camera is None and not any(m.camera for m in scene.timeline_markers):
        raise MapsError("The scene has no active camera, expected one: set it, or name one by --camera")
    for data in {o.data for o in scene.objects if o.type == "CAMERA"}:
        changes.set(data.dof, "use_dof", False)

    if view_layer and view_layer not in scene.view_layers:
        raise MapsError(f"--view-layer is {view_layer}, expected one of "
                        + ", ".join(layer.name for layer in scene.view_layers))
    for layer in scene.view_layers:
        if view_layer:
            changes.set(layer, "use", layer.name == view_layer)
    used = [layer for layer in scene.view_layers if layer.use]
    if not used:
        raise MapsError("No view layer of the scene is used for rendering, expected one")
    material = rest_material(changes)
    for layer in used:
        set_passes(layer, material, changes)

    settings = render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    settings.exr_codec = "ZIP"
    return used


def camera_at(scene):
    """The camera of the current frame: its place and how it projects, in Blender's axes (z up)."""
    render = scene.render
    eye = scene.camera.evaluated_get(bpy.context.evaluated_depsgraph_get())
    scale = render.resolution_percentage / 100
    projection = scene.camera.calc_matrix_camera(
        bpy.context.evaluated_depsgraph_get(), x=int(render.resolution_x * scale), y=int(render.resolution_y * scale),
        scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y)
    is_perspective = scene.camera.data.type == "PERSP"
    return {
        "frame": scene.frame_current,
        "camera": scene.camera.name,
        "camera_to_world": [list(row) for row in eye.matrix_world],
        "projection": [list(row) for row in projection] if scene.camera.data.type != "PANO" else None,
        "vertical_fov": 2 * math.atan(1 / projection[1][1]) if is_perspective else None,
    }


def make_room(folder, frames):
    """Makes the folder, and removes what an earlier run wrote there. Refuses a folder with other EXR files."""
    os.makedirs(folder, exist_ok=True)
    list_path = os.path.join(folder, "scene.json")
    earlier = []
    if os.path.exists(list_path):
        try:
            with open(list_path, encoding="utf-8") as file:
                earlier = list(json.load(file).get("files", []))
        except (ValueError, AttributeError):
            raise MapsError(f"{list_path} is no file that this script wrote, expected an empty folder") from None
    known = {f"{frame:04d}.exr" for frame in frames}.union(earlier)
    found = sorted(name for name in os.listdir(folder) if name.lower().endswith(".exr"))
    foreign = [name for name in found if name not in known]
    if foreign:
        raise MapsError(f"{folder} holds {foreign[0]}, which would be read as a frame; expected an empty folder")
    for name in found:
        os.remove(os.path.join(folder, name))
    if earlier:
        os.remove(list_path)


def write_maps(scene, out, camera=None, view_layer=None, start=None, end=None, step=None, size=None, progress=None):
    """Renders the maps of `scene` into the folder `out`; notes as sentences. Raises MapsError. `size` is (width,
    height); what is None is the scene's. Whatever happens, the scene is as it was afterwards."""
    frames = list(range(scene.frame_start if start is None else start, (scene.frame_end if end is None else end) + 1,
                        scene.frame_step if step is None else step))
    if not frames:
        raise MapsError("There is no frame between --start and --end, expected one")
    if frames[0] < 0:
        raise MapsError(f"The first frame is {frames[0]}, expected 0 or more: files are named by numbers")
    out = os.path.abspath(out)
    notes = []
    with Changes() as changes:
        before = (scene.frame_current, scene.frame_subframe)
        changes.later(lambda: scene.frame_set(before[0], subframe=before[1]))
        if scene.render.engine != "CYCLES" and "CYCLES" not in engines():
            raise MapsError("Cycles is not there, expected Blender's add-on of that name to be enabled")
        leave_edit_mode(changes)
        used = set_scene(scene, camera, view_layer, size, changes)
        make_room(out, frames)
        scene.frame_set(frames[0])
        objects = surfaces_of(scene)
        names = number_objects(objects, changes, notes)
        prepare_objects(scene, objects, changes, notes)
        scene.frame_set(frames[0])
        note_missing_uvs(scene, objects, notes)
        cameras = []
        for done, frame in enumerate(frames):
            if progress:
                progress(done, len(frames))
            scene.frame_set(frame)
            if scene.camera is None:
                raise MapsError(f"Frame {frame} has no camera, expected one")
            cameras.append(camera_at(scene))
            scene.render.filepath = os.path.join(out, f"{frame:04d}.exr")
            bpy.ops.render.render(write_still=True, scene=scene.name)
            if not os.path.exists(scene.render.filepath):
                raise MapsError(f"{scene.render.filepath} was not written, expected room on the disk")
        if any(c["vertical_fov"] is None for c in cameras):
            notes.append("The camera is not a perspective one; its maps are as good as any.")
        description = {
            "blender": bpy.app.version_string,
            "frames_per_second": scene.render.fps / scene.render.fps_base,
            "start": frames[0],
            "end": frames[-1],
            "step": frames[1] - frames[0] if len(frames) > 1 else 1,
            "camera": {"name": cameras[0]["camera"], "frames": cameras},
            "view_layers": [layer.name for layer in used],
            "objects": {str(index): name for index, name in sorted(names.items())},
            "files": [f"{frame:04d}.exr" for frame in frames],
            "notes": notes,
        }
    with open(os.path.join(out, "scene.json"), "w", encoding="utf-8") as file:
        file.write(text_of(description) + "\n")
    return notes


def text_of(value, depth=3):
    """JSON with a line for every entry down to a depth."""
    if depth == 0 or not value or not isinstance(value, (dict, list)):
        return json.dumps(value)
    if isinstance(value, list):
        return json.dumps(value) if depth < 2 and not isinstance(value[0], dict) else (
            "[\n" + ",\n".join(" " + text_of(entry, 0) for entry in value) + "\n]")
    return "{\n" + ",\n".join(f"{json.dumps(key)}: {text_of(entry, depth - 1)}" for key, entry in value.items()) + "\n}"


def engines():
    """The names of the render engines that can be chosen, Cycles enabled where it is installed."""
    import addon_utils
    if not hasattr(bpy.types.Scene, "cycles"):
        addon_utils.enable("cycles")
    return {"CYCLES"} if hasattr(bpy.types.Scene, "cycles") else set()


# -- the add-on ------------------------------------------------------------------------------------------------------------


class GENRENDER_OT_write_maps(bpy.types.Operator):
    """Renders UV, depth, object index and rest position of all frames, and leaves the scene as it was"""

    bl_idname = "genrender.write_maps"
    bl_label = "Write Maps"

    def execute(self, context):
        scene = context.scene
        manager = context.window_manager
        manager.progress_begin(0, 1000)
        try:
            notes = write_maps(scene, bpy.path.abspath(scene.genrender_maps_folder),
                               progress=lambda done, count: manager.progress_update(1000 * done // count))
        except MapsError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            manager.progress_end()
        for note in notes:
            self.report({"INFO"}, note)
        self.report({"INFO"}, "Maps are in " + bpy.path.abspath(scene.genrender_maps_folder))
        return {"FINISHED"}


class GENRENDER_PT_maps(bpy.types.Panel):
    bl_label = "Maps for genrender"
    bl_idname = "GENRENDER_PT_maps"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        self.layout.prop(context.scene, "genrender_maps_folder")
        self.layout.operator(GENRENDER_OT_write_maps.bl_idname, icon="RENDER_ANIMATION")


def register():
    bpy.types.Scene.genrender_maps_folder = bpy.props.StringProperty(
        name="Folder", description="Where the maps are written", default="//maps/", subtype="DIR_PATH")
    bpy.utils.register_class(GENRENDER_OT_write_maps)
    bpy.utils.register_class(GENRENDER_PT_maps)


def unregister():
    bpy.utils.unregister_class(GENRENDER_PT_maps)
    bpy.utils.unregister_class(GENRENDER_OT_write_maps)
    del bpy.types.Scene.genrender_maps_folder


# -- the script ------------------------------------------------------------------------------------------------------------


def size_of(text):
    """(width, height) of a text such as 1280x720."""
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit() and 4 <= int(width) <= 65536 and 4 <= int(height) <= 65536):
        raise argparse.ArgumentTypeError(f"is {text}, expected WIDTHxHEIGHT in pixels, such as 1280x720")
    return int(width), int(height)


def step_of(text):
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"is {text}, expected 1 or more")
    return int(text)


def main(arguments):
    parser = argparse.ArgumentParser(prog="genrender_maps.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blend", metavar="FILE", help="scene to open (the one that Blender has open)")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for EXR files and scene.json")
    parser.add_argument("--camera", metavar="NAME", help="camera to look through (the scene's)")
    parser.add_argument("--view-layer", metavar="NAME", help="view layer to render (all that are used)")
    parser.add_argument("--start", type=int, metavar="N", help="first frame (the scene's)")
    parser.add_argument("--end", type=int, metavar="N", help="last frame (the scene's)")
    parser.add_argument("--step", type=step_of, metavar="N", help="every so many frames (the scene's)")
    parser.add_argument("--size", type=size_of, metavar="WxH", help="pixels of a map (the scene's)")
    options = parser.parse_args(arguments)
    try:
        if options.blend:
            if not os.path.exists(options.blend):
                raise MapsError(f"--blend is {options.blend}, expected a file")
            bpy.ops.wm.open_mainfile(filepath=os.path.abspath(options.blend))
        notes = write_maps(bpy.context.scene, options.out, options.camera, options.view_layer, options.start, options.end,
                           options.step, options.size)
    except (MapsError, RuntimeError, OSError) as error:
        print(f"genrender_maps.py: {error}", file=sys.stderr)
        return 1
    except Exception:  # Blender itself would go on and end with 0
        traceback.print_exc()
        return 1
    for note in notes:
        print(note)
    print(f"Maps are in {options.out}")
    return 0


if __name__ == "__main__":
    is_own_process = os.path.basename(sys.argv[0]) == os.path.basename(__file__)
    if "--" in sys.argv:
        sys.exit(main(sys.argv[sys.argv.index("--") + 1:]))
    elif is_own_process:
        sys.exit(main(sys.argv[1:]))
    elif bpy.app.background:
        sys.exit(main([]))
    else:  # run from Blender's text editor
        register()
