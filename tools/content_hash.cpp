#include "tools/content_hash.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <limits>
#include <memory>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBytesAtOnce = 1 << 20;

}  // namespace

std::string content_hash(const fs::path& file) {
  require_plain_file(file, std::numeric_limits<std::uintmax_t>::max(), "a file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(file.string(), "cannot be read", "give yourself the right to read it");
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> digest(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  if (!digest || EVP_DigestInit_ex(digest.get(), EVP_sha256(), nullptr) != 1)
    fail(file.string(), "cannot be hashed: OpenSSL has no SHA-256", "install Debian's own libssl3");
  std::vector<char> bytes(kBytesAtOnce);
  while (stream) {
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    EVP_DigestUpdate(digest.get(), bytes.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) fail(file.string(), "could not be read to its end", "check the disk");
  std::array<unsigned char, EVP_MAX_MD_SIZE> value{};
  unsigned int length = 0;
  EVP_DigestFinal_ex(digest.get(), value.data(), &length);
  std::string text;
  for (unsigned int i = 0; i < length; ++i) text += fmt::format("{:02x}", value[i]);
  return text;
}

std::string ContentHashes::of(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  const std::uintmax_t size = fs::file_size(file);
  const fs::file_time_type changed = fs::last_write_time(file);
  Known& known = known_[fs::absolute(file).lexically_normal().string()];
  if (known.hash.empty() || known.size != size || known.changed != changed) known = {size, changed, content_hash(file)};
  return known.hash;
}

}  // namespace burin
