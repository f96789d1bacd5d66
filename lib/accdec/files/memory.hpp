#pragma once

namespace accdec {

/// Bytes of memory that this process can still take without swapping: the least of what the system says is available,
/// what its control group and its limit on address space leave. Infinite where nothing can be found out.
double available_memory();

}  // namespace accdec
