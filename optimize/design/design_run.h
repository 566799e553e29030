// burin/optimize/design/design_run.h - one design from start to end: the stages of design(), their order and their
// shared state. docs/model.md 6.
//
// Scratches move at their desired positions. Every evaluation carves them (carve), renders the carved grooves, and
// brings the gradient back (pull_back). A design therefore accounts for all properties of its machine in the bench:
// fields, wear, crossings. If the carving order shows, the scratches get a short order before the last iterations and
// keep it.
//
// This class holds the state of all stages. Other files hold their details (design_views, design_start, relocate,
// weak_scratches, carving_budget, obey). One deadline covers all stages.
//
// Steps and searches oscillate: an iterate may be worse than its predecessor. The run judges each iterate evaluated as
// carved, and returns to the best one in the end. Frame: board, mm. The same seed gives the same bits for any number of
// threads.
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

  /// All arguments must outlive this object. Throws Error for options out of range.
  DesignRun(const DesignSpec& spec, const Board& board, const Bench& bench, const DesignOptions& options,
            const Progress& progress);

  /// Runs all stages; call it once.
  DesignResult run();

 private:
  // The stages.
  void take_stock();         // initial scratches, if given, and existing grooves
  void read_targets();       // views and their pictures; reports impossible pictures
  void place();              // initial scratches; fewer if so many could not be carved in time
  void expose();             // exposures for the start
  void improve_start();      // a better place for each scratch
  bool is_crowded();         // if true, the start is repeated with fewer
  bool looks_too_closely();  // if true, the start is repeated on fewer pixels
  void iterate();            // Adam, searches, and pruning (design_iterations.cpp)
  void obey_all_rules();     // final projection: ends on steps, pairs apart
  void measure();            // predicted pictures of all views

  // Parts of read_targets() and looks_too_closely().
  void lay_targets(std::vector<Finding>& found);
  bool take_fewer_pixels();  // if the design may choose its pixels
  void look_at_the_carved();
  bool grooves_cut_each_other() const { return bench_.crossings == Crossings::deepest; }
  double cover_now() const;

  // Parts of place().
  void choose_stroke_rules();
  void start_strokes();
  bool start_with_fewer();
  bool start_with_less_to_cut();  // the same, if so many would be cut into too many pieces
  void join_carved();

  // Puts the new scratches, with their histories, in a short carving order, on benches whose carving order shows.
  void put_in_carving_order(bool thoroughly);

  // Parts of iterate().
  void count_time();
  bool is_time_to_drop() const;
  void look(bool last, bool rendered);
  enum class Faint { anew, held };
  void look_as_carved(const LyingGrooves& grooves, Faint faint);
  std::vector<Image> uncut_radiances(const std::vector<BrightPart>& parts, const Carved& whole);
  enum class Exposed { as_optimized, best };
  double psnr_db(std::span<const WorkView> channels, Exposed exposed) const;
  bool psnr_is_minimized() const;
  void judge(Exposed exposed, bool exactly);
  void take_back_best();
  void forget_others();
  void record(bool last);
  void record_start();
  // Calls of the observer.
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
  int asked_pixels() const;
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
  const int iterations_;  // all of them
  const Metal metal_{bench_, board_};
  // Searches use whole grooves if grooves cut each other's rims away, because their many pieces take twenty times as
  // long. Their loss of light is rendered now and then (crossing_loss).
  const Bench search_bench_ = adding_rims(bench_), even_bench_ = without_fields(search_bench_);
  bool rims_count_ = !grooves_cut_each_other();
  Deadline deadline_;
  CarvingLimits limits_;
  DesignResult result_;

  std::size_t findings_before_start_ = 0, too_many_to_cut_ = 0;
  std::vector<ViewLimits> view_limits_;  // one per picture
  std::vector<WorkView> views_;          // first the spec's, three per view in color; then their off-axis viewpoints
  std::size_t shown_ = 0;                // number of pictures in place, each of a view of the spec
  std::vector<Image> color_pictures_;    // pictures of the latest DesignFrame
  std::vector<double> log_exposure_;     // one per group
  StrokeRules rules_;
  double mean_length_mm_ = 0;

  // The new scratches come first, `movable_` of them. Existing grooves follow; they never change.
  Scratches from_, carved_;
  Designed designed_;
  Scratches& scratches_ = designed_.scratches;
  std::size_t movable_ = 0;
  std::size_t count() const { return scratches_.size(); }
  LyingGrooves in_the_metal() const { return in_the_metal(rims_count_); }
  LyingGrooves in_the_metal(bool cut) const;

  // State of iterate().
  struct Momenta {
    Adam x0, y0, x1, y1, exposure, shared;
    template <typename Do>
    void each_end(const Do& f) {
      for (Adam* adam : {&x0, &y0, &x1, &y1}) f(*adam);
    }
  };
  std::vector<double> log_shared_;  // width, depth, alpha
  // Result of an evaluation as carved. `merit`: higher is better.
  struct Iterate {
    Scratches scratches;
    std::vector<double> log_exposure, log_shared;
    std::size_t movable = 0, dropped = 0;
    double loss_before_drop = 0, merit = 0;
    bool exactly = true;  // nothing was held (bright_part.h), at the best exposures
  };
  Iterate as_looked_at(bool exactly) const;
  void go_back_to(const Iterate& iterate);
  std::optional<Iterate> best_;
  double merit_ = 0;                         // of the last evaluation
  std::optional<double> looked_db_;          // mean of the views, of this iteration's evaluation as carved
  std::optional<DesignIteration> cut_look_;  // of this iteration, if grooves are searched whole
  Momenta momenta_{Adam(0), Adam(0), Adam(0), Adam(0), Adam(0), Adam(0)};
  Image dE_dpicture_, dE_dradiance_;        // of the view under evaluation
  ScratchGradients gradients_, by_carved_;  // by the designed rows, and by the grooves in the metal
  std::vector<double> d_log_exposure_;
  std::vector<BrightPart> bright_;  // one per view
  std::vector<BrightPart> cut_;     // the same, of looks as carved while grooves are searched whole
  std::vector<int> contact_;        // iterations kept for the contact sheet
  int pixels_ = 0;                  // along the carve area's longer side
  int iteration_ = 0, drop_at_ = 0;
  double first_rate_ = 0, last_rate_ = 0;
  double full_carving_s_ = 0;  // carving time of all scratches at the start of the iterations
  double iterations_began_s_ = 0;
  double look_s_ = 0;     // duration of the last evaluation of all grooves as carved
  double time_part_ = 0;  // of the iterations, by the time limit: 0 without one
  double part_ = 0;       // of the iterations: the larger of the parts by number and by time limit
  bool weak_dropped_ = false;
  bool in_last_order_ = false;  // no further search may leave the carving order
};

}  // namespace burin
