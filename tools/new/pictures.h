// tools/new/pictures.h - the pictures of a new project: read once, named, laid on the carve area, and shown as they
// will be cropped.
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

/// A picture that a board is to show.
struct ChosenPicture {
  std::filesystem::path file;  ///< the person's
  std::string view;  ///< its view's name: the file's without its ending, unique, what is no letter or digit as -
  std::filesystem::path stored;  ///< its name in the project's targets/, unique
  int width = 0, height = 0;     ///< upright, pixels
  Image small;                   ///< at most 640 pixels wide and high, one channel, encoded as in a file
  std::optional<Image> smaller;  ///< what is stored instead of a copy of a very large or a see-through picture
  std::string ground;            ///< "black" or "white": on which it is laid where it is see-through; else empty
  Fit fit = Fit::cover;
  Keep keep = Keep::middle;
};

/// Reads pictures, two at the same time. Throws Error for the first one that cannot be read, is of one tone, or has a
/// name that no JSON file can hold; for none, and for more than `most`.
std::vector<ChosenPicture> choose_pictures(const std::vector<std::filesystem::path>& files, std::size_t most);

/// How a picture is usually laid on an area: what loses much of its height keeps its top, where heads and skies are;
/// what would lose more than 45 % is shown whole.
void lay_as_usual(ChosenPicture& picture, const Eigen::Vector2d& area_mm);

/// Whether anything worth mentioning (2 %) is cropped, or anything stays black, for an area of another shape.
bool has_other_shape(const ChosenPicture& picture, const Eigen::Vector2d& area_mm);

/// "astronaut.png, 512 x 512 on 150 x 100 mm: the bottom loses 33 %".
std::string crop_in_words(const ChosenPicture& picture, const Eigen::Vector2d& area_mm);

/// The answers to "how is it laid?": top, middle, bottom, left, right (cropped, that part kept) or contain.
/// The later of two files that show the same, and the earlier; all such.
std::vector<std::pair<std::size_t, std::size_t>> same_pictures(const std::vector<ChosenPicture>& pictures);

std::string lay_name(const ChosenPicture& picture);
/// Throws Error for any other text.
void lay_as(ChosenPicture& picture, const std::string& name);

/// A row a picture: as it is, with what is lost darkened and what is kept framed; and as it will lie on the area.
Image crop_sheet(const std::vector<ChosenPicture>& pictures, const Eigen::Vector2d& area_mm);

/// Writes picture `p` to targets_folder / p.stored: a copy, or what is stored instead.
void store_picture(const ChosenPicture& picture, const std::filesystem::path& targets_folder);

}  // namespace burin
