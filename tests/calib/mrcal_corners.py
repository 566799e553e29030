#!/usr/bin/env python3
# Prints the corners that a mrcal calibration was made from: they are embedded in its .cameramodel. Needs python3-mrcal.
# Lines: view x_mm y_mm u_px v_px weight, inliers only; with --vnl a corners.vnl, outliers without a place.
import sys

import mrcal

inputs = mrcal.cameramodel(sys.argv[1]).optimization_inputs()
observations = inputs["observations_board"]
spacing_mm = 1000 * inputs["calibration_object_spacing"]
vnl = len(sys.argv) > 2 and sys.argv[2] == "--vnl"
if vnl:
    print("# filename x y weight")
for view in range(observations.shape[0]):
    for row in range(observations.shape[1]):
        for column in range(observations.shape[2]):
            u, v, weight = observations[view, row, column]
            if vnl:
                place = f"{float(u)!r} {float(v)!r} {float(weight)!r}" if weight > 0 else "- - -"
                print(f"view{view:03d}.jpg {place}")
            elif weight > 0:
                print(view, column * spacing_mm, row * spacing_mm, repr(float(u)), repr(float(v)), repr(float(weight)))
