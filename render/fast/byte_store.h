// burin/render/fast/byte_store.h - memory for arrays with a lifetime until the next clear(). A few large blocks supply
// it and stay allocated, so repeated rendering needs no memory from the heap.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace burin {

class ByteStore {
 public:
  /// Limits all blocks together to `most_bytes`.
  explicit ByteStore(std::size_t most_bytes) : most_(most_bytes) {}

  /// Frees all arrays. No other thread may be in take().
  void clear();

  /// `bytes` of memory, aligned for any SIMD vector (64 bytes), or null beyond the limit. Any thread may call it.
  std::byte* take(std::size_t bytes);

 private:
  struct Free {
    void operator()(std::byte* block) const;
  };
  struct Block {
    std::unique_ptr<std::byte[], Free> bytes;
    std::size_t size = 0;
  };

  const std::size_t most_;
  std::mutex mutex_;
  std::vector<Block> blocks_;
  std::size_t held_ = 0;              // bytes in all blocks
  std::size_t block_ = 0, used_ = 0;  // source of the next memory
};

}  // namespace burin
