#include "tools/content_policy.h"

#include <openssl/evp.h>

#include <array>

#include "burin/base/error.h"
#include "tools/base64.h"

namespace burin {
namespace {

std::string sources(std::span<const std::string> texts) {
  if (texts.empty()) return " 'none'";
  std::string list;
  for (const std::string& text : texts) list += " " + content_hash_source(text);
  return list;
}

}  // namespace

std::string content_hash_source(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> value{};
  unsigned int length = 0;
  if (EVP_Digest(text.data(), text.size(), value.data(), &length, EVP_sha256(), nullptr) != 1)
    fail("the page", "cannot be hashed: OpenSSL has no SHA-256", "install Debian's own libssl3");
  const std::string_view bytes(reinterpret_cast<const char*>(value.data()), length);
  return "'sha256-" + base64(bytes) + "'";
}

std::string content_policy(std::span<const std::string> scripts, std::span<const std::string> styles) {
  return "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; script-src" +
         sources(scripts) + "; style-src" + sources(styles) + "; base-uri 'none'; form-action 'none'\">";
}

}  // namespace burin
