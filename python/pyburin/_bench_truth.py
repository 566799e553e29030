"""Random benches with known truth, and what was measured of them against it: scripts/random-benches says how they are drawn.

Standard library alone, so that scripts run from a clone without the package.
"""
import csv
import math
import random

PIXELS = (960, 740)
SAMPLES = 144
F_NUMBER = 8


# --- geometry, as in samples/make_small_bench.py ---------------------------------------------------------------------
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


# --- a bench ---------------------------------------------------------------------------------------------------------
def rim(size, spacing, margin=9.5):
    """Tag centers along the rim, counter-clockwise from the lower-left corner."""
    def places(length):
        n = max(2, round((length - 2 * margin) / spacing) + 1)
        return [margin + (length - 2 * margin) * i / (n - 1) for i in range(n)]
    xs, ys = places(size[0]), places(size[1])
    ring = [(x, ys[0]) for x in xs] + [(xs[-1], y) for y in ys[1:]]
    return ring + [(x, ys[-1]) for x in reversed(xs[:-1])] + [(xs[0], y) for y in reversed(ys[1:-1])]


def draw_views(rng, lamp, center, cutoff_deg, distance):
    """Eyes whose half vectors at the board's middle go from the mirror direction to beyond the cut-off."""
    count = rng.choice([6, 7])
    steepest = cutoff_deg + rng.uniform(3, 6)
    tilts = [1.5 + (steepest - 1.5) * (i + rng.uniform(-0.3, 0.3) * (0 < i < count - 1)) / (count - 1) for i in range(count)]
    wi = unit([a - b for a, b in zip(lamp, center)])
    turn = rng.uniform(0, 360)
    eyes = []
    for i, tilt in enumerate(tilts):
        for attempt in range(1000):
            azimuth = turn + 137.5 * i + attempt * 11 + rng.uniform(-20, 20)
            h = direction(tilt, azimuth)
            wo = [2 * dot(wi, h) * a - b for a, b in zip(h, wi)]
            if wo[2] > math.cos(math.radians(55)):
                break
        away = distance * rng.uniform(0.95, 1.08)
        eyes.append([c + away * w + rng.gauss(0, 3) for c, w in zip(center, wo)])
    return eyes


def draw_bench(seed, number):
    rng = random.Random(seed * 100003 + number)
    size = [round(rng.uniform(95, 125), 1), round(rng.uniform(90, 115), 1)]
    center = [size[0] / 2, size[1] / 2, 0.0]
    carve = [[19, 19], [size[0] - 19, size[1] - 19]]

    sigma_mm = rng.uniform(0.03, 0.1)
    believed_tags = [{"id": i, "center_mm": [round(c, 4) for c in p], "size_mm": 10, "rotation_deg": 0}
                     for i, p in enumerate(rim(size, 21))]
    true_tags = [{**t, "center_mm": [round(c + rng.gauss(0, sigma_mm), 4) for c in t["center_mm"]],
                  "rotation_deg": rng.gauss(0, 0.3)} for t in believed_tags]
    tag_set = {"family": "tagStandard41h12", "z_mm": 0.1, "sigma_mm": round(sigma_mm, 4),
               "white_albedo": 0.85, "black_albedo": 0.04}

    wt = rng.uniform(320, 520)
    cutoff_deg = rng.uniform(22, 31)
    depth = -0.5 * wt * math.log(1 - math.tan(math.radians(cutoff_deg) / 2) ** 2)
    f0 = [0.91, 0.92, 0.92]
    material = {"alpha": rng.uniform(0.045, 0.11), "depth_um": depth, "base_alpha": rng.uniform(0.1, 0.2), "f0": f0}
    believed = {"alpha": min(0.3, material["alpha"] * math.exp(rng.gauss(0, 0.3))),
                "depth_um": min(0.3 * wt, depth * math.exp(rng.gauss(0, 0.3))),
                "base_alpha": material["base_alpha"] * math.exp(rng.gauss(0, 0.15)), "f0": f0}
    overlap = rng.choice(["sum", "last"])
    uneven = {"alpha_jitter": rng.uniform(0, 0.12), "depth_jitter": rng.uniform(0, 0.04)}
    if rng.random() < 0.5:
        uneven["depth_gradient"] = [rng.gauss(0, 0.06), rng.gauss(0, 0.06)]
    if rng.random() < 1 / 3:
        uneven["wear"] = rng.uniform(0.02, 0.1)
    turn, skew = rng.gauss(0, 0.0006), rng.gauss(0, 0.0006)
    scale = [1 + rng.gauss(0, 0.001), 1 + rng.gauss(0, 0.001)]
    linear = [[scale[0] * math.cos(turn), skew - scale[1] * math.sin(turn)],
              [scale[0] * math.sin(turn), scale[1] * math.cos(turn)]]
    affine = [row + [rng.gauss(0, 0.12) + c - dot(row, center[:2])] for row, c in zip(linear, center[:2])]

    reach = rng.uniform(450, 850)
    lamp = [c + reach * d for c, d in zip(center, direction(rng.uniform(25, 48), rng.uniform(0, 360)))]
    light = {"id": "lamp", "position_mm": lamp, "falloff_exponent": 0}
    falloff = 1.0
    if rng.random() < 0.5:
        aim = [center[0] + rng.gauss(0, 12), center[1] + rng.gauss(0, 12), 0.0]
        axis = unit([a - b for a, b in zip(aim, lamp)])
        exponent = rng.uniform(2, 12)
        light.update(axis=axis, falloff_exponent=exponent)
        falloff = dot(axis, unit([c - p for c, p in zip(center, lamp)])) ** exponent
    # The longest exposure shows white paper at 0.55 of full scale.
    gain, exposures = 11500.0, [0.0125, 0.0125 / 40]
    paper = 0.55 * F_NUMBER**2 / (gain * exposures[0])
    cos_i = (lamp[2] - center[2]) / reach
    intensity = paper * math.pi / 0.85 * reach**2 / (cos_i * falloff)
    light["intensity"] = [intensity] * 3
    ambient = rng.uniform(0, 0.02) * paper / 0.85

    focal = rng.uniform(1900, 2600)
    distance = focal * max(size) / (0.86 * PIXELS[1])
    lens = [focal, focal * (1 + rng.gauss(0, 0.0007)), (PIXELS[0] - 1) / 2 + rng.gauss(0, 4),
            (PIXELS[1] - 1) / 2 + rng.gauss(0, 4), rng.uniform(-0.12, 0.05), rng.gauss(0, 0.06),
            rng.gauss(0, 0.0004), rng.gauss(0, 0.0004)]
    views = []
    for minute, eye in enumerate(draw_views(rng, lamp, center, cutoff_deg, distance)):
        name = f"v{minute:02d}"
        aim = [center[0] + rng.gauss(0, 3), center[1] + rng.gauss(0, 3), 0.0]
        views.append({"view": name, "T_camera_board": look_at(eye, aim, rng.choice([0, 0, 0, 90]) + rng.gauss(0, 4)),
                      "photos": [{"file": f"photos/{name}_{letter}.png", "light": "lamp", "exposure_s": exposure, "iso": 100,
                                  "f_number": F_NUMBER, "datetime": f"2025:05:17 10:{minute:02d}:{2 * k:02d}"}
                                 for k, (letter, exposure) in enumerate(zip("ab", exposures))]})
    return {
        "format": "burin/rig-truth", "version": 1, "name": f"random {seed}-{number}", "seed": rng.randrange(2**31),
        "samples": SAMPLES, "samples_plain": 16, "overlap": overlap, "h_at": "sample",
        "board": {"size_mm": size, "carve_mm": carve, "bow_mm": [rng.gauss(0, 0.03) for _ in range(3)],
                  "tags": {**tag_set, "quiet_mm": 0.5, "list": true_tags}, "tool": {"width_um": wt}},
        "believed": {"material": believed,
                     "tag_overrides": [{"id": t["id"], "center_mm": t["center_mm"]} for t in believed_tags]},
        "scratches": {"random": {"count": rng.randint(700, 1300), "length_mm": [3, 7], "seed": rng.randrange(2**31)}},
        "material": {**material, **uneven}, "machine": {"affine": affine},
        "camera": {"lensmodel": "LENSMODEL_OPENCV4", "imagersize": list(PIXELS), "intrinsics": lens},
        "sensor": {"channels": 1, "bits": 12, "encoding": "linear", "gain": gain,
                   "full_well_e": rng.uniform(10000, 28000), "read_noise_e": rng.uniform(4, 10)},
        "lights": [light], "views": views, "psf_sigma_px": rng.uniform(0.4, 0.9), "ambient": [ambient] * 3,
        "vignette": [rng.uniform(-0.25, 0), 0, 0],
        "background": {"albedo": [0.03, 0.03, 0.03], "noise": 0.4, "z_mm": -2},
        "dust": {"specks": rng.randint(0, 30), "fibres": rng.randint(0, 3), "speck_mm": [0.1, 0.4],
                 "albedo": [0.3, 0.3, 0.3], "seed": rng.randrange(2**31)},
        "exif": {"make": "Altair", "model": "M07", "focal_mm": 50}, "session": False}


# --- what a bench may have besides ---------------------------------------------------------------------------------
def aimed(light, center):
    light["axis"] = unit([c - p for c, p in zip(center, light["position_mm"])])


def middle(truth):
    return [v / 2 for v in truth["board"]["size_mm"]] + [0.0]


def disk(truth, rng):
    light = truth["lights"][0]
    aimed(light, middle(truth))
    light["disk_mm"] = rng.uniform(6, 25)


def panel(truth, rng):
    light = truth["lights"][0]
    aimed(light, middle(truth))
    light["panel_mm"] = [rng.uniform(60, 160), rng.uniform(30, 80)]
    light["turn_deg"] = rng.uniform(0, 90)
    light["falloff_exponent"] = 1


def softbox(truth, rng):
    """A panel so large that taken for a point it is nothing like one."""
    panel(truth, rng)
    truth["lights"][0]["panel_mm"] = [rng.uniform(200, 340), rng.uniform(120, 240)]


def second_lamp(truth, rng):
    lamp, center = truth["lights"][0], middle(truth)
    position = [c + rng.uniform(600, 1000) * d for c, d in
                zip(center, direction(rng.uniform(25, 55), rng.uniform(0, 360)))]
    share = rng.uniform(0.03, 0.12)
    other = {"id": "other", "position_mm": position, "axis": unit([c - p for c, p in zip(center, position)]),
             "falloff_exponent": 0, "intensity": [share * i for i in lamp["intensity"]]}
    truth.setdefault("stray_lights", []).append(other)


def sky_panel(truth, rng):
    lamp, center = truth["lights"][0], middle(truth)
    position = [c + rng.uniform(1200, 2000) * d for c, d in
                zip(center, direction(rng.uniform(35, 60), rng.uniform(0, 360)))]
    share = rng.uniform(0.1, 0.5)
    window = {"id": "window", "position_mm": position, "axis": unit([c - p for c, p in zip(center, position)]),
              "falloff_exponent": 1, "panel_mm": [900, 1300], "turn_deg": rng.uniform(0, 90),
              "intensity": [share * i for i in lamp["intensity"]]}
    truth.setdefault("stray_lights", []).append(window)


def phone(truth):
    """Photos as 8-bit sRGB JPEGs of three channels, brackets of three; what the departures of cameras stand on."""
    sensor = truth["sensor"]
    if sensor["channels"] == 3:
        return sensor
    sensor.update(channels=3, encoding="srgb", jpeg_quality=95)
    sensor.pop("bits", None)
    for view in truth["views"]:
        first = view["photos"][0]
        view["photos"] = [{**first, "file": f"photos/{view['view']}_{letter}.jpg", "exposure_s": first["exposure_s"] * by,
                           "datetime": first["datetime"][:-2] + f"{2 * k:02d}"}
                          for k, (letter, by) in enumerate(zip("abc", (1, 1 / 5, 1 / 25)))]
    return sensor


def curve(truth, rng):
    phone(truth).update(contrast=rng.choice([rng.uniform(1.1, 1.35), rng.uniform(0.8, 0.92)]), pivot=rng.uniform(0.38, 0.5))


def sharpening(truth, rng):
    phone(truth).update(sharpen_amount=rng.uniform(0.2, 0.6), sharpen_px=rng.uniform(0.7, 1.2))


def mosaic(truth, rng):
    phone(truth).update(mosaic=True)


def balance(truth, rng):
    phone(truth).update(white_balance=[1, rng.uniform(0.95, 1.1), rng.uniform(0.9, 1.3)],
                        white_balance_jitter=rng.uniform(0.005, 0.02))


def glare(truth, rng):
    truth["glare"] = {"share": rng.uniform(0.005, 0.03), "core_px": 4, "reach_px": rng.uniform(250, 600)}


def satin_tags(truth, rng):
    truth["board"]["tags"].update(gloss_alpha=rng.uniform(0.25, 0.4), gloss_f0=0.04)


def groove(truth):
    wt = truth["board"]["tool"]["width_um"]
    return truth["material"].setdefault("profile", {"kind": "paper", "tip_radius_um": wt / 4})


def flanks(truth, rng):
    groove(truth).update(kind="rounded-v", flank_deg=rng.uniform(18, 30))


def arc(truth, rng):
    groove(truth).update(kind="rounded-v", flank_deg=70)


def burrs(truth, rng):
    high = rng.uniform(0.5, 1.5)
    groove(truth).update(burr_height_um=[high, high * rng.uniform(0.4, 1)], burr_width_um=rng.uniform(8, 14))


def across(truth, rng):
    groove(truth).update(alpha_across=rng.uniform(1.15, 1.6))


def brushed(truth, rng):
    base, ratio = truth["material"]["base_alpha"], rng.uniform(1.3, 2.6)
    truth["material"]["brushed"] = {"along_deg": rng.uniform(0, 180), "alpha_along": base / math.sqrt(ratio),
                                    "alpha_across": base * math.sqrt(ratio), "streak_slope": rng.uniform(0, 0.02),
                                    "streak_mm": [30, 0.3]}


def backlash(truth, rng):
    truth["machine"]["backlash_mm"] = [rng.uniform(0.03, 0.12), rng.uniform(0.03, 0.12)]


def screws(truth, rng):
    truth["machine"].update(screw_mm=[rng.uniform(0.01, 0.02), rng.uniform(0.01, 0.02)],
                            screw_period_mm=[rng.uniform(3, 9), rng.uniform(3, 9)],
                            screw_phase_deg=[rng.uniform(0, 360), rng.uniform(0, 360)])


def deepest(truth, rng):
    truth["overlap"] = "deepest"


DEPARTURES = {d.__name__.replace("_", "-"): d for d in (
    disk, panel, second_lamp, sky_panel, curve, sharpening, mosaic, balance, glare, satin_tags, flanks, arc, burrs, across,
    brushed, backlash, screws, deepest, softbox)}


def depart(truth, seed, number, names, together):
    """Adds departures: one of the names in turn, or all of them. Returns what it added."""
    chosen = names if together else [names[number % len(names)]]
    for name in chosen:
        DEPARTURES[name](truth, random.Random(f"{seed}-{number}-{name}"))
    return chosen


# --- what was measured against what is so ----------------------------------------------------------------------------
class TagFrame:
    """The similarity that takes the tags' true places, as a set, to where board.json says: the frame of a calibration."""

    def __init__(self, truth):
        true = {t["id"]: complex(*t["center_mm"]) for t in truth["board"]["tags"]["list"]}
        said = {t["id"]: complex(*t["center_mm"]) for t in truth["believed"]["tag_overrides"]}
        self.true_mean = sum(true.values()) / len(true)
        self.said_mean = sum(said[i] for i in true) / len(true)
        self.factor = (sum((said[i] - self.said_mean) * (true[i] - self.true_mean).conjugate() for i in true) /
                       sum(abs(true[i] - self.true_mean) ** 2 for i in true))

    def point(self, p):
        q = self.said_mean + self.factor * (complex(p[0], p[1]) - self.true_mean)
        return [q.real, q.imag, abs(self.factor) * p[2]]


def camera_center(T):
    return [-sum(T[r][c] * T[r][3] for r in range(3)) for c in range(3)]


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def compare(truth, bench, carved_csv):
    """Rows [group, name, error, sigma] of every number that the bench gives with a sigma."""
    rows = []
    frame = TagFrame(truth)

    def add(group, name, measured, true, sigma):
        if sigma is not None:
            rows.append([group, name, measured - true, sigma])

    true_views = {v["view"]: v for v in truth["views"]}
    for view in bench["views"]:
        measured = camera_center(view["T_camera_board"])
        true = frame.point(camera_center(true_views[view["view"]]["T_camera_board"]))
        for axis in range(3):
            if "center_sigma_mm" in view:
                add("camera", f"{view['view']}.{'xyz'[axis]}_mm", measured[axis], true[axis], view["center_sigma_mm"][axis])
    gain = truth["sensor"]["gain"]
    true_lights = {light["id"]: light for light in truth["lights"]}
    for light in bench["lights"]:
        true = true_lights[light["id"]]
        position = frame.point(true["position_mm"])
        for axis in range(3):
            if "position_sigma_mm" in light:
                add("lamp", f"lamp.{'xyz'[axis]}_mm", light["position_mm"][axis], position[axis],
                    light["position_sigma_mm"][axis])
        if "intensity_sigma" in light:  # on a scale that follows the frame's
            scale2 = abs(frame.factor) ** 2
            sigma = sum(light["intensity_sigma"]) / 3
            # What a camera makes of a color is no photo's to tell: its white balance is the lamp's.
            balance = truth["sensor"].get("white_balance", [1, 1, 1])
            shown = sum(i * w for i, w in zip(true["intensity"], balance)) / 3
            add("intensity", "log intensity", math.log(sum(light["intensity"]) / 3),
                math.log(gain * scale2 * shown), sigma / (sum(light["intensity"]) / 3))
        if "falloff_exponent_sigma" in light:
            add("spot", "falloff_exponent", light["falloff_exponent"], true["falloff_exponent"],
                light["falloff_exponent_sigma"])
        true_sides = sorted(true["panel_mm"], reverse=True) if "panel_mm" in true else [math.sqrt(3) * true.get("disk_mm", 0)] * 2
        if "disk_sigma_mm" in light:  # the disk that scatters as much
            add("lamp's size", "disk_mm", light["disk_mm"], math.hypot(*true_sides) / math.sqrt(6), light["disk_sigma_mm"])
        if "panel_sigma_mm" in light:
            for side, name in enumerate(("longer", "shorter")):
                add("lamp's size", f"{name}_side_mm", light["panel_mm"][side], true_sides[side], light["panel_sigma_mm"][side])
        if "turn_sigma_deg" in light and "panel_mm" in true:
            turn = true.get("turn_deg", 0) + (90 if true["panel_mm"][0] < true["panel_mm"][1] else 0)
            away = (light.get("turn_deg", 0) - turn + 90) % 180 - 90
            add("lamp's turn", "turn_deg", turn + away, turn, light["turn_sigma_deg"])
    stray = bench.get("stray_light", {})
    if "position_sigma_mm" in stray and truth.get("stray_lights"):
        position = frame.point(truth["stray_lights"][0]["position_mm"])
        for axis in range(3):
            add("stray light", f"stray.{'xyz'[axis]}_mm", stray["position_mm"][axis], position[axis],
                stray["position_sigma_mm"][axis])
    material = bench["material"]
    with open(carved_csv) as file:
        carved = list(csv.DictReader(file))
    add("alpha", "alpha", material["alpha"], geometric_mean([float(r["alpha"]) for r in carved]), material.get("alpha_sigma"))
    size, (gx, gy) = truth["board"]["size_mm"], truth["material"].get("depth_gradient", [0, 0])
    flat = [float(r["depth_um"]) /
            (1 + gx * ((float(r["x0_mm"]) + float(r["x1_mm"])) / 2 / size[0] - 0.5) +
             gy * ((float(r["y0_mm"]) + float(r["y1_mm"])) / 2 / size[1] - 0.5)) for r in carved]
    add("depth", "depth_um", material["depth_um"], geometric_mean(flat), material.get("depth_sigma_um"))
    add("base", "base_alpha", material["base_alpha"], truth["material"]["base_alpha"], material.get("base_alpha_sigma"))
    machine = bench["machine"]
    for row in range(2):
        for column in range(3):
            if "affine_sigma" in machine:
                add("machine", f"affine[{row}][{column}]", machine["affine"][row][column],
                    truth["machine"]["affine"][row][column], machine["affine_sigma"][row][column])
    true_machine = truth["machine"]
    for key in ("backlash", "screw"):
        sigma = machine.get(f"{key}_sigma_mm")
        for axis in range(2):
            if sigma and f"{key}_mm" in true_machine:
                add(key, f"{key}.{'xy'[axis]}_mm", abs(machine[f"{key}_mm"][axis]), abs(true_machine[f"{key}_mm"][axis]), sigma[axis])
    glare_found = bench["sensor"].get("glare", {})
    if "share_sigma" in glare_found:
        add("glare", "glare share", glare_found["share"], truth.get("glare", {}).get("share", 0), glare_found["share_sigma"])
    return rows


def first_lamps(truth, bench):
    """Rows of the lamps as calibrate gives them, from paper and face alone."""
    frame, true = TagFrame(truth), {light["id"]: light for light in truth["lights"]}
    rows = []
    for light in bench["lights"]:
        if "position_sigma_mm" not in light:
            continue
        position = frame.point(true[light["id"]]["position_mm"])
        rows += [["first lamp", f"first {light['id']}.{'xyz'[axis]}_mm", light["position_mm"][axis] - position[axis],
                  light["position_sigma_mm"][axis]] for axis in range(3)]
    return rows


def announced(bench, key, sigma_key, parameter, error):
    """Whether a relative error above 2 % was to be seen in bench.json."""
    material = bench["material"]
    sigma = material.get(sigma_key)
    told = bench.get("verdict", {}).get(parameter, {}).get("degree") != "determined" or bool(bench.get("misfits"))
    return abs(error) <= 0.02 or sigma is None or told or sigma / material[key] >= abs(error) / 2


def in_percent(rows, bench):
    """Errors of alpha, depth and base_alpha: {name: [error %, sigmas, announced]}."""
    out = {}
    for group, name, error, sigma in rows:
        key = {"alpha": "alpha", "depth": "depth_um", "base": "base_alpha"}.get(group)
        if key is None:
            continue
        sigma_key = {"alpha": "alpha_sigma", "depth_um": "depth_sigma_um", "base_alpha": "base_alpha_sigma"}[key]
        relative = error / (bench["material"][key] - error)
        out[key] = [100 * relative, error / sigma, announced(bench, key, sigma_key, key, relative)]
    return out
