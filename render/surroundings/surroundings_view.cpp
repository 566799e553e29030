#include "burin/render/surroundings/surroundings_view.h"

#include <algorithm>
#include <utility>

#include "burin/base/error.h"
#include "burin/render/fast/fast_view.h"
#include "burin/render/surroundings/exact_surroundings.h"
#include "burin/render/surroundings/face_light.h"
#include "burin/render/surroundings/facet_table.h"
#include "burin/render/surroundings/make_curve_tables.h"
#include "burin/render/surroundings/table_range.h"

namespace burin {

struct SurroundingsView::Data {
  ViewScene scene;
  Light light;
  RenderOptions options;
  PlaceLattice lattice;
  TableRange range;
  std::vector<std::unique_ptr<FastView>> channels;
  Image one;                                 // buffer of one channel
  std::unique_ptr<ExactSurroundings> exact;  // with use_double, which has no channels

  Data(const ViewScene& s, const Light& l, const RenderOptions& o) : scene(s), light(l), options(o) {}

  void make_channels(const std::shared_ptr<RenderWorkspace>& workspace);
  void make_tables(const Scratches& scratches);
  KernelMode with_jacobian() const { return options.material_gradients ? KernelMode::material : KernelMode::ends; }
};

void SurroundingsView::Data::make_channels(const std::shared_ptr<RenderWorkspace>& workspace) {
  const Material& m = scene.material;
  lattice = place_lattice(scene, light, std::min(m.alpha * std::min(1.0, m.profile.across), m.base_alpha));
  const int n = options.channels;
  const FaceLight all = face_light(scene, light, n, lattice);
  for (int c = 0; c < n; ++c) {
    PlainFace face;
    const std::size_t pixels = all.light.size() / n;
    face.light.resize(pixels);
    face.by_base_alpha.resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
      face.light[i] = all.light[i * n + c];
      face.by_base_alpha[i] = all.by_log_alpha[i * n + c] / static_cast<float>(scene.material.base_alpha);
    }
    channels.push_back(std::make_unique<FastView>(scene, face, options.material_gradients, options.simd, workspace));
  }
}

void SurroundingsView::Data::make_tables(const Scratches& scratches) {
  if (serves(range, scene, scratches)) return;
  range = table_range(scene, scratches, options.material_gradients);
  std::vector<FacetTable> facets;
  for (const double alpha : range.alphas)
    facets.push_back(make_facet_table(scene, light, options.channels, lattice, alpha, range.steepest_t));
  const auto tables = make_curve_tables(scene, facets, range, lattice);
  for (std::size_t c = 0; c < channels.size(); ++c) channels[c]->set_curves(tables[c]);
}

SurroundingsView::SurroundingsView(const ViewScene& scene, const Light& light, const RenderOptions& options,
                                   const std::shared_ptr<RenderWorkspace>& workspace)
    : data_(std::make_unique<Data>(scene, light, options)) {
  if (options.use_double && !scene.material.profile.is_paper())
    fail("light " + light.id, "the double twin lights grooves of the paper's cross-section alone",
         "render in float packets");
  if (options.use_double)
    data_->exact = std::make_unique<ExactSurroundings>(scene, light, options);
  else
    data_->make_channels(workspace);
}

SurroundingsView::~SurroundingsView() = default;

std::size_t SurroundingsView::pair_count() const {
  return data_->exact ? data_->exact->pair_count() : data_->channels.front()->pair_count();
}

void SurroundingsView::add_radiance(const Scratches& scratches, bool keep_jacobian, bool instead, Image& radiance) {
  Data& d = *data_;
  if (d.exact) {
    if (instead) std::fill(radiance.data.begin(), radiance.data.end(), 0.0F);
    d.exact->add_radiance(scratches, radiance);
    return;
  }
  d.make_tables(scratches);
  const std::size_t n = d.channels.size();
  for (std::size_t c = 0; c < n; ++c) {
    // Channels share a workspace, which keeps the last one's Jacobian.
    const KernelMode mode = keep_jacobian && c + 1 == n ? d.with_jacobian() : KernelMode::value;
    if (instead && n == 1) {
      d.channels[c]->forward(scratches, mode, radiance);
      return;
    }
    d.channels[c]->forward(scratches, mode, d.one);
    for (std::size_t i = 0; i < d.one.data.size(); ++i) {
      float& to = radiance.data[i * n + c];
      to = instead ? d.one.data[i] : to + d.one.data[i];
    }
  }
}

void SurroundingsView::backward(const Scratches& scratches, const Image& dE_dradiance,
                                ScratchGradients& gradients) const {
  const Data& d = *data_;
  if (d.exact) {
    d.exact->backward(dE_dradiance, gradients);
    return;
  }
  const std::size_t n = d.channels.size();
  Image by, again;
  for (std::size_t c = n; c-- > 0;) {
    FastView& view = *d.channels[c];
    if (!view.has_jacobian()) view.forward(scratches, d.with_jacobian(), again);
    if (n == 1) {
      view.backward(dE_dradiance, gradients);
      return;
    }
    if (by.data.empty()) by = Image(dE_dradiance.width, dE_dradiance.height, 1);
    for (std::size_t i = 0; i < by.data.size(); ++i) by.data[i] = dE_dradiance.data[i * n + c];
    view.backward(by, gradients);
  }
}

void SurroundingsView::add_contributions(const Scratches& scratches, std::vector<double>& contribution) const {
  const Data& d = *data_;
  if (d.exact) {
    d.exact->add_contributions(contribution);
    return;
  }
  Image again;
  std::vector<double> own(contribution.size(), 0);
  for (const auto& view : d.channels) {
    view->forward(scratches, KernelMode::value, again);
    view->add_contributions(own);
  }
  for (std::size_t i = 0; i < own.size(); ++i) contribution[i] += own[i] / static_cast<double>(d.channels.size());
}

}  // namespace burin
