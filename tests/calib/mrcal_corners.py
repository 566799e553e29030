#!/usr/bin/env python3
# Prints the corners that a mrcal calibration was made from: they are embedded in its .cameramodel.
# Lines: view x_mm y_mm u_px v_px weight, inliers only. Needs python3-mrcal.
import sys

import mrcal

inputs = mrcal.cameramodel(sys.argv[1]).optimization_inputs()
observations = inputs["observations_board"]
spacing_mm = 1000 * inputs["calibration_object_spacing"]
for view in range(observations.shape[0]):
    for row in range(observations.shape[1]):
        for column in range(observations.shape[2]):
            u, v, weight = observations[view, row, column]
            if weight > 0:
                print(view, column * spacing_mm, row * spacing_mm, repr(float(u)), repr(float(v)), repr(float(weight)))
