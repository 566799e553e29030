// burin/scene/parameter_name.h - the names of a setup's parameters in bench.json's verdict and in plan.json. All code
// takes them from here.
#pragma once

#include <array>
#include <string>

namespace burin::parameter {

inline constexpr const char* kLens = "lens";                    ///< focal lengths and center together
inline constexpr const char* kLensFocal = "lens focal length";  ///< in plans
inline constexpr const char* kLensCenter = "lens center";       ///< in plans
inline constexpr const char* kPoses = "poses";                  ///< of all views: the worst of them
inline constexpr const char* kTags = "board.tags";              ///< their places on the board
inline constexpr const char* kBow = "board.bow_mm";
inline constexpr const char* kBend = "board.bend";
inline constexpr const char* kAlpha = "alpha";             ///< roughness of the grooves
inline constexpr const char* kDepth = "depth_um";          ///< of the grooves
inline constexpr const char* kBaseAlpha = "base_alpha";    ///< roughness of the plain face
inline constexpr const char* kDepthField = "depth_field";  ///< variation of depth over the board and with wear
inline constexpr const char* kMachine = "machine.affine";
inline constexpr const char* kAmbient = "ambient";
inline constexpr const char* kVignette = "sensor.vignette";
inline constexpr const char* kBlur = "sensor.psf_sigma_px";
inline constexpr const char* kStray = "stray_light";   ///< the direction of an unmodeled light
inline constexpr const char* kGlare = "sensor.glare";  ///< the fraction of light in veiling glare

/// The pose of one view: "pose.VIEW".
std::string pose(const std::string& view);

/// Parameters of one lamp: "light.ID.position_mm" and so on.
std::string light_position(const std::string& id);
std::string light_intensity(const std::string& id);
std::string light_axis(const std::string& id);
std::string light_falloff(const std::string& id);
std::string light_size(const std::string& id);
/// All of them: functions from a lamp's id to a name.
inline constexpr std::array kOfOneLight{&light_position, &light_intensity, &light_axis, &light_falloff, &light_size};
/// True for the name of some lamp's position.
bool is_light_position(const std::string& name);

/// The parameter in words: "the depth d", "the position of lamp “spot”". An unknown name returns unchanged.
std::string in_words(const std::string& name);

}  // namespace burin::parameter
