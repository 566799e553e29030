// burin/optimize/design/design_run.h - one design from its first line to its last: the stages that design() goes
// through, in their order, and what they hand on to one another. docs/model.md 6.
//
// Scratches are moved where they are wanted; in every look they are carried to the metal (carve), rendered there, and
// the gradient is brought back (pull_back). So a design is made for all that the bench says of its machine: fields,
// wear, crossings. Where the order of carving shows, the scratches are put into a short one before the last iterations,
// and stay in it.
//
// Everything that a stage needs stands in this class; what a stage does in detail stands in the files that it calls
// (design_views, design_start, relocate, weak_scratches, carving_budget, obey). One deadline counts for all stages.
//
// Steps and searches swing: an iterate may be worse than one before it. So each that is looked at as it will be carved
// is judged, and the best is taken back in the end.
// Frame: board, mm. Same seed, same bits, for any number of threads.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "burin/base/progress.h"
#include "burin/optimize/design/bright_part.h"
#include "burin/optimize/design/deadline.h"
#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/picture_pixels.h"
#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/optimize/design/view_limits.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/design_options.h"
#include "burin/optimize/design_result.h"
#include "burin/optimize/loss/adam.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/scratches.h"

namespace burin {

class DesignRun {
 public:
  DesignRun(const DesignRun&) = delete;
  DesignRun& operator=(const DesignRun&) = delete;

  /// All arguments must outlive it. Throws Error for options out of range.
  DesignRun(const DesignSpec& spec, const Board& board, const Bench& bench, const DesignOptions& options,
            const Progress& progress);

  /// All stages; to be called once.
  DesignResult run();

 private:
  // The stages.
  void take_stock();         // what is gone on from, and what is in the metal already
  void read_targets();       // views and their pictures; what cannot work is said here
  void place();              // scratches to start from; with fewer, if so many could not be carved in time
  void expose();             // brightnesses that suit the start
  void improve_start();      // each scratch searched a better place
  bool is_crowded();         // then the start is made anew, with fewer
  bool looks_too_closely();  // then the start is made anew, on fewer pixels
  void iterate();            // Adam, searches, and scratches that go (design_iterations.cpp)
  void obey_all_rules();     // the last word: ends on steps, pairs apart
  void measure();            // what each view will show

  // Parts of read_targets() and looks_too_closely().
  void lay_targets(std::vector<Finding>& found);
  bool take_fewer_pixels();  // where pixels are the design's to choose
  void look_at_the_carved();
  bool grooves_cut_each_other() const { return bench_.crossings == Crossings::deepest; }
  double cover_now() const;

  // Parts of place().
  void choose_stroke_rules();
  void start_strokes();
  bool start_with_fewer();
  bool start_with_less_to_cut();  // the same, where so many would be cut into too many pieces
  void join_carved();

  // The new scratches in a short carving order, their histories with them, on benches where the order shows.
  void put_in_carving_order(bool thoroughly);

  // Parts of iterate().
  void count_time();
  bool is_time_to_drop() const;
  void look(bool last, bool rendered);
  void look_as_carved(const LyingGrooves& grooves);
  enum class Exposed { as_optimized, best };
  double psnr_db(std::span<const WorkView> channels, Exposed exposed) const;
  bool psnr_is_minimized() const;
  void judge(Exposed exposed);
  void take_back_best();
  void forget_others();
  void record(bool last);
  void record_start();
  // To those who watch.
  void show(int iteration, double loss, const std::vector<double>& view_loss, std::optional<double> psnr_db);
  void show_start();
  void move_ends();
  bool searches_are_over() const;
  void settle_order();
  bool count_rims();
  void look_at_crossings();
  void leave_crossings(const WorkView& view, Image& image) const;
  double cover_of_pixel() const;
  void relocate_some();
  void relocate_cut_some();
  void drop_weak();
  void keep_to_budget(double allowed_s);
  void keep_to_part_of_budget();
  void move_shared();
  void spread_shared();
  void keep_only(const std::vector<std::size_t>& kept);
  Scratches new_ones() const;
  bool time_to_end();

  // Parts of measure().
  void warn_if_hardly_any_is_left();
  void measure_pictures();
  void measure_picture(std::span<const WorkView> channels, DesignedView& out) const;
  double eye_distance_mm() const;
  void measure_limits(const LyingGrooves& grooves);
  void measure_ghosts();
  void measure_for_eyes();

  void report(const char* stage, double fraction) const {
    if (progress_) progress_(stage, fraction);
  }
  std::vector<std::span<WorkView>> shown_views() { return shown_channels(views_); }
  bool starts_at_random() const { return !options_.from && options_.start == Start::random; }
  int asked_pixels() const { return options_.pixels > 0 ? options_.pixels : kUsualPixels; }
  std::size_t new_at_first() const {
    return options_.from ? from_.size() : static_cast<std::size_t>(spec_.scratches) - carved_.size();
  }
  bool optimizes_shared() const {
    return options_.optimize_width || options_.optimize_depth || options_.optimize_alpha;
  }

  const DesignSpec& spec_;
  const Board& board_;
  const Bench& bench_;
  const DesignOptions& options_;
  const Progress& progress_;
  const Metal metal_{bench_, board_};
  // While places are searched, grooves that cut each other's rims away are taken whole: their many pieces take twenty
  // times as long. What they take from each other is seen now and then (crossing_loss).
  const Bench search_bench_ = adding_rims(bench_), even_bench_ = without_fields(search_bench_);
  bool rims_count_ = !grooves_cut_each_other();
  Deadline deadline_;
  CarvingLimits limits_;
  DesignResult result_;

  std::size_t findings_before_start_ = 0, too_many_to_cut_ = 0;
  std::vector<ViewLimits> view_limits_;  // a picture
  std::vector<WorkView> views_;          // first the spec's, in color three each; the rest stand aside of these
  std::size_t shown_ = 0;                // pictures, each of a view of the spec
  std::vector<Image> color_pictures_;    // what those who watch are shown last
  std::vector<double> log_exposure_;     // one a group
  StrokeRules rules_;
  double mean_length_mm_ = 0;

  // The new ones come first, `movable_` of them; then those that are carved already, which never change.
  Scratches from_, carved_;
  Designed designed_;
  Scratches& scratches_ = designed_.scratches;
  std::size_t movable_ = 0;
  std::size_t count() const { return scratches_.size(); }
  LyingGrooves in_the_metal() const { return in_the_metal(rims_count_); }
  LyingGrooves in_the_metal(bool cut) const;

  // What iterate() carries from step to step.
  struct Momenta {
    Adam x0, y0, x1, y1, exposure, shared;
    template <typename Do>
    void each_end(const Do& f) {
      for (Adam* adam : {&x0, &y0, &x1, &y1}) f(*adam);
    }
  };
  std::vector<double> log_shared_;  // width, depth, alpha
  // What a look at the grooves as they will be carved came to. `merit`: more is better.
  struct Iterate {
    Scratches scratches;
    std::vector<double> log_exposure, log_shared;
    std::size_t movable = 0, dropped = 0;
    double loss_before_drop = 0, merit = 0;
    bool exactly = true;  // nothing of it was held (bright_part.h), at the exposures that show it best
  };
  Iterate as_looked_at(bool exactly) const;
  void go_back_to(const Iterate& iterate);
  std::optional<Iterate> best_;
  double merit_ = 0;                         // of the last look
  std::optional<double> looked_db_;          // mean of the views, of this iteration's look as carved
  std::optional<DesignIteration> cut_look_;  // of this iteration, while grooves are searched whole
  Momenta momenta_{Adam(0), Adam(0), Adam(0), Adam(0), Adam(0), Adam(0)};
  Image dE_dpicture_, dE_dradiance_;        // of the view that is looked at
  ScratchGradients gradients_, by_carved_;  // by the designed rows, and by the grooves in the metal
  std::vector<double> d_log_exposure_;
  std::vector<BrightPart> bright_;  // one a view
  std::vector<int> contact_;        // iterations kept for the contact sheet
  int pixels_ = 0;                  // along the carve area's longer side
  int iteration_ = 0, drop_at_ = 0;
  double first_rate_ = 0, last_rate_ = 0;
  double full_carving_s_ = 0;  // what it would take to carve all that the iterations began with
  double iterations_began_s_ = 0;
  double look_s_ = 0;     // what it took when all grooves were last looked at as they will be carved
  double time_part_ = 0;  // of the iterations, by the time limit: 0 without one
  double part_ = 0;       // of the iterations, by their number or the time limit, if that is more
  bool weak_dropped_ = false;
  bool in_last_order_ = false;  // nothing is searched any more that would leave the carving order
};

}  // namespace burin
