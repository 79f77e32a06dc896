"""Make the meshes of the models: what a person sees of racket, cup, ball, goal and arm.

Run it in a clone, ``python models/make_meshes.py``; it needs numpy alone and writes the same bytes
every time. Every mesh is a swept tube or a surface of revolution, in metres, in the frame that its
URDF's ``<visual>`` gives it. They are looks only; masses and contacts know nothing of them.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MODELS = Path(__file__).resolve().parent
CREASE = np.cos(np.radians(40.0))
"""Faces that meet at a smaller cosine keep a sharp edge between them."""

HEAD_LENGTH, HEAD_WIDTH = 0.34, 0.26  # [m] outer axes of the racket's oval, along z and x
FRAME = 0.010  # [m] half the width of the frame's tube
BALL_RADIUS = 0.033  # [m]
RING_RADIUS = 0.125  # [m] inner radius of the goal's upper ring
RING_TUBE = 0.009  # [m]


class Mesh(NamedTuple):
    """Vertices (n, 3) [m] and faces: triangles, or quads when all four corners differ."""

    vertices: Array
    faces: list[tuple[int, ...]]


def revolve(profile: list[tuple[float, float]], sides: int = 32) -> Mesh:
    """Turn a profile of (radius, z) about z; going up, the outside is to the right."""
    turn = 2.0 * np.pi * np.arange(sides) / sides
    vertices = np.array(
        [[r * np.cos(a), r * np.sin(a), z] for r, z in profile for a in turn], dtype=np.float64
    )
    faces: list[tuple[int, ...]] = []
    for k, ((r0, _), (r1, _)) in enumerate(pairwise(profile)):
        for i in range(sides):
            j = (i + 1) % sides
            a, b = k * sides + i, k * sides + j
            c, d = b + sides, a + sides
            if r0 == 0.0:
                faces.append((a, c, d))
            elif r1 == 0.0:
                faces.append((a, b, c))
            else:
                faces.append((a, b, c, d))
    return Mesh(vertices, faces)


def tube(
    curve: Array,
    radius: float | tuple[float, float],
    up: Array,
    sides: int = 8,
    closed: bool = False,
) -> Mesh:
    """Sweep an ellipse along a curve.

    Args:
        curve: Points (n, 3) [m].
        radius: Of the tube [m]; two radii lie across and along ``up``.
        up: Direction (3,), or one a point (n, 3), that is never along the curve.
        sides: Corners of the ellipse.
        closed: The last point is followed by the first; otherwise flat caps close the ends.
    """
    across, along = radius if isinstance(radius, tuple) else (radius, radius)
    if closed:
        tangent = np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0)
    else:
        tangent = np.gradient(curve, axis=0)
    side = np.cross(tangent, np.broadcast_to(up, curve.shape))
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    top = np.cross(side, tangent)
    top /= np.linalg.norm(top, axis=1, keepdims=True)
    turn = 2.0 * np.pi * np.arange(sides) / sides
    rings = (
        curve[:, None, :]
        + across * np.cos(turn)[None, :, None] * side[:, None, :]
        + along * np.sin(turn)[None, :, None] * top[:, None, :]
    )
    count = len(curve)
    faces: list[tuple[int, ...]] = []
    for k in range(count if closed else count - 1):
        for i in range(sides):
            j = (i + 1) % sides
            a, b = k * sides + i, k * sides + j
            c, d = (k + 1) % count * sides + j, (k + 1) % count * sides + i
            faces.append((a, d, c, b))
    vertices = rings.reshape(-1, 3)
    if not closed:
        first, last = len(vertices), len(vertices) + 1
        vertices = np.vstack([vertices, curve[0], curve[-1]])
        end = (count - 1) * sides
        for i in range(sides):
            j = (i + 1) % sides
            faces.append((first, i, j))
            faces.append((last, end + j, end + i))
    return Mesh(vertices, faces)


def join(*meshes: Mesh) -> Mesh:
    """Put several meshes into one."""
    offsets = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = [
        tuple(i + int(offset) for i in face)
        for mesh, offset in zip(meshes, offsets[:-1], strict=True)
        for face in mesh.faces
    ]
    return Mesh(np.vstack([mesh.vertices for mesh in meshes]), faces)


def write_obj(mesh: Mesh, path: Path) -> None:
    """Write a Wavefront file with normals that are smooth up to the crease angle."""
    corners = [mesh.vertices[list(face)] for face in mesh.faces]
    areas = np.array([np.cross(c[2] - c[0], c[-1] - c[1]) for c in corners])
    units = areas / np.linalg.norm(areas, axis=1, keepdims=True)
    around: dict[int, list[int]] = {}
    for index, face in enumerate(mesh.faces):
        for vertex in face:
            around.setdefault(vertex, []).append(index)
    normals: dict[str, int] = {}
    lines = []
    for index, face in enumerate(mesh.faces):
        words = []
        for vertex in face:
            near = [f for f in around[vertex] if units[f] @ units[index] > CREASE]
            normal = areas[near].sum(axis=0)
            normal = normal / np.linalg.norm(normal) + 0.0
            key = " ".join(f"{x:.3f}" for x in np.round(normal, 3) + 0.0)
            words.append(f"{vertex + 1}//{normals.setdefault(key, len(normals) + 1)}")
        lines.append("f " + " ".join(words))
    points = ["v " + " ".join(f"{x:.5f}" for x in v) for v in np.round(mesh.vertices, 5) + 0.0]
    path.write_text("\n".join([*points, *(f"vn {n}" for n in normals), *lines]) + "\n")


def oval(angle: Array, inset: float = FRAME) -> Array:
    """Points (n, 3) of the head's oval, ``inset`` [m] inside its outer edge; angle 0 is the tip."""
    x = (HEAD_WIDTH / 2.0 - inset) * np.sin(angle)
    z = (HEAD_LENGTH / 2.0 - inset) * np.cos(angle)
    return np.stack([x, np.zeros_like(x), z], axis=-1)


def racket_frame() -> Mesh:
    """Head and throat: an oval tube, and two arms that run from it into the shaft."""
    normal = np.array([0.0, 1.0, 0.0])
    head = tube(
        oval(np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)), (FRAME, 0.012), normal, 12, True
    )
    s = np.linspace(0.0, 1.0, 12)[:, None]
    arms = []
    for sign in (-1.0, 1.0):
        start = oval(np.array([np.pi - 0.62 * sign]))[0]
        bend, end = np.array([sign * 0.022, 0.0, -0.24]), np.array([sign * 0.006, 0.0, -0.34])
        curve = (1 - s) ** 2 * start + 2 * s * (1 - s) * bend + s**2 * end
        arms.append(tube(curve, (0.009, 0.011), normal, 10))
    shaft = tube(np.array([[0.0, 0.0, -0.32], [0.0, 0.0, -0.36]]), (0.014, 0.012), normal, 12)
    return join(head, *arms, shaft)


def racket_strings() -> Mesh:
    """Sixteen main and nineteen cross strings, inside the oval."""
    a, b = HEAD_WIDTH / 2.0 - FRAME, HEAD_LENGTH / 2.0 - FRAME
    strings = []
    for x in np.linspace(-0.85, 0.85, 16) * a:
        z = b * np.sqrt(1.0 - (x / a) ** 2)
        strings.append(np.array([[x, 0.0, -z], [x, 0.0, z]]))
    for z in np.linspace(-0.88, 0.88, 19) * b:
        x = a * np.sqrt(1.0 - (z / b) ** 2)
        strings.append(np.array([[-x, 0.0, z], [x, 0.0, z]]))
    return join(*(tube(string, 0.0009, np.array([0.0, 1.0, 0.0]), 4) for string in strings))


def racket_bed() -> Mesh:
    """The translucent sheet that stands for the string bed: the oval, 2 mm thick."""
    rim = oval(np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False))
    sheets = [rim + np.array([0.0, y, 0.0]) for y in (-0.001, 0.001)]
    faces: list[tuple[int, ...]] = []
    for i in range(1, 47):
        faces += [(0, i + 1, i), (48, 48 + i, 49 + i)]
    return Mesh(np.vstack(sheets), faces)


def racket_grip() -> Mesh:
    """The handle: eight-sided, with the butt's cap."""
    profile = [(0.0, -0.515), (0.019, -0.515), (0.019, -0.507), (0.0165, -0.495), (0.0155, -0.345)]
    return revolve([*profile, (0.0, -0.345)], sides=8)


def cup() -> Mesh:
    """A hollow bowl, opening along z about the resting ball's centre, on its stem.

    It ends 20 mm below that centre: a deeper one would hold on to a ball that leaves.
    """
    inner, outer = BALL_RADIUS + 0.0015, BALL_RADIUS + 0.0045
    quarter = np.linspace(0.0, np.radians(60.0), 10)
    stem = [(0.0, -0.090), (0.007, -0.090), (0.007, -outer)]
    shell = [(outer * np.sin(a), -outer * np.cos(a)) for a in quarter[2:]]
    hollow = [(inner * np.sin(a), -inner * np.cos(a)) for a in quarter[:0:-1]]
    return revolve([*stem, *shell, *hollow, (0.0, -inner)])


def ball_seam() -> Mesh:
    """The closed white line around a tennis ball."""
    t = np.linspace(0.0, 2.0 * np.pi, 72, endpoint=False)
    a, b = 0.75, 0.25
    curve = np.stack(
        [
            a * np.cos(t) + b * np.cos(3 * t),
            a * np.sin(t) - b * np.sin(3 * t),
            2.0 * np.sqrt(a * b) * np.sin(2 * t),
        ],
        axis=1,
    )
    return tube(curve * (BALL_RADIUS - 0.0005), (0.0016, 0.001), curve, 6, True)


def circle(radius: float, z: float, count: int = 48) -> Array:
    """Points (count, 3) of a level circle about z."""
    turn = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(count, z)], axis=1)


def goal_ring() -> Mesh:
    """The upper ring, about the ring's frame; inside it is free."""
    return tube(
        circle(RING_RADIUS + RING_TUBE, 0.0), RING_TUBE, np.array([0.0, 0.0, 1.0]), 12, True
    )


def goal_basket() -> Mesh:
    """The wire basket that hangs from the ring, narrower at its foot, on z up from the floor."""
    up = np.array([0.0, 0.0, 1.0])
    top, foot = np.array([RING_RADIUS + RING_TUBE, 0.50]), np.array([0.09, 0.16])
    wires = []
    for s in (0.33, 0.66, 1.0):
        radius, z = (1 - s) * top + s * foot
        wires.append(tube(circle(radius, z, 32), 0.0025, up, 5, True))
    for turn in 2.0 * np.pi * np.arange(16) / 16:
        out = np.array([np.cos(turn), np.sin(turn), 0.0])
        line = np.array([top[0] * out + top[1] * up, foot[0] * out + foot[1] * up])
        wires.append(tube(line, 0.0025, np.cross(out, up), 5))
    return join(*wires)


def goal_stand() -> Mesh:
    """Foot, post and the plate that carries the basket."""
    profile = [(0.0, 0.0), (0.14, 0.0), (0.14, 0.012), (0.03, 0.02), (0.018, 0.03), (0.018, 0.152)]
    return revolve([*profile, (0.09, 0.154), (0.09, 0.162), (0.0, 0.162)])


def capsule(z0: float, r0: float, z1: float, r1: float) -> Mesh:
    """A limb: a cone from radius r0 at z0 to r1 at z1 with rounded ends."""
    round_ = np.linspace(0.0, np.pi / 2.0, 6)
    lower = [(r0 * np.sin(a), z0 - 0.6 * r0 * np.cos(a)) for a in round_[1:]]
    upper = [(r1 * np.cos(a), z1 + 0.6 * r1 * np.sin(a)) for a in round_[:-1]]
    return revolve([(0.0, z0 - 0.6 * r0), *lower, *upper, (0.0, z1 + 0.6 * r1)], sides=28)


def base_column() -> Mesh:
    """The arm's post: foot on the floor, about the base's frame, 0.91716 m above it."""
    floor = -0.91716
    profile = [(0.0, floor), (0.20, floor), (0.20, floor + 0.02), (0.075, floor + 0.05)]
    return revolve([*profile, (0.055, floor + 0.12), (0.050, -0.03), (0.06, 0.0), (0.0, 0.05)])


def meshes() -> dict[str, Mesh]:
    """Return every mesh by its file's path below ``models/``."""
    return {
        "arm/base.obj": base_column(),
        "arm/upper_arm.obj": capsule(0.03, 0.056, 0.245, 0.042),
        "arm/forearm.obj": capsule(0.035, 0.043, 0.235, 0.029),
        "ball/seam.obj": ball_seam(),
        "goal/basket.obj": goal_basket(),
        "goal/ring.obj": goal_ring(),
        "goal/stand.obj": goal_stand(),
        "racket/bed.obj": racket_bed(),
        "racket/cup.obj": cup(),
        "racket/frame.obj": racket_frame(),
        "racket/grip.obj": racket_grip(),
        "racket/strings.obj": racket_strings(),
    }


def main() -> None:
    """Write them all."""
    for name, mesh in meshes().items():
        write_obj(mesh, MODELS / name)


if __name__ == "__main__":
    main()
