// Finding the pairs of pixels and scratches, 80,000 scratches in 512 x 512 pixels, one thread: rasterized
// (burin/render/fast/pairs.h) and by Embree, side by side, with how many of the true pairs each misses.
//
// Embree's complete recipe: a scratch is a flat ribbon whose half-width is the groove's plus the largest radius of a
// footprint, its ends lengthened by that radius too; one ray through each footprint's center, straight down, reports
// every ribbon that it meets. A footprint and a strip that share a point then cannot be missed. The paper's recipe
// (supplement, 1.1) leaves out the groove's half-width and the ends. The tree is built anew every time, as scratches
// move in every iteration; `build_ms` is its share.
//
// `missed` and `in_vain` are shares of the true pairs, counted over 2,000 of the scratches and all pixels against
// separating axes of both quadrilaterals.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "burin/render/fast/pairs.h"
#include "burin/render/fast/strip_runs.h"
#include "burin/scene/embree_rays.h"
#include "tests/bench/paper_scene.h"
#include "tests/render/quadrilaterals.h"

namespace burin {
namespace {

constexpr int kScratches = 80000, kPixels = 512;

/// Pixel and scratch.
using Pair = std::pair<std::uint32_t, std::uint32_t>;

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::vector<Strip> all_strips(const ViewScene& scene, int count = kScratches) {
  return strips_of(paper_scratches(count), scene.tool_width_um, scene.material);
}

/// Every fortieth.
std::vector<Strip> some_of(const std::vector<Strip>& strips) {
  std::vector<Strip> some;
  for (std::size_t i = 0; i < strips.size(); i += 40) some.push_back(strips[i]);
  return some;
}

/// The largest distance from a footprint's center to its corners, mm.
double footprint_radius_mm(const FootprintGrid& grid) {
  double radius = 0;
  for (int r = 0; r < grid.height(); ++r)
    for (int c = 0; c < grid.width(); ++c)
      for (const Eigen::Vector2d& q : footprint_corners_mm(grid, c, r))
        radius =
            std::max(radius, (q - grid.center_mm[static_cast<std::size_t>(r) * grid.width() + c].head<2>()).norm());
  return radius;
}

/// All pairs that share more than rounding, by brute force.
std::vector<Pair> true_pairs(const FootprintGrid& grid, const std::vector<Strip>& strips) {
  const double radius = footprint_radius_mm(grid);
  std::vector<Pair> pairs;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    const Corners strip = strip_corners(strips[s]);
    const Eigen::Vector2d d = strips[s].p1_mm - strips[s].p0_mm;
    for (std::size_t i = 0; i < grid.center_mm.size(); ++i) {
      // Too far from the line between the ends to touch.
      const Eigen::Vector2d q = grid.center_mm[i].head<2>() - strips[s].p0_mm;
      const double along = std::clamp(q.dot(d) / d.squaredNorm(), 0.0, 1.0);
      if ((q - along * d).norm() > radius + strips[s].half_width_mm + 1e-6) continue;
      const int c = static_cast<int>(i) % grid.width(), r = static_cast<int>(i) / grid.width();
      if (overlap_mm(footprint_corners_mm(grid, c, r), strip) > 1e-9)
        pairs.emplace_back(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(s));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

void report_pairs(benchmark::State& state, std::vector<Pair> found, const std::vector<Pair>& exact) {
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::vector<Pair> both;
  std::set_intersection(found.begin(), found.end(), exact.begin(), exact.end(), std::back_inserter(both));
  const auto all = static_cast<double>(exact.size());
  state.counters["missed"] = (all - static_cast<double>(both.size())) / all;
  state.counters["in_vain"] = static_cast<double>(found.size() - both.size()) / all;
}

/// `pairs` found in each iteration, and time for each.
void report_time(benchmark::State& state, std::size_t pairs) {
  state.counters["pairs"] = static_cast<double>(pairs);
  state.counters["ns/pair"] =
      benchmark::Counter(1e-9 * static_cast<double>(pairs) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// Finds pairs as the fast path does, and only counts them: what finding alone costs. Buffers are kept from one count()
/// to the next.
class PairCounter {
 public:
  PairCounter(const PixelIndex& index, const std::vector<Strip>& strips) : index_(index), strips_(index, strips) {}

  std::size_t count() {
    count_.assign(index_.tiles().size(), 0);
    strips_.sort(index_);
    strips_.each_tile(index_, SimdWidth::best, [&](std::size_t t, const TilePlaces& pairs) {
      count_[t] = pairs.begin[strips_.runs().count(t)];
    });
    return std::accumulate(count_.begin(), count_.end(), std::size_t{0});
  }

 private:
  const PixelIndex& index_;
  StripRuns strips_;
  std::vector<std::size_t> count_;
};

void FindPairsByRaster(benchmark::State& state) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ViewScene scene = paper_scene(paper_grid(kPixels));
  const PixelIndex index(*scene.grid);
  const std::vector<Strip> strips = all_strips(scene);
  PairCounter counter(index, strips);
  std::size_t pairs = 0;
  for (auto _ : state) pairs = counter.count();
  report_time(state, pairs);

  const std::vector<Strip> some = some_of(strips);
  std::vector<Pair> found;
  std::vector<PixelSpan> spans;
  for (std::size_t s = 0; s < some.size(); ++s) {
    spans.clear();
    find_spans(index, some[s], spans);
    for (const PixelSpan& span : spans)
      for (int c = span.begin; c < span.end; ++c)
        found.emplace_back(span.row * kPixels + c, static_cast<std::uint32_t>(s));
  }
  report_pairs(state, found, true_pairs(*scene.grid, some));
}
BENCHMARK(FindPairsByRaster)->Unit(benchmark::kMillisecond);

/// Ribbons on the face, and the rays that find them.
class Ribbons {
 public:
  /// `widen_mm` is added to the half-widths, `lengthen_mm` to either end; `half_width_share` of the groove's own
  /// counts.
  Ribbons(RTCDevice device, const std::vector<Strip>& strips, double widen_mm, double lengthen_mm, double groove_share)
      : scene_(rtcNewScene(device)) {
    RTCGeometry curves = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(curves, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                                 4 * sizeof(float), 2 * strips.size()));
    auto* first = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(curves, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof(unsigned), strips.size()));
    for (std::size_t s = 0; s < strips.size(); ++s) {
      const Eigen::Vector2d along = (strips[s].p1_mm - strips[s].p0_mm).normalized() * lengthen_mm;
      const Eigen::Vector2d ends[2] = {strips[s].p0_mm - along, strips[s].p1_mm + along};
      for (const Eigen::Vector2d& end : ends) {
        *vertices++ = static_cast<float>(end.x());
        *vertices++ = static_cast<float>(end.y());
        *vertices++ = 0;
        *vertices++ = static_cast<float>(widen_mm + groove_share * strips[s].half_width_mm);
      }
      first[s] = static_cast<unsigned>(2 * s);
    }
    rtcSetGeometryOccludedFilterFunction(curves, note);
    rtcCommitGeometry(curves);
    rtcAttachGeometry(scene_, curves);
    rtcReleaseGeometry(curves);
    rtcCommitScene(scene_);
  }
  ~Ribbons() { rtcReleaseScene(scene_); }
  Ribbons(const Ribbons&) = delete;
  Ribbons& operator=(const Ribbons&) = delete;

  void find(const FootprintGrid& grid, std::vector<Pair>& pairs) const {
    Context context{};
    init_query(context.base);
    context.pairs = &pairs;
    for (std::size_t i = 0; i < grid.center_mm.size(); ++i) {
      RTCRay ray{};
      ray.org_x = static_cast<float>(grid.center_mm[i].x());
      ray.org_y = static_cast<float>(grid.center_mm[i].y());
      ray.org_z = 1;
      ray.dir_z = -1;
      ray.tfar = 2;
      ray.mask = ~0U;
      context.pixel = static_cast<std::uint32_t>(i);
      any_hit(scene_, context.base, true, ray);
    }
  }

 private:
  struct Context {
    QueryContext base;
    std::vector<Pair>* pairs;
    std::uint32_t pixel;
  };

  /// Notes what the ray meets and lets it go on.
  static void note(const RTCFilterFunctionNArguments* call) {
    auto* context = reinterpret_cast<Context*>(call->context);
    context->pairs->emplace_back(context->pixel, RTCHitN_primID(call->hit, call->N, 0));
    call->valid[0] = 0;
  }

  RTCScene scene_;
};

/// `complete`: or the paper's recipe.
void FindPairsByEmbree(benchmark::State& state, bool complete, int count) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  RTCDevice device = rtcNewDevice("threads=1");
  const ViewScene scene = paper_scene(paper_grid(kPixels));
  const std::vector<Strip> strips = all_strips(scene, count);
  // A millionth more for float.
  const double radius = (1 + 1e-6) * footprint_radius_mm(*scene.grid) + 1e-6 * kPaperBoard_mm;
  const auto ribbons_of = [&](const std::vector<Strip>& s) {
    return Ribbons(device, s, radius, complete ? radius : 0, complete ? 1 : 0);
  };
  std::vector<Pair> pairs;
  double building = 0;
  for (auto _ : state) {
    pairs.clear();
    const double start = seconds();
    const Ribbons ribbons = ribbons_of(strips);
    building += seconds() - start;
    ribbons.find(*scene.grid, pairs);
    benchmark::DoNotOptimize(pairs.data());
  }
  report_time(state, pairs.size());
  state.counters["build_ms"] = 1e3 * building / static_cast<double>(state.iterations());

  const std::vector<Strip> some = some_of(strips);
  std::vector<Pair> found;
  ribbons_of(some).find(*scene.grid, found);
  report_pairs(state, found, true_pairs(*scene.grid, some));
  rtcReleaseDevice(device);
}
BENCHMARK_CAPTURE(FindPairsByEmbree, complete, true, kScratches)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(FindPairsByEmbree, as_in_the_paper, false, kScratches)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(FindPairsByEmbree, for_peers, false, 40000)->Unit(benchmark::kMillisecond);  // peers/drjit_pairs.py

}  // namespace
}  // namespace burin
