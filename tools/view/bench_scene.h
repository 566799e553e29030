// tools/view/bench_scene.h - the bench in three dimensions for a web page: board, eyes, lamps, how uncertain each place
// is, and how far an eye may stand aside. Turned by mouse, finger or arrow keys. Frame: board, mm.
//
// Any page takes it in three steps:
//   1. put bench_scene_html() where the scene is to stand (as many scenes as wanted),
//   2. put bench_scene_style() into a <style> of its own and bench_scene_script() into a <script> of its own at the end
//   of
//      <body>: the script finds the scenes by itself,
//   3. name both texts in content_policy() (tools/content_policy.h), just as they stand between the tags.
// The data lies in a <script type="application/json">, which is no script to a policy. Without scripts a list of the
// places in words is shown instead.
#pragma once

#include <string>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "tools/match_views.h"

namespace burin {

/// What the scene shows, as the JSON that tools/view/bench_scene.js reads. `tolerances`: by shown_tolerances(), for
/// rings on the floor around the eyes of views that have one; may be empty.
std::string bench_scene_json(const Board& board, const Bench& bench, const std::vector<MatchTolerance>& tolerances);

/// The scene as an element of a page. `alt` says in one sentence what is to be seen.
std::string bench_scene_html(const Board& board, const Bench& bench, const std::vector<MatchTolerance>& tolerances,
                             const std::string& alt);

/// What goes into the page once, whatever the number of scenes.
std::string bench_scene_script();
/// As bench_scene_script().
std::string bench_scene_style();

/// JSON as it may stand inside a <script>: "<" is written so that no end tag can come of it.
std::string json_in_page(std::string json);

}  // namespace burin
