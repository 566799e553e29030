#include "tools/base64.h"

#include <openssl/evp.h>

#include <algorithm>
#include <cstddef>

namespace burin {

std::string base64(std::string_view bytes) {
  constexpr std::size_t kBlock = std::size_t{3} << 20;      // OpenSSL counts in int; only the last block may be padded
  std::string out(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // OpenSSL adds a zero after each block
  std::size_t length = 0;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(kBlock, bytes.size())))
    length += static_cast<std::size_t>(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data() + length),
                                                       reinterpret_cast<const unsigned char*>(bytes.data()),
                                                       static_cast<int>(std::min(kBlock, bytes.size()))));
  out.resize(length);
  return out;
}

}  // namespace burin
