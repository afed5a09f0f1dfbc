// What the operators and functions of Structured Text are worth, written down in C without undefined behaviour.
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef __int128 wide;

// A whole number as one of `bits` bits, with or without a sign: its low bits.
static wide keep(wide value, int bits, int sign) {
  unsigned __int128 mask = (((unsigned __int128)1) << bits) - 1;
  unsigned __int128 low = (unsigned __int128)value & mask;
  if (sign && (low >> (bits - 1)) & 1) return (wide)(low - mask - 1);
  return (wide)low;
}
static wide product(wide a, wide b) { return (wide)((unsigned __int128)a * (unsigned __int128)b); }
static wide quotient(wide a, wide b) { return a / b; }
static wide rest(wide a, wide b) { return a % b; }
static wide least(wide a, wide b) { return a < b ? a : b; }
static wide most(wide a, wide b) { return a > b ? a : b; }
static wide shifted_left(uint64_t a, int64_t by, int bits) { return by < 0 || by >= bits ? 0 : (wide)(a << by); }
static wide shifted_right(uint64_t a, int64_t by, int bits) { return by < 0 || by >= bits ? 0 : (wide)(a >> by); }
static wide rotated_left(uint64_t a, int64_t by, int bits) {
  int n = (int)(by & (bits - 1));
  uint64_t mask = bits == 64 ? ~0ULL : (1ULL << bits) - 1;
  return n == 0 ? (wide)a : (wide)(((a << n) | (a >> (bits - n))) & mask);
}
// Half to even, saturating; NaN is 0.
static wide rounded(double value, wide low, wide high) {
  double near = nearbyint(value);
  if (near != near) return 0;
  if (near <= -2e19) return low;
  if (near >= 2e19) return high;
  wide whole = (wide)near;
  return whole < low ? low : whole > high ? high : whole;
}
static double least_real(double a, double b) {
  if (a != a || b != b) return NAN;
  if (a == 0 && b == 0) return signbit(a) ? a : b;
  return a < b ? a : b;
}
static double most_real(double a, double b) {
  if (a != a || b != b) return NAN;
  if (a == 0 && b == 0) return signbit(a) ? b : a;
  return a > b ? a : b;
}
static void show_real(float value) {
  uint32_t bits;
  memcpy(&bits, &value, 4);
  printf(value != value ? "nan " : "%x ", bits);
}
static void show_lreal(double value) {
  uint64_t bits;
  memcpy(&bits, &value, 8);
  printf(value != value ? "nan " : "%llx ", (unsigned long long)bits);
}
static void show(wide value, int bits) {
  uint64_t mask = bits == 64 ? ~0ULL : (1ULL << bits) - 1;
  printf("%llx ", (unsigned long long)((uint64_t)value & mask));
}
