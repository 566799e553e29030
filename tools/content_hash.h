// tools/content_hash.h - hash of a file's content. The loop uses it to see which inputs changed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace burin {

/// Returns the SHA-256 of a file's bytes as 64 hexadecimal digits. Throws Error for an unreadable file.
std::string content_hash(const std::filesystem::path& file);

/// Caches hashes for the duration of one command, because photos are large. A cached hash holds while the file keeps
/// its size and time of change.
class ContentHashes {
 public:
  /// Like content_hash(); "" for a missing file.
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
