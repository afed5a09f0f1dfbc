/* In the shape of what STruC++ makes of prog.st, as far as strucpp_main.cpp names it: with VAR_GLOBAL in the class of the
   configuration, as 0.5 has it (-DGLOBALS_ARE_MEMBERS), or in the namespace, as 0.6 has it. */

#pragma once

#include <cstdint>

#define STRUCPP_HAS_EXCEPTIONS 0

namespace strucpp {

enum class IecFault : uint8_t { any };
[[noreturn]] void iec_runtime_fault(IecFault, const char *context = nullptr) noexcept;

inline int64_t __CURRENT_TIME_NS = 0;

template <class Value> struct GlobalVar {
    Value value{};
    Value read() const { return value; }
    void write(Value written) { value = written; }
};

struct Program {
    void run() {}
};

#ifndef GLOBALS_ARE_MEMBERS
#include "globals.hpp"
#endif

class Configuration_CONFIG0 {
public:
#ifdef GLOBALS_ARE_MEMBERS
#include "globals.hpp"
#endif
    Program CELL;
};

} // namespace strucpp
