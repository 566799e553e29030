// burin/base/machine_clones.h - loops compiled for several instruction sets; the machine chooses when the
// program starts.
//
// For plain loops that the compiler turns into packets by itself. What they call must be inlined into them, or it runs
// as compiled for the base line: mark it BURIN_INLINED. Where the compiler has no such attribute, or the machine no
// wider packets, the base line's code runs.
#pragma once

#if defined(__GNUC__)
#define BURIN_INLINED __attribute__((always_inline)) inline
#else
#define BURIN_INLINED inline
#endif

// ThreadSanitizer is not yet there when the program's loader asks which clone is to run.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define BURIN_MACHINE_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define BURIN_MACHINE_CLONES
#endif
