// burin/base/machine_clones.h - loops compiled for several instruction sets; the loader chooses one for the machine
// when the program starts.
//
// The macros serve plain loops that the compiler vectorizes by itself. Their callees must be inlined, otherwise they
// run as compiled for the base line: mark them BURIN_INLINED. The base line's code runs if the compiler lacks the
// attribute or the machine lacks wider SIMD vectors.
#pragma once

#if defined(__GNUC__)
#define BURIN_INLINED __attribute__((always_inline)) inline
#else
#define BURIN_INLINED inline
#endif

// Clones are off under ThreadSanitizer, because the loader resolves them before its runtime is ready.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define BURIN_MACHINE_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define BURIN_MACHINE_CLONES
#endif
