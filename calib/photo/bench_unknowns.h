// burin/calib/photo/bench_unknowns.h - reads a problem's unknowns from a bench and writes them back.
#pragma once

#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/bench.h"

namespace burin {

/// A bench's values of all unknowns, in the problem's units. The blur is in pixels of its merged photos (a usual one if
/// the bench has none). A lamp's aim is the point at which its axis meets the board's plane.
State state_of(const Bench& bench, const Problem& problem);

/// Writes all unknowns into a bench whose lamps are the problem's.
void put_state(const State& state, const Problem& problem, Bench& bench);

}  // namespace burin
