// Counts what the program takes from the heap, whoever asks: malloc and its relatives are replaced in this program.
#pragma once

#include <cstddef>

namespace burin {

/// Whether allocations() counts: with glibc, and without a sanitizer that replaces malloc itself.
bool counts_allocations();

/// Calls of malloc, calloc, realloc, aligned_alloc, posix_memalign and memalign (and so of new) by all threads since
/// the program began.
std::size_t allocations();

}  // namespace burin
