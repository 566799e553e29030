// python/targets.h - pictures that the views of a scene are to show: the loss, and design()'s discrete search (guided
// start, re-insertion, pruning) for loops whose steps are a person's own. docs/model.md 6. Frame: board, mm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/optimize/design/design_views.h"
#include "burin/optimize/design/stroke_types.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/design_options.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"

namespace burin::python {

/// A loss with its derivatives, one entry per view.
struct TargetLoss {
  std::vector<double> view_loss, dE_dlog_exposure;
  std::vector<Image> dE_dradiance;
};

/// Scratches after a search, the exposures that fit them, and the rows that moved or stayed.
struct Searched {
  Scratches scratches;
  std::vector<double> log_exposure;
  std::vector<std::size_t> rows;
};

/// Pictures, one per view, on the pixels of a design. Calls from several threads wait for each other.
class Targets {
 public:
  using Stop = std::function<bool()>;

  /// `spec` has pictures in memory, in gray. Throws Error as prepare_views() does.
  Targets(DesignSpec spec, Board board, Bench bench, DesignOptions options);

  std::size_t views() const { return views_.size(); }
  int width() const { return views_.front().renderer.width(); }
  int height() const { return views_.front().renderer.height(); }
  const Image& picture(std::size_t view) const { return views_[view].target.picture; }
  const std::vector<Finding>& findings() const { return findings_; }

  /// Loss of DesignOptions::loss, of radiance (one channel) at these exposures.
  TargetLoss loss(std::span<const Image> radiance, const std::vector<double>& log_exposure);

  /// The exposures with which radiance is closest to the targets, beginning from `log_exposure`; and PSNR there, dB.
  std::vector<double> fitting(std::span<const Image> radiance, const std::vector<double>& log_exposure);
  std::vector<double> psnr_db(std::span<const Image> radiance, const std::vector<double>& log_exposure);

  /// As design() starts, with so many scratches. No rows.
  Searched start(std::size_t count, std::uint64_t seed, const Stop& stop);
  /// As design() searches between steps. Rows: those that moved. `share`: DesignOptions::relocate_share.
  Searched search(Scratches scratches, const std::vector<double>& log_exposure, double share, std::uint64_t seed,
                  const Stop& stop);
  /// As design() drops weak scratches. Rows: those that stay. `error`, `share`: drop_error, drop_share.
  Searched drop(const Scratches& scratches, const std::vector<double>& log_exposure, double error, double share,
                const Stop& stop);

 private:
  bool grooves_cut_each_other() const { return bench_.crossings == Crossings::deepest; }
  void render(const Scratches& scratches);
  void take(std::span<const Image> radiance, const std::vector<double>& log_exposure);
  StrokeRules rules_for(std::size_t count) const;
  double mean_length_mm(std::size_t count) const;
  double cover_of_pixel(const Scratches& scratches) const;

  std::mutex mutex_;
  DesignSpec spec_;
  Board board_;
  Bench bench_, search_bench_;
  DesignOptions options_;
  Metal metal_{bench_, board_};
  CarvingLimits limits_;
  std::vector<Finding> findings_;
  std::vector<WorkView> views_;
};

}  // namespace burin::python
