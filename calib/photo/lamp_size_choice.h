// burin/calib/photo/lamp_size_choice.h - detects lamps that are large relative to their distance: panels, softboxes.
// docs/model.md 9, 'Effects'.
//
// A small area light changes other estimates little. Its test comes at the end, together with glare and the field of
// depth (field_choice.h). A large one changes everything: taken for a point, it makes grooves and face rougher by half,
// and moves the lamp by decimeters.
#pragma once

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// True if a lamp's size, by prior or estimate, exceeds a 25th of its distance.
bool any_large_lamp(const Problem& data, const State& state);

/// Seeks such lamps among those of Problem::size_sought. If the evidence is clear, it puts their size, and their sides
/// if there is evidence of these too, into state and stage and returns true. Otherwise both stay. Takes one look at the
/// photos' equations, and a fit or two if these predict a large lamp. The caller weighs the photos.
bool choose_large_lamps(const Problem& data, Stage& stage, State& state, const Progress& progress);

/// Tests lamps of known size for unequal sides, by a fit with sides. Puts the sides into state and stage if photos are
/// explained better by more than their scatter. The caller weighs the photos.
bool choose_sides(const Problem& data, Stage& stage, State& state, const Progress& progress);

}  // namespace burin
