#include "burin/scene/parameter_name.h"

#include <array>
#include <utility>

namespace burin::parameter {
namespace {

constexpr const char *kPosePrefix = "pose.", *kLightPrefix = "light.";

// The fields of a lamp, and their names for people.
constexpr std::pair<const char*, const char*> kPosition{"position_mm", "position"},
    kIntensity{"intensity", "intensity"}, kAxis{"axis", "axis"}, kFalloff{"falloff_exponent", "fall-off exponent"},
    kSize{"size", "size"};
constexpr std::array kOfLight{kPosition, kIntensity, kAxis, kFalloff, kSize};

constexpr std::array<std::pair<const char*, const char*>, 17> kWords{{{kLens, "the lens"},
                                                                      {kLensFocal, "the lens' focal length"},
                                                                      {kLensCenter, "the lens' center"},
                                                                      {kPoses, "the cameras' places"},
                                                                      {kTags, "the tags' places"},
                                                                      {kBow, "the board's bow"},
                                                                      {kBend, "the sheet's bend"},
                                                                      {kAlpha, "the grooves' roughness alpha"},
                                                                      {kDepth, "the depth d"},
                                                                      {kBaseAlpha, "the plain face's roughness"},
                                                                      {kDepthField, "how the depth varies"},
                                                                      {kMachine, "the machine's map"},
                                                                      {kAmbient, "the ambient light"},
                                                                      {kVignette, "the vignetting"},
                                                                      {kBlur, "the blur"},
                                                                      {kGlare, "the glare"},
                                                                      {kStray, "the unnamed light"}}};

std::string of_light(const std::string& id, const std::pair<const char*, const char*>& field) {
  return kLightPrefix + id + "." + field.first;
}

}  // namespace

std::string pose(const std::string& view) { return kPosePrefix + view; }
std::string light_position(const std::string& id) { return of_light(id, kPosition); }
std::string light_intensity(const std::string& id) { return of_light(id, kIntensity); }
std::string light_axis(const std::string& id) { return of_light(id, kAxis); }
std::string light_falloff(const std::string& id) { return of_light(id, kFalloff); }
std::string light_size(const std::string& id) { return of_light(id, kSize); }

bool is_light_position(const std::string& name) {
  return name.starts_with(kLightPrefix) && name.ends_with(std::string(".") + kPosition.first);
}

std::string in_words(const std::string& name) {
  for (const auto& [known, words] : kWords)
    if (name == known) return words;
  const std::string view = kPosePrefix, light = kLightPrefix;
  if (name.starts_with(view)) return "the camera's place in view " + name.substr(view.size());
  if (name.starts_with(light))
    for (const auto& [field, words] : kOfLight) {
      const std::string end = std::string(".") + field;
      if (name.ends_with(end) && name.size() > light.size() + end.size())
        return std::string("the ") + words + " of lamp “" +
               name.substr(light.size(), name.size() - light.size() - end.size()) + "”";
    }
  return name;
}

}  // namespace burin::parameter
