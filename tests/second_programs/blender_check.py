"""Opens a two-person .glb and its BVH pair in Blender and says where the joints stand. Not a test: run by hand.

    pip install bpy==5.0.1                          # Python 3.11, in an environment of its own
    python tests/second_programs/blender_check.py MOTION.glb MOTION_a.bvh MOTION_b.bvh --usd MOTION.usda --out x.png

All formats are imported with Blender's defaults. Prints one JSON object: the armatures, the frames, the
largest distance in metres between the joints of the formats over all frames, and the lowest point of
each body; with ``--out`` it also renders the bodies over the BVH's bones.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import bpy
from mathutils import Vector

FPS = 30


def armatures() -> list[bpy.types.Object]:
    return [o for o in bpy.context.scene.objects if o.type == "ARMATURE"]


def bare(name: str) -> str:
    """A joint's name without the role before it."""
    for part in ("pelvis", "spine", "neck", "head", "left_", "right_"):
        if part in name:
            return name[name.index(part) :]
    return name


def joints(armature: bpy.types.Object) -> dict[str, Vector]:
    return {bare(bone.name): armature.matrix_world @ bone.head for bone in armature.pose.bones}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("glb", type=Path)
    parser.add_argument("bvh", type=Path, nargs=2)
    parser.add_argument("--usd", type=Path, help="the same motion as .usda")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--frame", type=int, help="the frame that is rendered; the middle one by default")
    options = parser.parse_args()

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = FPS  # glTF keeps time in seconds: Blender lays it out at the scene's rate
    bpy.ops.import_scene.gltf(filepath=str(options.glb))
    people = armatures()
    for path in options.bvh:
        bpy.ops.import_anim.bvh(filepath=str(path))
    stick = [o for o in armatures() if o not in people]
    if options.usd:
        bpy.ops.wm.usd_import(filepath=str(options.usd))
    from_usd = [o for o in armatures() if o not in people + stick]
    glb_actions = [o.animation_data.action.frame_range[:] for o in people]
    bvh_actions = [o.animation_data.action.frame_range[:] for o in stick]
    count = int(bvh_actions[0][1] - bvh_actions[0][0]) + 1

    apart, usd_apart, lowest = 0.0, 0.0, {o.name: 9.0 for o in people}
    for frame in range(count):
        # Blender puts the glTF's first frame at 0 and the BVH's at 1.
        scene.frame_set(round(glb_actions[0][0]) + frame)
        own = [joints(o) for o in people]
        scene.frame_set(frame)  # a time code of USD is a frame, and its first is 0
        for mine, theirs in zip(own, (joints(o) for o in from_usd), strict=bool(from_usd)):
            usd_apart = max([usd_apart, *((mine[name] - theirs[name]).length for name in mine)])
        scene.frame_set(round(glb_actions[0][0]) + frame)
        bodies = [
            o.evaluated_get(bpy.context.evaluated_depsgraph_get())
            for o in scene.objects
            if o.type == "MESH" and o.find_armature() in people
        ]
        for body in bodies if frame % 10 == 0 else []:
            low = min((body.matrix_world @ v.co).z for v in body.data.vertices)
            name = body.find_armature().name
            lowest[name] = min(lowest[name], low)
        scene.frame_set(round(bvh_actions[0][0]) + frame)
        for mine, theirs in zip(own, (joints(o) for o in stick), strict=True):
            shared = mine.keys() & theirs.keys()  # few where both wear a character with names of its own
            apart = max([apart, *((mine[name] - theirs[name]).length for name in shared)])
    found = {
        "blender": bpy.app.version_string,
        "armatures": {o.name: len(o.data.bones) for o in people},
        "heights_m": {o.name: round(max((o.matrix_world @ b.head).z for b in o.pose.bones), 3) for o in people},
        "glb_frames": glb_actions,
        "bvh_frames": bvh_actions,
        "glb_bvh_apart_m": round(apart, 7),
        "usd_armatures": [o.name for o in from_usd],
        "glb_usd_apart_m": round(usd_apart, 7) if from_usd else None,
        "lowest_of_bodies_m": {name: round(low, 4) for name, low in lowest.items()},
    }
    if options.out:
        render(people, stick, options, count)
    print(json.dumps(found))


def render(people, stick, options, count: int) -> None:
    """The bodies with the BVH's joints as small red balls, by Cycles on the CPU."""
    scene = bpy.context.scene
    frame = count // 2 if options.frame is None else options.frame
    scene.frame_set(round(stick[0].animation_data.action.frame_range[0]) + frame)
    marks = [p for o in stick for p in joints(o).values()]
    for place in marks:
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.02, location=place, segments=12, ring_count=8)
        ball = bpy.context.object
        red = bpy.data.materials.get("red") or bpy.data.materials.new("red")
        red.diffuse_color = (1, 0, 0, 1)
        red.use_nodes = True
        red.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (1, 0.02, 0.02, 1)
        ball.data.materials.append(red)
    scene.frame_set(round(people[0].animation_data.action.frame_range[0]) + frame)
    bpy.ops.mesh.primitive_plane_add(size=12)
    middle = sum(marks, Vector()) / len(marks)
    bpy.ops.object.camera_add()
    camera = bpy.context.object
    camera.location = middle + Vector((3.6, -2.2, 1.0))
    camera.rotation_euler = (middle - camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.camera = camera
    bpy.ops.object.light_add(type="SUN", location=(2, -3, 5))
    bpy.context.object.data.energy = 3
    bpy.context.object.rotation_euler = (0.6, 0.3, 0.2)
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.9, 0.93, 1, 1)
    scene.world = world
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 24
    scene.cycles.device = "CPU"
    scene.render.resolution_x, scene.render.resolution_y = 960, 640
    scene.render.filepath = str(options.out.resolve())
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main()
