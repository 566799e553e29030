// burin/scene/bench_of_board.h - one value for each number in both board.json and bench.json: roughness and depth of
// the grooves, roughness and reflectance of the face, the tool's width.
//
// Before the first measurement, board.json holds these numbers and a nominal bench.json may omit them. A contradiction
// between a nominal bench.json and board.json is an error; the message names both files. A measured bench.json holds
// the measured numbers and a copy of board.json's numbers at measurement time (`told`). A later change of board.json is
// an error too, because nobody measured the machine's result for the new numbers. Undetermined numbers follow
// board.json, unless the photos refute the prior (Cause::Kind::believed_refuted).
#pragma once

#include <filesystem>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Reads a bench.json for one board. Throws Error as read_bench() does, and for contradictions, with both files, fields
/// and values. A note in `findings` lists each unmeasured number from board.json.
Bench read_bench_of(const Board& board, const std::filesystem::path& board_file,
                    const std::filesystem::path& bench_file);

/// The second half of read_bench_of(), for a setup that was read before.
void settle_material(Bench& bench, const std::filesystem::path& bench_file, const Board& board,
                     const std::filesystem::path& board_file);

/// Aims each view with only an eye at the board's middle. The other functions here do it as well.
void aim_views(Bench& bench, const Board& board);

/// Copies the board's numbers into the setup's missing fields, without comparison. Serves to restore a prior.
void fill_material(Bench& bench, const Board& board);

// Checks that a camera sees a board and that a light reaches it. Numbers that are valid one by one may still show
// nothing together.

/// Throws Error with the view's name if the camera is in or behind the face of a flat board, or looks away from it.
void fail_unless_sees(const View& view, const Board& board);

/// Throws Error with the light's name if its intensity is zero, or if a lamp is in or behind the face of a flat board.
/// Several lights at once fail only if all of them fail.
void fail_unless_lights(const Light& light, const Board& board);

/// True if the camera's picture contains any place of a grid over the board.
bool is_in_picture(const Bench& bench, const View& view, const Board& board);

}  // namespace burin
