// burin/calib/photo/bench_unknowns.h - between a bench and a problem's unknowns: how each is read and written.
#pragma once

#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/bench.h"

namespace burin {

/// What a bench says of all unknowns, in the problem's units: the blur in pixels of its merged photos (a usual one
/// where the bench says none), a lamp's aim where its axis meets the board's plane.
State state_of(const Bench& bench, const Problem& problem);

/// Writes them all into a bench whose lamps are the problem's.
void put_state(const State& state, const Problem& problem, Bench& bench);

}  // namespace burin
