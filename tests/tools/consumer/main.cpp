// Uses one thing of each room that another project links, and prints what it got.
#include <burin/base/threads.h>
#include <burin/calib/calibrate.h>
#include <burin/capture/session.h>
#include <burin/optimize/loss/adam.h>
#include <burin/optimize/machine_profile.h>
#include <burin/render/view_renderer.h>
#include <burin/scene/board.h>
#include <burin/scene/groove.h>

#include <cstdio>
#include <exception>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const burin::ThreadLimit two(2);
  const burin::Board board = burin::read_board(argv[1]);
  if (burin::machine_profile("grbl-spring").depth_table.rows.empty()) return 1;
  burin::Photo photo;
  photo.exposure_s = 0.01;
  photo.f_number = 10;
  std::printf("tags=%zu half_width_um=%.3f factor=%.6f adam=%zu threads=%d\n", board.tags.list.size(),
              burin::half_width_um(board.tool_width_um, board.material.depth_um), burin::exposure_factor(photo),
              burin::Adam(3).size(), burin::thread_count());
  try {
    burin::calibrate({}, board);
  } catch (const std::exception&) {
    return 0;  // a session without photos is refused, and not by a crash
  }
  return 1;
}
