// tools/view/bench_scene.h - three-dimensional view of the bench for a web page: board, eyes, lamps, uncertainties of
// their places, and tolerances of the eyes. Mouse, finger or arrow keys turn it. Frame: board, mm.
//
// A page includes it in three steps:
// 1. Put bench_scene_html() at the place of each scene.
// 2. Put bench_scene_style() into its own <style>, and bench_scene_script() into its own <script> at the end of <body>.
//    The script finds all scenes.
// 3. List both texts in content_policy() (tools/content_policy.h), exactly as between the tags.
//
// The data is in a <script type="application/json">, which no policy treats as a script. Without scripts, the page
// shows a list of the places in words.
#pragma once

#include <string>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "tools/match_views.h"

namespace burin {

/// Returns the scene's data as JSON for tools/view/bench_scene.js. `tolerances`: by shown_tolerances(), drawn as rings
/// on the floor around the eyes; may be empty.
std::string bench_scene_json(const Board& board, const Bench& bench, const std::vector<MatchTolerance>& tolerances);

/// Returns the scene as an HTML element. `alt` describes it in one sentence.
std::string bench_scene_html(const Board& board, const Bench& bench, const std::vector<MatchTolerance>& tolerances,
                             const std::string& alt);

/// Returns the script, which a page contains once for any number of scenes.
std::string bench_scene_script();
/// Returns the style, which a page contains once for any number of scenes.
std::string bench_scene_style();

/// Escapes JSON for a <script>: "<" is written so that it cannot start an end tag.
std::string json_in_page(std::string json);

}  // namespace burin
