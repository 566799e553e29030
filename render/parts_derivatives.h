// burin/render/parts_derivatives.h - light of an area light and its derivatives, from those of its points.
// docs/model.md 5.5.
#pragma once

#include <memory>
#include <span>

#include "burin/render/scene_parts.h"
#include "burin/render/view_renderer.h"

namespace burin {

/// Mean of render_with_derivatives() over all parts.
RadianceDerivatives mean_with_derivatives(std::span<const ScenePart> parts, const CameraView& camera,
                                          const Carved& carved, std::span<const SceneParameter> parameters,
                                          const RenderOptions& options = {},
                                          const std::shared_ptr<RenderWorkspace>& workspace = nullptr);

}  // namespace burin
