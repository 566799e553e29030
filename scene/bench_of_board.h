// burin/scene/bench_of_board.h - one truth for the numbers that board.json and bench.json both know: roughness and
// depth of the grooves, roughness and reflectance of the face, the tool's width.
//
// Before a board was measured they stand in board.json, and a nominal bench.json may leave them out; one that says
// something else is an error that names both. What photos measured stands in the measured bench.json, beside what
// board.json said then (`told`): a board.json that says something else by now is an error too, because what the machine
// makes of it was not measured. What photos were to tell and did not is still board.json's, unless they speak against
// what was believed then (Cause::Kind::believed_refuted).
#pragma once

#include <filesystem>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Reads a bench.json as it holds for a board. Throws Error as read_bench() does, and for contradictions, with both
/// files, fields and values. A note among `findings` says where a number that was not measured follows board.json.
Bench read_bench_of(const Board& board, const std::filesystem::path& board_file,
                    const std::filesystem::path& bench_file);

/// The same for a bench that was read before.
void settle_material(Bench& bench, const std::filesystem::path& bench_file, const Board& board,
                     const std::filesystem::path& board_file);

/// Views that are said by their eye alone look at the board's middle. The other functions here do it as well.
void aim_views(Bench& bench, const Board& board);

/// What the bench leaves out becomes the board's; nothing is compared. For looking back at what was believed once.
void fill_material(Bench& bench, const Board& board);

// Whether a camera looks at a board and a light reaches it: numbers that are sound one by one may show nothing
// together.

/// Throws Error naming the view where its camera lies in or behind the face of a flat board, or looks away from it.
void fail_unless_sees(const View& view, const Board& board);

/// Throws Error naming the light where it shines with no intensity, or a lamp lies in or behind the face of a flat
/// board. Of several at once, where that holds for all.
void fail_unless_lights(const Light& light, const Board& board);

/// Whether any of a grid of places over the board lies in the camera's picture.
bool is_in_picture(const Bench& bench, const View& view, const Board& board);

}  // namespace burin
