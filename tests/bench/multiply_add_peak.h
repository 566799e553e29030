// How many float operations a second this machine does at best, one core: multiply-adds on registers alone. What
// benchmarks are compared with, measured in the same run.
#pragma once

namespace burin {

/// Runs multiply-adds (two operations each) in packets of `lanes` floats: 1, 4, 8 or 16. Returns the number of
/// operations. The machine must have such packets; 4 lanes multiply and add apart, as SSE2 does.
double multiply_add(int lanes);

/// Operations a second, the best of some runs of multiply_add(); measured once a width.
double multiply_add_peak(int lanes);

}  // namespace burin
