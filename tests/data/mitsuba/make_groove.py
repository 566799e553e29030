#!/usr/bin/env python3
"""Makes groove.csv: light that a groove sends under surroundings, by a renderer that is not ours.

  pip install mitsuba==3.9.1 numpy; ./make_groove.py > groove.csv

takes some minutes; DRJIT_LIBLLVM_PATH names LLVM's library (19: older ones fail).

The groove of docs/model.md 3.1 stands as a mesh of strips in y, rough conductor (GGX, reflectance 1), under two windows.
Each row: what an eye far away sees of it, averaged over the groove's whole width by parallel rays, each reflecting once.
Surroundings, by direction in the board's frame (polar angle from +z, azimuth from +x counter-clockwise, degrees):
WINDOWS below, and nothing else.
"""
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

# azimuth from, to, polar from, to, radiance R G B
WINDOWS = [(250, 272, 20, 50, (9, 8, 7)), (60, 100, 10, 40, (1.5, 2, 3))]
STRIPS, RAYS, PASSES = 4000, 1 << 20, 4


def room():
    height = 1440
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(2 * height) + 0.5) / (2 * height), indexing="ij")
    theta, phi = np.pi * v, 2 * np.pi * u
    d = np.stack([np.sin(phi) * np.sin(theta), np.cos(theta), -np.cos(phi) * np.sin(theta)], -1)
    polar = np.degrees(np.arccos(np.clip(d[..., 2], -1, 1)))
    azimuth = np.degrees(np.arctan2(d[..., 1], d[..., 0])) % 360
    out = np.zeros((height, 2 * height, 3), np.float32)
    for a, b, c, e, color in WINDOWS:
        out[(azimuth > a) & (azimuth < b) & (polar > c) & (polar < e)] = color
    return out


def groove(width_um, depth_um):
    """Half-width in um, and the mesh, in units of um."""
    half = width_um / 2 * np.sqrt(1 - np.exp(-2 * depth_um / width_um))
    x = np.linspace(-half, half, STRIPS + 1)
    z = -width_um / 2 * np.log(1 - 4 * x**2 / width_um**2) - depth_um
    length = 1e4
    points = np.concatenate([np.stack([x, np.full_like(x, y), z], -1) for y in (-length, length)])
    i = np.arange(STRIPS)
    faces = np.concatenate([np.stack([i, i + 1, i + STRIPS + 2], -1), np.stack([i, i + STRIPS + 2, i + STRIPS + 1], -1)])
    mesh = mi.Mesh("groove", len(points), len(faces), props=PROPS)
    params = mi.traverse(mesh)
    params["vertex_positions"] = points.astype(np.float32).ravel()
    params["faces"] = faces.astype(np.uint32).ravel()
    params.update()
    return half, mesh


print("width_um,depth_um,alpha,eye_azimuth_deg,eye_polar_deg,r,g,b,sigma")
for depth_um in (2.0, 14.0):
    for alpha in (0.04, 0.1, 0.2):
        PROPS = mi.Properties()
        PROPS["bsdf"] = mi.load_dict({"type": "twosided", "bsdf": {
            "type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": alpha}})
        half, mesh = groove(400.0, depth_um)
        scene = mi.load_dict({"type": "scene", "integrator": {"type": "path", "max_depth": 2}, "mesh": mesh,
                              "emitter": {"type": "envmap", "bitmap": mi.Bitmap(room())}})
        integrator = scene.integrator()
        for azimuth, polar in ((270, 5), (90, 20), (80, 35), (100, 50), (10, 15)):
            a, p = np.radians(azimuth), np.radians(polar)
            to_eye = [float(np.sin(p) * np.cos(a)), float(np.sin(p) * np.sin(a)), float(np.cos(p))]
            means = []
            for k in range(PASSES):
                sampler = mi.load_dict({"type": "independent"})
                sampler.seed(k + 1, RAYS)
                at = mi.Point3f((2 * sampler.next_1d() - 1) * float(half), 0.0, 0.0)
                ray = mi.RayDifferential3f(mi.Ray3f(at + 500 * mi.Vector3f(to_eye), -mi.Vector3f(to_eye)))
                light = integrator.sample(scene, sampler, ray)[0]
                means.append([float(dr.mean(light[c])[0]) for c in range(3)])
            mean, sigma = np.mean(means, 0), np.std(means, 0, ddof=1).max() / np.sqrt(PASSES)
            print(f"400,{depth_um:g},{alpha:g},{azimuth},{polar},{mean[0]:.6g},{mean[1]:.6g},{mean[2]:.6g},{sigma:.2g}")
            sys.stdout.flush()
