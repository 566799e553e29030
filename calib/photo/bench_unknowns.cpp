#include "burin/calib/photo/bench_unknowns.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burin/calib/light/lamp_area.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/calib/photo/stray_light.h"

namespace burin {
namespace {

// Reads the unknown whose first index is `first` from a bench, and writes it. `light`: the lamp's index, for a lamp's
// unknowns.
struct Link {
  int first;
  void (*read)(const Bench& bench, const Problem& problem, std::size_t light, double* to);
  void (*write)(const double* from, const Problem& problem, std::size_t light, Bench& bench);
};

template <double Material::*Field>
constexpr Link of_material(int first) {
  return {first, [](const Bench& b, const Problem&, std::size_t, double* to) { *to = std::log(b.material.*Field); },
          [](const double* from, const Problem&, std::size_t, Bench& b) { b.material.*Field = std::exp(*from); }};
}

template <int First, int Count>
constexpr Link of_depth_field() {
  return {unknown::depth_field + First,
          [](const Bench& b, const Problem&, std::size_t, double* to) {
            std::copy_n(b.depth_field.terms.begin() + First, Count, to);
          },
          [](const double* from, const Problem&, std::size_t, Bench& b) {
            std::copy_n(from, Count, b.depth_field.terms.begin() + First);
          }};
}

template <int Axis>
constexpr Link of_backlash() {
  return {
      unknown::backlash + Axis,
      [](const Bench& b, const Problem&, std::size_t, double* to) { *to = b.machine_errors.backlash_mm[Axis]; },
      [](const double* from, const Problem&, std::size_t, Bench& b) { b.machine_errors.backlash_mm[Axis] = *from; }};
}
template <int Axis>
constexpr Link of_screw() {
  return {unknown::screw + 2 * Axis,
          [](const Bench& b, const Problem&, std::size_t, double* to) {
            to[0] = b.machine_errors.screw_sin_mm[Axis];
            to[1] = b.machine_errors.screw_cos_mm[Axis];
          },
          [](const double* from, const Problem&, std::size_t, Bench& b) {
            b.machine_errors.screw_sin_mm[Axis] = from[0];
            b.machine_errors.screw_cos_mm[Axis] = from[1];
          }};
}
template <int Axis>
constexpr Link of_screw_period() {
  return {unknown::screw_period + Axis,
          [](const Bench& b, const Problem&, std::size_t, double* to) {
            *to = std::log(b.machine_errors.screw_period_mm[Axis]);
          },
          [](const double* from, const Problem&, std::size_t, Bench& b) {
            b.machine_errors.screw_period_mm[Axis] = std::exp(*from);
          }};
}

// An unmodeled light; without one its numbers are 0, except a nearness, so none is infinite.
template <int First, int Count>
void read_stray(const Bench& b, const Problem& p, std::size_t, double* to) {
  const StrayNumbers numbers = b.stray ? stray_numbers(*b.stray, p.model.board->size_mm) : StrayNumbers{0, 0, 1, 0, 0};
  std::copy_n(numbers.begin() + First, Count, to);
}
template <int First, int Count>
constexpr Link of_stray() {
  return {unknown::stray + First, read_stray<First, Count>,
          [](const double*, const Problem&, std::size_t, Bench&) {}};  // written with the last one, which follows
}

// The lamp's position comes before its axis, which is written from both.
constexpr auto kLinks = std::to_array<Link>({
    of_material<&Material::alpha>(unknown::log_alpha),
    of_material<&Material::depth_um>(unknown::log_depth),
    of_material<&Material::base_alpha>(unknown::log_base_alpha),
    of_depth_field<0, 2>(),
    of_depth_field<2, 3>(),
    of_depth_field<5, 1>(),
    {unknown::machine,
     [](const Bench& b, const Problem& p, std::size_t, double* to) {
       double* x = to - unknown::machine;
       put_machine_map(machine_map(b.machine_affine, p.model.center_mm), x);
     },
     [](const double* from, const Problem& p, std::size_t, Bench& b) {
       b.machine_affine = affine_of(machine_map(from - unknown::machine), p.model.center_mm);
     }},
    of_backlash<0>(),
    of_backlash<1>(),
    of_screw<0>(),
    of_screw<1>(),
    of_screw_period<0>(),
    of_screw_period<1>(),
    {unknown::grain,
     [](const Bench& b, const Problem&, std::size_t, double* to) {
       to[0] = b.material.grain.c;
       to[1] = b.material.grain.s;
     },
     [](const double* from, const Problem&, std::size_t, Bench& b) {
       b.material.grain = {from[0], from[1]};
     }},
    {unknown::flank,
     [](const Bench& b, const Problem&, std::size_t, double* to) { *to = b.material.profile.flank_deg; },
     [](const double* from, const Problem& p, std::size_t, Bench& b) {
       b.material.profile.kind = p.model.profile.kind;
       b.material.profile.tip_radius_um = p.model.profile.tip_radius_um;
       b.material.profile.flank_deg = *from;
     }},
    {unknown::burrs,
     [](const Bench& b, const Problem&, std::size_t, double* to) { *to = b.material.profile.burr_left_um; },
     [](const double* from, const Problem&, std::size_t, Bench& b) {
       b.material.profile.burr_left_um = std::max(0.0, *from);
     }},
    {unknown::burrs + 1,
     [](const Bench& b, const Problem&, std::size_t, double* to) { *to = b.material.profile.burr_right_um; },
     [](const double* from, const Problem&, std::size_t, Bench& b) {
       b.material.profile.burr_right_um = std::max(0.0, *from);
     }},
    {unknown::burr_width,
     [](const Bench& b, const Problem&, std::size_t, double* to) { *to = std::log(b.material.profile.burr_width_um); },
     [](const double* from, const Problem&, std::size_t, Bench& b) {
       b.material.profile.burr_width_um = std::exp(*from);
     }},
    {unknown::log_across,
     [](const Bench& b, const Problem&, std::size_t, double* to) { *to = std::log(b.material.profile.across); },
     [](const double* from, const Problem&, std::size_t, Bench& b) { b.material.profile.across = std::exp(*from); }},
    {unknown::ambient,
     [](const Bench& b, const Problem& p, std::size_t, double* to) { *to = p.surroundings ? 1 : b.ambient.mean(); },
     [](const double* from, const Problem& p, std::size_t, Bench& b) {
       b.ambient.setConstant(p.surroundings ? 0 : *from);  // a scale goes into the surroundings (put_state)
     }},
    {unknown::vignette,
     [](const Bench& b, const Problem&, std::size_t, double* to) { std::copy_n(b.sensor.vignette.data(), 3, to); },
     [](const double* from, const Problem&, std::size_t, Bench& b) { std::copy_n(from, 3, b.sensor.vignette.data()); }},
    {unknown::log_blur,
     [](const Bench& b, const Problem& p, std::size_t, double* to) {
       constexpr double kBlurAtFirstPx = 0.6;
       *to = std::log(b.sensor.psf_sigma_px > 0 ? b.sensor.psf_sigma_px / p.merged_bin : kBlurAtFirstPx);
     },
     [](const double* from, const Problem& p, std::size_t, Bench& b) {
       b.sensor.psf_sigma_px = p.merged_bin * std::exp(*from);
     }},
    {unknown::glare_share, [](const Bench& b, const Problem&, std::size_t, double* to) { *to = b.sensor.glare.share; },
     [](const double* from, const Problem&, std::size_t, Bench& b) { b.sensor.glare.share = *from; }},
    of_stray<kStraySlopeX, 2>(),
    of_stray<kStrayNearness, 1>(),
    of_stray<kStrayIrradiance, 1>(),
    {unknown::stray_spread2, read_stray<kStraySpread2, 1>,
     [](const double* from, const Problem& p, std::size_t, Bench& b) {  // with the others, which precede it
       const StrayNumbers numbers = stray_numbers(from - kStraySpread2);
       b.stray.reset();
       if (numbers[kStrayIrradiance] > 0) b.stray = stray_light(numbers, p.model.board->size_mm);
     }},
    {unknown::lamp_position,
     [](const Bench& b, const Problem&, std::size_t light, double* to) {
       std::copy_n(b.lights[light].position_mm.data(), 3, to);
     },
     [](const double* from, const Problem&, std::size_t light, Bench& b) {
       std::copy_n(from, 3, b.lights[light].position_mm.data());
     }},
    {unknown::log_intensity,
     [](const Bench& b, const Problem&, std::size_t light, double* to) {
       *to = std::log(std::max(1e-12, b.lights[light].intensity.mean()));
     },
     [](const double* from, const Problem&, std::size_t light, Bench& b) {
       b.lights[light].intensity.setConstant(std::exp(*from));
     }},
    {unknown::spot,
     [](const Bench& b, const Problem& p, std::size_t light, double* to) {
       const Light& l = b.lights[light];
       const Eigen::Vector2d aim =
           l.axis.z() < 0 ? Eigen::Vector2d((l.position_mm - l.axis * (l.position_mm.z() / l.axis.z())).head<2>())
                          : p.model.center_mm;
       to[0] = aim.x();
       to[1] = aim.y();
     },
     [](const double* from, const Problem&, std::size_t light, Bench& b) {
       Light& l = b.lights[light];
       l.axis = (Eigen::Vector3d(from[0], from[1], 0) - l.position_mm).normalized();
     }},
    {unknown::spot + 2,
     [](const Bench& b, const Problem&, std::size_t light, double* to) { *to = b.lights[light].falloff_exponent; },
     [](const double* from, const Problem& p, std::size_t light, Bench& b) {
       b.lights[light].falloff_exponent = p.is_spot[light] ? *from : 0;
     }},
    {unknown::size2,
     [](const Bench& b, const Problem& p, std::size_t light, double* to) {
       *to = lamp_area(b.lights[light].size, size_unit_mm(*p.model.board)).size2;
     },
     [](const double*, const Problem&, std::size_t, Bench&) {}},  // written with the sides, which follow
    {unknown::sides2,
     [](const Bench& b, const Problem& p, std::size_t light, double* to) {
       const LampArea area = lamp_area(b.lights[light].size, size_unit_mm(*p.model.board));
       std::copy_n(area.sides2.begin(), 2, to);
     },
     [](const double* from, const Problem& p, std::size_t light, Bench& b) {
       Light& l = b.lights[light];
       if (seeks_size(p, light))  // else as given, to the last bit
         l.size = lamp_size({from[unknown::size2 - unknown::sides2], {from[0], from[1]}}, size_unit_mm(*p.model.board),
                            l.position_mm.norm());
     }},
});

constexpr bool every_row_has_a_link() {
  std::size_t link = 0;
  int first = 0;
  for (const UnknownRow& row : kUnknownRows) {
    if (row.scope == Scope::shared || row.scope == Scope::lamp)
      if (link >= kLinks.size() || kLinks[link++].first != first) return false;
    first += row.size;
  }
  return link == kLinks.size();
}
static_assert(every_row_has_a_link());

}  // namespace

State state_of(const Bench& bench, const Problem& problem) {
  State state;
  state.lamps.resize(bench.lights.size());
  for (const Link& link : kLinks)
    for (std::size_t light = 0; light < (link.first < kSharedUnknowns ? 1 : bench.lights.size()); ++light)
      link.read(bench, problem, light, state.block(link.first, light));
  return state;
}

void put_state(const State& state, const Problem& problem, Bench& bench) {
  for (const Link& link : kLinks)
    for (std::size_t light = 0; light < (link.first < kSharedUnknowns ? 1 : bench.lights.size()); ++light)
      link.write(state.block(link.first, light), problem, light, bench);
  if (problem.surroundings) bench.lights[*problem.surroundings].intensity *= *state.block(unknown::ambient);
}

}  // namespace burin
