// tools/content_hash.h - what a file holds, as one number: how the loop knows what its results were made from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace burin {

/// SHA-256 of a file's bytes, 64 hexadecimal digits. Throws Error for a file that is there and cannot be read.
std::string content_hash(const std::filesystem::path& file);

/// Remembers, for as long as one command runs, what was read once: photos are large. A file counts as read while its
/// size and its time of change stay the same.
class ContentHashes {
 public:
  /// As content_hash; "" for a file that is not there.
  std::string of(const std::filesystem::path& file);

 private:
  struct Known {
    std::uintmax_t size = 0;
    std::filesystem::file_time_type changed;
    std::string hash;
  };
  std::map<std::string, Known> known_;
};

}  // namespace burin
