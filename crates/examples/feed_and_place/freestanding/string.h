/* What a guest without a C library has of this header: clang makes instructions of these with -mbulk-memory. */
#ifndef FEED_AND_PLACE_STRING_H
#define FEED_AND_PLACE_STRING_H
#define memset __builtin_memset
#define memcpy __builtin_memcpy
#endif
