#include "burin/render/fast/byte_store.h"

#include <algorithm>
#include <new>

namespace burin {
namespace {

constexpr std::align_val_t kAlign{64};
constexpr std::size_t kLeastBlock = 4 << 20;

}  // namespace

void ByteStore::Free::operator()(std::byte* block) const { ::operator delete[](block, kAlign); }

void ByteStore::clear() { block_ = used_ = 0; }

std::byte* ByteStore::take(std::size_t bytes) {
  bytes = (bytes + 63) / 64 * 64;
  const std::lock_guard lock(mutex_);
  while (block_ < blocks_.size() && used_ + bytes > blocks_[block_].size) {
    ++block_;
    used_ = 0;
  }
  if (block_ == blocks_.size()) {
    // Doubles the total, so a growing store seldom allocates. Untouched memory costs nothing.
    const std::size_t size = std::max({bytes, kLeastBlock, held_});
    const std::size_t left = most_ - held_;
    if (bytes > left) return nullptr;
    Block block;
    block.size = std::min(size, left);
    block.bytes.reset(static_cast<std::byte*>(::operator new[](block.size, kAlign)));
    held_ += block.size;
    blocks_.push_back(std::move(block));
  }
  std::byte* const space = blocks_[block_].bytes.get() + used_;
  used_ += bytes;
  return space;
}

}  // namespace burin
