#include "burin/optimize/design/crossing_loss.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "burin/optimize/design/shown_light.h"
#include "burin/scene/blur.h"

namespace burin {
namespace {

// The light of the grooves relative to white, without the face's own light. Grooves cover a little of the face.
Image light_of_grooves(const WorkView& view, Image radiance, float exposure) {
  constexpr float kOfFace = 0.9F;
  for (std::size_t i = 0; i < radiance.data.size(); ++i)
    radiance.data[i] = exposure * std::max(0.0F, radiance.data[i] - kOfFace * view.face.data[i]);
  return radiance;
}

float exposure_of(const WorkView& view, const std::vector<double>& log_exposure) {
  return static_cast<float>(std::exp(log_exposure[view.exposure_group]));
}

void add(Image& sum, const Image& image) {
  if (sum.data.empty()) sum = Image(image.width, image.height, 1);
  for (std::size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += image.data[i];
}

}  // namespace

void see_crossings(std::vector<WorkView>& views, const std::vector<double>& log_exposure, std::vector<Image> uncut,
                   double cover) {
  // Blur of a pixel or two: neighboring strokes meet similar crossings.
  constexpr double kBlurPx = 1;
  std::vector<std::pair<Image, Image>> left(views.size());  // light with crossings, and without
  Image all_left, all;
  for (std::size_t k = 0; k < views.size(); ++k) {
    WorkView& v = views[k];
    const auto seen = [&](Image radiance) {
      return blurred(light_of_grooves(v, std::move(radiance), exposure_of(v, log_exposure)), kBlurPx);
    };
    left[k].first = seen(v.radiance);
    left[k].second = seen(std::move(uncut[k]));
    add(all_left, left[k].first);
    add(all, left[k].second);
  }
  // At places with little light of a view so far, the light of all views estimates the share for new strokes.
  constexpr float kOfAll = 0.1F, kLittle = 1e-6F, kLeast = 0.05F;
  for (std::size_t k = 0; k < views.size(); ++k) {
    CrossingLoss& crossings = views[k].crossings;
    crossings.cover = cover;
    crossings.kept = std::move(left[k].first);
    for (std::size_t i = 0; i < all.data.size(); ++i) {
      const float of = left[k].second.data[i] + kOfAll * all.data[i];
      float& kept = crossings.kept.data[i];
      kept = of > kLittle ? std::clamp((kept + kOfAll * all_left.data[i]) / of, kLeast, 1.0F) : 1.0F;
    }
  }
}

void forget_crossings(std::vector<WorkView>& views) {
  for (WorkView& v : views) v.crossings = {};
}

Image crossing_cost(const std::vector<WorkView>& views, const std::vector<double>& log_exposure) {
  // Each of two crossing grooves keeps half of the shared part.
  constexpr float kTaken = 0.5F;
  // The removed light is not spread evenly over one or two pixels, so no exposure corrects its errors.
  constexpr float kUneven = 0.2F;
  if (views.front().crossings.kept.data.empty()) return {};
  const auto cover = static_cast<float>(views.front().crossings.cover);
  Image cost(views.front().radiance.width, views.front().radiance.height, 1);
  for (const WorkView& v : views) {
    const float exposure = exposure_of(v, log_exposure),
                weight = static_cast<float>(v.spec.weight * v.share * v.balance);
    for (std::size_t i = 0; i < cost.data.size(); ++i) {
      const float light = exposure * v.radiance.data[i];
      if (!(light > 0) || light >= 1) continue;  // white pixels stay white
      const float shown = shown_light(light), of_face = exposure * v.face.data[i];
      const float by_log = kShownPower * shown * std::clamp((light - of_face) / light, 0.0F, 1.0F);
      const float matters = v.target.mask.data.empty() ? 1 : v.target.mask.data[i];
      cost.data[i] += cover * weight * matters * matters * by_log *
                      (kUneven * by_log - 2 * kTaken * (shown - v.target.picture.data[i]));
    }
  }
  return cost;
}

}  // namespace burin
