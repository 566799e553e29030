// tools/new/pictures.h - pictures of a new project: read once, named, fitted to the carve area, and previewed with
// their crops.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burin/base/image.h"
#include "burin/optimize/design_file.h"

namespace burin {

/// One target picture.
struct ChosenPicture {
  std::filesystem::path file;  ///< the user's file
  std::string view;  ///< name of its view: the file's without extension, unique, with - for all but letters and digits
  std::filesystem::path stored;  ///< its name in the project's targets/, unique
  int width = 0, height = 0;     ///< upright, pixels
  Image small;                   ///< at most 640 pixels wide and high, one channel, encoded as in a file
  std::optional<Image> smaller;  ///< stored instead of a copy if the picture is very large or transparent
  std::string ground;            ///< background of a transparent picture, "black" or "white"; else empty
  Fit fit = Fit::cover;
  Keep keep = Keep::middle;
};

/// Reads pictures, two at the same time. Throws Error for the first unreadable or single-toned one, and for a name with
/// invalid UTF-8. Throws Error for none, and for more than `most`.
std::vector<ChosenPicture> choose_pictures(const std::vector<std::filesystem::path>& files, std::size_t most);

/// Chooses the default fit. A picture that loses much of its height keeps its top, with heads and sky. A picture that
/// would lose more than 45 % is shown whole.
void lay_as_usual(ChosenPicture& picture, const Eigen::Vector2d& area_mm);

/// Returns true if the area's shape crops at least 2 % of the picture, or leaves a black border.
bool has_other_shape(const ChosenPicture& picture, const Eigen::Vector2d& area_mm);

/// "astronaut.png, 512 x 512 on 150 x 100 mm: the bottom loses 33 %".
std::string crop_in_words(const ChosenPicture& picture, const Eigen::Vector2d& area_mm);

/// Returns all pairs of files with the same content: the index of the later and of the earlier one.
std::vector<std::pair<std::size_t, std::size_t>> same_pictures(const std::vector<ChosenPicture>& pictures);

/// Returns the name of a picture's fit: top, middle, bottom, left, right (cropped, with this part kept) or contain.
std::string lay_name(const ChosenPicture& picture);
/// Applies an answer of lay_name(). Throws Error for any other text.
void lay_as(ChosenPicture& picture, const std::string& name);

/// Returns an image with one row per picture: the original, with its lost part darkened and the kept part framed, and
/// the fitted picture.
Image crop_sheet(const std::vector<ChosenPicture>& pictures, const Eigen::Vector2d& area_mm);

/// Writes the picture to targets_folder / picture.stored: a copy, or `smaller`.
void store_picture(const ChosenPicture& picture, const std::filesystem::path& targets_folder);

}  // namespace burin
