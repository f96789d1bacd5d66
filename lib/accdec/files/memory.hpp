#pragma once

namespace accdec {

/// Bytes of memory that this process can still take without swapping. It is the smallest of three: the memory available
/// in the system, the rest of its control group, and the rest of its limit on address space. Infinite if nothing is
/// known.
double available_memory();

}  // namespace accdec
