#!/usr/bin/env python3
"""Draws samples/small-bench: its three pictures, the bench as it is believed to be, and the bench as it really is.

The sample is committed as this program leaves it; run it again only to change the sample. It needs Python alone.

Geometry (board frame, mm): a lamp 40 degrees from the board's normal, a camera half a meter away. A view glints on the
scratches that lie across its half vector's lean, so the three designed views lean 20 to 21 degrees towards -35, -90 and
-145 degrees in azimuth: inside the groove's cut-off, and well apart modulo 180 degrees. Grooves cut each other's rims.
Further views are for measuring: from the mirror direction (3 degrees) to beyond the cut-off (33 degrees).
"""
import json
import math
import pathlib
import random
import struct
import zlib

SIZE = 120.0
CENTER = (SIZE / 2, SIZE / 2, 0.0)
OUT = pathlib.Path(__file__).resolve().parent / "small-bench"


# --- vectors ---------------------------------------------------------------------------------------------------------
def unit(v):
    n = math.sqrt(sum(x * x for x in v))
    return [x / n for x in v]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def direction(tilt_deg, azimuth_deg):
    t, a = math.radians(tilt_deg), math.radians(azimuth_deg)
    return [math.sin(t) * math.cos(a), math.sin(t) * math.sin(a), math.cos(t)]


def look_at(eye, target, roll_deg=0.0):
    """T_camera_board of a camera at `eye` (x right, y down, z forward) whose picture has the board's y upwards."""
    z = unit([t - e for t, e in zip(target, eye)])
    up = [0.0, 1.0, 0.0]
    x = unit(cross(z, up))
    y = cross(z, x)
    c, s = math.cos(math.radians(roll_deg)), math.sin(math.radians(roll_deg))
    x, y = [c * a + s * b for a, b in zip(x, y)], [c * b - s * a for a, b in zip(x, y)]
    rows = [x, y, z]
    return [[round(v, 12) for v in r] + [round(-dot(r, eye), 9)] for r in rows] + [[0.0, 0.0, 0.0, 1.0]]


def eye_for_half_vector(lamp, tilt_deg, azimuth_deg, distance):
    """Where the camera must stand for the board's center to have that half vector."""
    wi = unit([a - b for a, b in zip(lamp, CENTER)])
    h = direction(tilt_deg, azimuth_deg)
    wo = [2 * dot(wi, h) * a - b for a, b in zip(h, wi)]
    return [c + distance * w for c, w in zip(CENTER, wo)]


# --- the bench as believed, and as it is -----------------------------------------------------------------------------
LAMP = [60.0, -313.0, 444.5]
DESIGN_HALF_VECTORS = {"d0": (21, -35), "d1": (20, -90), "d2": (21, -145)}
MEASURING_HALF_VECTORS = {"c0": (3, 60), "c1": (7, 140), "c2": (12, 0), "c3": (17, -120),
                          "c4": (25, -60), "c5": (29, -35), "c6": (33, -150)}
# Eight times apart: paper fills the first, glints and the shining face are not clipped in the last.
BRACKET = [("a", 0.0125, 0), ("b", 0.0015625, 2), ("c", 0.0002, 4)]
PIXELS = (900, 700)


def tags():
    places = [10.0, 35.0, 60.0, 85.0, 110.0]
    ring = [(x, 10.0) for x in places] + [(110.0, y) for y in places[1:]]
    ring += [(x, 110.0) for x in reversed(places[:-1])] + [(10.0, y) for y in reversed(places[1:-1])]
    return [{"id": i, "center_mm": list(c), "size_mm": 10, "rotation_deg": 0} for i, c in enumerate(ring)]


def write_json(name, value):
    text = json.dumps(value, indent=1)
    (OUT / name).write_text(text + "\n")


def write_bench():
    rng = random.Random(20241)
    believed_material = {"alpha": 0.05, "depth_um": 13, "base_alpha": 0.075, "f0": [0.91, 0.92, 0.92]}
    carve = [[20, 20], [100, 100]]
    tag_set = {"family": "tagStandard41h12", "z_mm": 0.1, "sigma_mm": 0.1, "white_albedo": 0.85, "black_albedo": 0.04}
    write_json("board.json", {
        "format": "burin/board", "version": 1, "size_mm": [SIZE, SIZE], "carve_mm": carve,
        "tags": {**tag_set, "list": tags()}, "scratches": "scratches.csv", "tool": {"width_um": 400},
        "material": believed_material})

    (OUT / "camera.cameramodel").write_text(
        "{\n    'lensmodel':  'LENSMODEL_OPENCV8',\n\n"
        "    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n"
        "    'intrinsics': [ 2300, 2300, 449.5, 349.5, 0, 0, 0, 0, 0, 0, 0, 0,],\n\n"
        "    # extrinsics are rt_fromref\n"
        "    'extrinsics': [ 0, 0, 0, 0, 0, 0,],\n\n"
        "    'imagersize': [ 900, 700,]\n}\n")
    nominal = {name: eye_for_half_vector(LAMP, *half, 500.0) for name, half in DESIGN_HALF_VECTORS.items()}
    write_json("bench.json", {
        "format": "burin/bench", "version": 1, "camera": "camera.cameramodel",
        "views": [{"view": n, "T_camera_board": look_at(eye, CENTER)} for n, eye in nominal.items()],
        "lights": [{"id": "lamp", "position_mm": LAMP, "intensity": [1, 1, 1], "falloff_exponent": 0}],
        "material": {"crossings": "deepest"}, "machine": {"affine": [[1, 0, 0], [0, 1, 0]]}})
    write_json("design.json", {
        "format": "burin/design", "version": 1, "board": "board.json", "bench": "bench.json", "scratches": 10000,
        "views": [{"view": n, "light": "lamp", "target": f"targets/{p}.png", "rotation_deg": 0}
                  for n, p in zip(DESIGN_HALF_VECTORS, ("moon", "boat", "still-life"))]})

    # What nobody knows: the calibration must find it from the photographs.
    eyes = dict(nominal)
    for name, (tilt, azimuth) in MEASURING_HALF_VECTORS.items():
        eyes[name] = eye_for_half_vector(LAMP, tilt, azimuth, 500.0 + rng.uniform(-25, 25))
    views = []
    for minute, (name, eye) in enumerate(eyes.items()):
        eye = [e + rng.gauss(0, 6) for e in eye]
        aim = [c + rng.gauss(0, 4) for c in CENTER[:2]] + [0.0]
        photos = [{"file": f"photos/{name}_{tag}.png", "light": "lamp", "exposure_s": exposure, "iso": 100,
                   "f_number": 8, "datetime": f"2025:05:17 10:{minute:02d}:{second:02d}"}
                  for tag, exposure, second in BRACKET]
        views.append({"view": name, "T_camera_board": look_at(eye, aim, rng.gauss(0, 2)), "photos": photos})
    lamp = [a + b for a, b in zip(LAMP, (28.0, -18.0, 20.0))]
    stuck = [{**t, "center_mm": [round(c + rng.gauss(0, 0.07), 4) for c in t["center_mm"]]} for t in tags()]
    skew, turn = 0.0004, 0.0006
    scale = (1.0012, 0.9988)
    affine = [[scale[0] * math.cos(turn), skew - scale[1] * math.sin(turn), 0.09],
              [scale[0] * math.sin(turn), scale[1] * math.cos(turn), -0.12]]
    write_json("truth.json", {
        "format": "burin/rig-truth", "version": 1, "name": "small-bench", "seed": 4211,
        "samples": 100, "samples_plain": 16, "overlap": "deepest", "h_at": "sample",
        "board": {"size_mm": [SIZE, SIZE], "carve_mm": carve, "bow_mm": [0.02, 0.01, -0.015],
                  "tags": {**tag_set, "quiet_mm": 0.5, "list": stuck}, "tool": {"width_um": 400}},
        "believed": {"material": believed_material,
                     "tag_overrides": [{"id": t["id"], "center_mm": t["center_mm"]} for t in tags()]},
        "scratches": {"random": {"count": 8000, "length_mm": [3, 5], "seed": 4211}},
        "material": {"alpha": 0.04, "depth_um": 11, "base_alpha": 0.07, "f0": [0.91, 0.92, 0.92]},
        "machine": {"affine": [[round(v, 9) for v in row] for row in affine]},
        "camera": {"lensmodel": "LENSMODEL_OPENCV8", "imagersize": list(PIXELS),
                   "intrinsics": [2311.4, 2309.8, 452.3, 345.9, -0.07, 0.05, 0.0002, -0.0001, 0.0, 0.01, 0.0, 0.0]},
        "sensor": {"channels": 1, "bits": 12, "encoding": "linear", "gain": 11500.0, "full_well_e": 18000,
                   "read_noise_e": 9},
        "lights": [{"id": "lamp", "position_mm": lamp, "intensity": [320000.0, 320000.0, 320000.0],
                    "falloff_exponent": 0}],
        "views": views, "psf_sigma_px": 0.45, "ambient": [0.004, 0.004, 0.004],
        "background": {"albedo": [0.03, 0.03, 0.03], "noise": 0.4, "z_mm": -2},
        "exif": {"make": "Altair", "model": "M07", "focal_mm": 50}, "session": False})


# --- the pictures ----------------------------------------------------------------------------------------------------
def clamp01(v):
    return min(1.0, max(0.0, v))


def inside(signed_distance, soft=0.006):
    """1 where the distance is negative, with an edge about a pixel wide. The picture runs from 0 to 1 both ways."""
    return clamp01(0.5 - signed_distance / soft)


def mix(a, b, t):
    return a + (b - a) * t


def disc(x, y, cx, cy, r):
    return math.hypot(x - cx, y - cy) - r


def half_plane(x, y, ax, ay, bx, by):
    """Negative to the left of the line from a to b (y up)."""
    ex, ey = unit((bx - ax, by - ay))
    return -(ex * (y - ay) - ey * (x - ax))


def polygon(x, y, *corners):
    return max(half_plane(x, y, *a, *b) for a, b in zip(corners, corners[1:] + corners[:1]))


def moon(x, y):
    value = 0.04 + 0.10 * (1 - y)
    crescent = max(disc(x, y, 0.52, 0.66, 0.25), -disc(x, y, 0.63, 0.72, 0.22))
    value = mix(value, 0.95, inside(crescent))
    for sx, sy, r in ((0.14, 0.86, 0.018), (0.19, 0.66, 0.013), (0.85, 0.86, 0.016), (0.90, 0.58, 0.012),
                      (0.10, 0.48, 0.014), (0.74, 0.44, 0.012), (0.36, 0.92, 0.011)):
        value = mix(value, 0.9, inside(disc(x, y, sx, sy, r)))
    far = y - (0.27 + 0.07 * math.sin(7 * x + 1.0) + 0.02 * math.sin(19 * x))
    value = mix(value, 0.42, inside(far))
    near = y - (0.14 + 0.06 * math.sin(5.2 * x + 3.6))
    return mix(value, 0.10, inside(near))


def boat(x, y):
    value = mix(0.22, 0.10, y)
    value = mix(value, 0.75, inside(disc(x, y, 0.19, 0.80, 0.085)))
    main = polygon(x, y, (0.49, 0.33), (0.49, 0.93), (0.20, 0.33))
    value = mix(value, 0.95 - 0.35 * (0.49 - x) / 0.29, inside(main))
    jib = polygon(x, y, (0.52, 0.33), (0.80, 0.33), (0.52, 0.82))
    value = mix(value, 0.62 - 0.30 * (x - 0.52) / 0.28, inside(jib))
    hull = polygon(x, y, (0.14, 0.30), (0.28, 0.16), (0.72, 0.16), (0.86, 0.30))
    value = mix(value, 0.85, inside(hull))
    wave = y - (0.195 + 0.018 * math.sin(26 * x))
    sea = 0.30 + 0.20 * math.sin(60 * y + 2.5 * math.sin(9 * x))
    return mix(value, sea, inside(wave))


def still_life(x, y):
    value = mix(0.42, 0.16, clamp01(abs(y - 0.32) * 2.2)) if y > 0.32 else mix(0.50, 0.70, (0.32 - y) / 0.32)
    shadow = math.hypot((x - 0.50) / 0.34, (y - 0.20) / 0.075) - 1
    value = mix(value, 0.06, clamp01(0.5 - 2.0 * shadow))
    cone = polygon(x, y, (0.60, 0.24), (0.92, 0.24), (0.76, 0.80))
    value = mix(value, clamp01(0.70 - 3.6 * (x - 0.76) / max(0.06, 0.80 - y) * 0.35), inside(cone))
    cx, cy, r = 0.37, 0.43, 0.25
    nx, ny = (x - cx) / r, (y - cy) / r
    nz = math.sqrt(max(0.0, 1 - nx * nx - ny * ny))
    lit = max(0.0, dot((nx, ny, nz), unit((-0.55, 0.65, 0.55))))
    return mix(value, 0.05 + 0.9 * lit, inside(disc(x, y, cx, cy, r)))


def write_picture(name, picture, size=320):
    rows = bytearray()
    for r in range(size):
        rows.append(0)
        for c in range(size):
            rows.append(round(255 * clamp01(picture((c + 0.5) / size, 1 - (r + 0.5) / size))))
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0)
    (OUT / "targets" / f"{name}.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    (OUT / "targets").mkdir(parents=True, exist_ok=True)
    write_bench()
    for picture_name, picture_of in (("moon", moon), ("boat", boat), ("still-life", still_life)):
        write_picture(picture_name, picture_of)
