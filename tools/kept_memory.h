// tools/kept_memory.h - keeps freed memory in the process while large buffers are allocated and freed.
#pragma once

#include <malloc.h>

namespace burin {

/// Keeps freed memory in the process during its lifetime. Otherwise the system takes it back and later returns zeroed
/// pages one by one. These page faults cost a tenth of a design iteration with grooves that cut each other, which
/// allocates a hundred megabytes each time. In `burin capture` of large photos they cost a fifth. Commands with buffers
/// of many sizes do not use it: in refine, two fifths of the heap would stay unused.
struct KeptMemory {
#ifdef __GLIBC__
  KeptMemory() {
    mallopt(M_TRIM_THRESHOLD, 1 << 30);  // bytes
    mallopt(M_MMAP_MAX, 0);
  }
  ~KeptMemory() {  // a loop continues with other commands
    mallopt(M_TRIM_THRESHOLD, 64 << 20);
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_MMAP_MAX, 1 << 16);
    malloc_trim(0);
  }
#else
  KeptMemory() = default;
#endif
  KeptMemory(const KeptMemory&) = delete;
  KeptMemory& operator=(const KeptMemory&) = delete;
};

}  // namespace burin
