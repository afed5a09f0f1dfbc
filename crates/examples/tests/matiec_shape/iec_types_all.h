/* Types as a program that matiec translated has them, in words of our own: what standstill_matiec_main.c asks for. */
#ifndef SHAPE_TYPES_H
#define SHAPE_TYPES_H

#include <stdint.h>

/* A variable is its value and flags; 2 is the flag of a forced one, which keeps its value. */
#define SHAPE_OF(type)    \
    typedef struct {      \
        type value;       \
        uint8_t flags;    \
    } __IEC_##type##_t;

typedef uint8_t BOOL;
typedef int16_t INT;
typedef uint16_t WORD;
typedef int32_t DINT;
typedef uint32_t DWORD;
typedef uint64_t ULINT;
typedef double LREAL;
typedef struct {
    int64_t tv_sec;
    int32_t tv_nsec;
} TIME;
typedef struct {
    DINT NUMBER;
} AXIS_REF;
typedef enum { SHAPE_ELEMENT } MC_BUFFER_MODE, MC_DIRECTION;

SHAPE_OF(BOOL)
SHAPE_OF(INT)
SHAPE_OF(WORD)
SHAPE_OF(DINT)
SHAPE_OF(DWORD)
SHAPE_OF(ULINT)
SHAPE_OF(LREAL)
SHAPE_OF(TIME)
SHAPE_OF(AXIS_REF)
SHAPE_OF(MC_BUFFER_MODE)
SHAPE_OF(MC_DIRECTION)

#define GetFbVar(name, ...) (data__->name.value __VA_ARGS__)
#define SetFbVar(name, to) \
    if (!(data__->name.flags & 2)) data__->name.value = to

#endif
