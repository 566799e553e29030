// burin/render/fast/byte_store.h - memory for arrays that live until the next clear(), handed out from a few large
// blocks that are kept: what is rendered again and again then needs no memory of the heap.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace burin {

class ByteStore {
 public:
  /// Never holds more than `most_bytes`.
  explicit ByteStore(std::size_t most_bytes) : most_(most_bytes) {}

  /// All is free again. Not while others take().
  void clear();

  /// `bytes` of memory, aligned for any packet (64 bytes), or null where it would not fit. From any thread.
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
  std::size_t block_ = 0, used_ = 0;  // where the next memory comes from
};

}  // namespace burin
