#include "burin/render/parts_derivatives.h"

namespace burin {

RadianceDerivatives mean_with_derivatives(std::span<const ScenePart> parts, const CameraView& camera,
                                          const Carved& carved, std::span<const SceneParameter> parameters,
                                          const RenderOptions& options,
                                          const std::shared_ptr<RenderWorkspace>& workspace) {
  if (parts.size() == 1)
    return render_with_derivatives(parts.front().scene, camera, carved, parameters, options, workspace);
  RadianceDerivatives mean;
  mean.d_radiance.resize(parameters.size());
  for (const ScenePart& part : parts) {
    const RadianceDerivatives one = render_with_derivatives(part.scene, camera, carved, parameters, options, workspace);
    add_share(one.radiance, part.share, mean.radiance);
    for (std::size_t k = 0; k < parameters.size(); ++k) add_share(one.d_radiance[k], part.share, mean.d_radiance[k]);
  }
  return mean;
}

}  // namespace burin
