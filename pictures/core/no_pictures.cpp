// The core's pictures: none. They come in as arrays (burin/base/image.h).
#include "burin/base/error.h"
#include "burin/pictures/linear_picture.h"
#include "burin/pictures/picture.h"

namespace burin {
namespace {

[[noreturn]] void fail_without_library(const std::filesystem::path& file) {
  fail(file.string(), "this build of Burin reads and writes no pictures",
       "give pictures in memory, or build all of Burin, with OpenImageIO");
}

}  // namespace

Image read_picture(const std::filesystem::path& file) { fail_without_library(file); }
void write_picture(const Image&, const std::filesystem::path& file, int) { fail_without_library(file); }
Image read_linear_luminance(const std::filesystem::path& file) { fail_without_library(file); }
Image read_linear_picture(const std::filesystem::path& file) { fail_without_library(file); }

}  // namespace burin
