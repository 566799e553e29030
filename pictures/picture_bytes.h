// burin/pictures/picture_bytes.h - random access to the bytes of a picture file.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "burin/base/error.h"

namespace burin {

/// Bytes of a file by offset. Throws Error for an offset beyond its end, and for a disk error.
class PictureBytes {
 public:
  PictureBytes(const std::filesystem::path& file, std::uintmax_t size)
      : file_(file), size_(size), in_(file, std::ios::binary) {}

  std::uintmax_t size() const { return size_; }

  std::string at(std::uintmax_t place, std::uintmax_t count) {
    if (place > size_ || count > size_ - place) cut_short("it ends within its header");
    std::string bytes(count, '\0');
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(place));
    in_.read(bytes.data(), static_cast<std::streamsize>(count));
    if (!in_) broken("cannot be read to its end");
    return bytes;
  }
  /// All available bytes, up to `count`.
  std::string up_to(std::uintmax_t place, std::uintmax_t count) {
    return at(place, place > size_ ? 0 : std::min(count, size_ - place));
  }
  std::uint64_t big_endian(std::uintmax_t place, int bytes) { return number(place, bytes, true); }
  std::uint64_t little_endian(std::uintmax_t place, int bytes) { return number(place, bytes, false); }
  std::uint64_t number(std::uintmax_t place, int bytes, bool big) {
    return number_of(at(place, static_cast<std::uintmax_t>(bytes)), 0, bytes, big);
  }
  /// The number in `bytes` bytes of a text, which must contain them.
  static std::uint64_t number_of(const std::string& text, std::size_t place, int bytes, bool big) {
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i)
      value = value << 8U | static_cast<unsigned char>(text[place + static_cast<std::size_t>(big ? i : bytes - 1 - i)]);
    return value;
  }

  [[noreturn]] void broken(const std::string& what) const {
    fail(file_.string(), "is a broken picture: " + what, "copy it again from where it came from, or export it again");
  }
  [[noreturn]] void cut_short(const std::string& what) const {
    fail(file_.string(), "is cut short: " + what, "copy it again from where it came from");
  }

 private:
  const std::filesystem::path& file_;
  std::uintmax_t size_;
  std::ifstream in_;
};

}  // namespace burin
