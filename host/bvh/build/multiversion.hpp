// Compiles a function for several instruction sets; the best version is chosen when the program
// starts. No version contracts multiplications and additions, so all give the same bits.
#pragma once

#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
#define DAPPLE_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define DAPPLE_MULTIVERSION
#endif
