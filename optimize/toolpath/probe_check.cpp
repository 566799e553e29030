#include "burin/optimize/toolpath/probe_check.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "burin/base/error.h"
#include "burin/optimize/toolpath/gcode_line.h"
#include "burin/optimize/toolpath/release_check.h"

namespace burin {
namespace {

// Depth of a probing move such as "G38.2 Z-2.000 F60", which read_gcode_line() does not know; nothing for other lines.
std::optional<double> probing_depth(std::string_view line) {
  constexpr std::string_view kBegin = "G38.2 Z";
  if (!line.starts_with(kBegin)) return std::nullopt;
  line.remove_prefix(kBegin.size());
  double z = 0, feed = 0;
  const auto [z_end, z_error] = std::from_chars(line.data(), line.data() + line.size(), z, std::chars_format::fixed);
  line.remove_prefix(static_cast<std::size_t>(z_end - line.data()));
  if (z_error != std::errc() || !line.starts_with(" F")) return std::nullopt;
  line.remove_prefix(2);
  const auto [f_end, f_error] = std::from_chars(line.data(), line.data() + line.size(), feed, std::chars_format::fixed);
  if (f_error != std::errc() || f_end != line.data() + line.size()) return std::nullopt;
  if (!(feed >= 1 && feed <= kTouchFeed_mm_min)) return std::nullopt;
  return z;
}

class ProbingMachine {
 public:
  ProbingMachine(const MachineProfile& machine, const std::string& name, ReleaseCheck& release)
      : machine_(machine), name_(name), release_(release) {}

  void run(std::string_view line) {
    ++number_;
    if (ended_ && !line.empty()) error("stands behind the end");
    if (line == "(PROBEOPEN burin-probe.txt)" || line == "(PROBECLOSE)") return;
    if (line.size() > static_cast<std::size_t>(longest_line(machine_))) error("is longer than the machine reads");
    if (const auto depth = probing_depth(line))
      touch(*depth);
    else if (line == "G10 L20 P1 Z0")
      set_zero();
    else
      move(read_gcode_line(line, machine_, name_, number_));
  }

  // Touched places in their order; the first ones precede the final Z zero.
  const std::vector<Eigen::Vector2d>& touched_mm() const { return touched_mm_; }
  std::size_t zeros() const { return zeros_; }
  bool ended() const { return ended_; }

 private:
  [[noreturn]] void error(const std::string& what) const {
    fail(name_ + ":" + std::to_string(number_), what, "write the probing file again, and report this");
  }

  void require_ready() const {
    if (!mm_ || !absolute_) error("moves before millimeters and absolute coordinates are set (G21 G90)");
  }

  void touch(double depth_mm) {
    require_ready();
    if (!at_mm_.allFinite() || on_face_ || !(depth_mm < 0)) error("probes from no place above the face");
    touched_mm_.push_back(at_mm_);
    release_.judge_touch({{at_mm_.x(), at_mm_.y(), z_mm_}, {at_mm_.x(), at_mm_.y(), 0}, number_, false});
    on_face_ = true;
    lifted_ = false;
    z_mm_ = 0;
  }

  void set_zero() {
    if (!on_face_ || touched_mm_.size() > 2) error("sets Z zero elsewhere than on the face at the first point");
    ++zeros_;
  }

  void move(const GcodeLine& line) {
    // All permitted codes; any other could move the tool or change the meaning of words.
    constexpr std::array kG{0, 170, 210, 540, 900, 940};
    constexpr std::array kM{20, 50};
    const auto all_among = [](const std::vector<int>& codes, const auto& known) {
      return std::all_of(codes.begin(), codes.end(),
                         [&](int code) { return std::find(known.begin(), known.end(), code) != known.end(); });
    };
    if (!all_among(line.g, kG) || !all_among(line.m, kM) || line.home || line.percent)
      error("has a code that probing needs not");
    mm_ = mm_ || line.has_g(210);
    absolute_ = absolute_ || line.has_g(900);
    if (line.has_m(20)) {
      if (!lifted_) error("ends on the face");
      ended_ = true;
    }
    if (!line.has_axis()) return;
    require_ready();
    if (!line.has_g(0)) error("is no rapid move and no probing one");
    const Eigen::Vector3d from(at_mm_.x(), at_mm_.y(), z_mm_);
    if (line.has('Z')) {
      if (!(line['Z'] > 0)) error("goes down without probing");
      z_mm_ = line['Z'];
      on_face_ = false;
      lifted_ = line['Z'] >= machine_.safe_z_mm - rounded_mm_;
    }
    if (!line.has('X') && !line.has('Y')) return release_.judge({from, {from.x(), from.y(), z_mm_}, number_, false});
    if (!lifted_ || line.has('Z')) error("travels along the board without being lifted clear of it");
    at_mm_ = {line.has('X') ? line['X'] : at_mm_.x(), line.has('Y') ? line['Y'] : at_mm_.y()};
    release_.judge({from, {at_mm_.x(), at_mm_.y(), z_mm_}, number_, false});
    if (machine_.travel && at_mm_.allFinite() &&
        ((at_mm_.array() < machine_.travel->min_mm.array() - rounded_mm_).any() ||
         (at_mm_.array() > machine_.travel->max_mm.array() + rounded_mm_).any()))
      fail(name_ + ":" + std::to_string(number_), "goes where the machine's travel_mm ends",
           "make the carve area smaller, or correct travel_mm of the machine profile");
  }

  const MachineProfile& machine_;
  const std::string& name_;
  double rounded_mm_ = std::pow(10.0, -machine_.decimals);
  std::vector<Eigen::Vector2d> touched_mm_;
  Eigen::Vector2d at_mm_{NAN, NAN};
  double z_mm_ = NAN;
  ReleaseCheck& release_;
  std::size_t number_ = 0, zeros_ = 0;
  bool mm_ = false, absolute_ = false, lifted_ = false, on_face_ = false, ended_ = false;
};

}  // namespace

void fail_unless_probes(std::string_view gcode, const ProbePlan& plan, const MachineProfile& machine,
                        const std::string& name) {
  const Face even;
  ReleaseCheck release(plan.workpiece, machine, even);
  ProbingMachine probe(machine, name, release);
  for (std::string_view rest = gcode; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    probe.run(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  if (plan.points_mm.empty()) fail(name, "has no points to probe", "give a plan of probe_plan()");
  // The first point is touched twice before the rest, to find the face and then to set zero.
  std::vector<Eigen::Vector2d> planned(2, plan.points_mm.front());
  planned.insert(planned.end(), plan.points_mm.begin(), plan.points_mm.end());
  const double rounded_mm = std::pow(10.0, -machine.decimals);
  bool as_planned = probe.touched_mm().size() == planned.size() && probe.zeros() == 2 && probe.ended();
  for (std::size_t i = 0; as_planned && i < planned.size(); ++i)
    as_planned = (probe.touched_mm()[i] - planned[i]).norm() < rounded_mm;
  if (!as_planned)
    fail(name, "does not touch each planned point once, in order, and end", "write it again, and report this");
  release.fail_unless_safe(name);
}

}  // namespace burin
