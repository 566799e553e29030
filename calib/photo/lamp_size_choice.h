// burin/calib/photo/lamp_size_choice.h - lamps that are large beside their distance: panels, softboxes. docs/model.md
// 9, 'Effects'.
//
// A small lamp changes little of what is found without it, and is asked for at the end, beside glare and the field of
// depth (field_choice.h). A large one changes everything: taken for a point, grooves and face come out rougher by
// half, and the lamp decimeters off.
#pragma once

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Whether a lamp, as large as it is believed or found to be, is larger than a 25th of its distance.
bool any_large_lamp(const Problem& data, const State& state);

/// Where photos clearly ask for such lamps (of those that Problem::size_sought seeks the size of): puts their size, and
/// the sides where photos ask for these too, into state and stage, and says true. Else leaves both as they are. Takes
/// one look at the photos' equations, and a fit or two where these foretell a large lamp. Photos are weighed by the
/// caller.
bool choose_large_lamps(const Problem& data, Stage& stage, State& state, const Progress& progress);

/// Whether lamps whose size is known are longer one way than the other, by a fit with sides: puts them into state and
/// stage where photos are explained better by more than they scatter. Photos are weighed by the caller.
bool choose_sides(const Problem& data, Stage& stage, State& state, const Progress& progress);

}  // namespace burin
