/* What a guest has of the header: clang makes instructions of these with -mbulk-memory. */
#ifndef GUEST_STRING_H
#define GUEST_STRING_H
#define memset __builtin_memset
#define memcpy __builtin_memcpy
#endif
