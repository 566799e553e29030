// tools/kept_memory.h - freed memory stays with the program while large buffers come and go.
#pragma once

#include <malloc.h>

namespace burin {

/// While it lives, freed memory stays with the program. Memory that the system takes back returns page by page and
/// cleared. That costs a tenth of a design's iteration with grooves that cut each other (a hundred megabytes of pieces,
/// made again each time), and a fifth of `burin capture` of large photos. Commands that hold many sizes of buffers for
/// long do without it: two fifths of refine's heap were unused.
struct KeptMemory {
#ifdef __GLIBC__
  KeptMemory() {
    mallopt(M_TRIM_THRESHOLD, 1 << 30);  // bytes
    mallopt(M_MMAP_MAX, 0);
  }
  ~KeptMemory() {  // a loop goes on with other commands
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
