/* What Rust's standard library asks Windows for random numbers with, and wine 8 lacks. For tests under wine only: real systems
 * have it, and no archive holds this. */
#include <windows.h>

BOOLEAN NTAPI SystemFunction036(PVOID data, ULONG length); /* RtlGenRandom, of advapi32 */

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE data, SIZE_T length) {
    return SystemFunction036(data, (ULONG)length);
}
