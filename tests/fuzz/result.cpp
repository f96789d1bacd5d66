// Any bytes are a result that is read, or refused with a position; and what was read is read again from how it is
// written.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <accdec/result.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  std::string written;
  try {
    written = accdec::result_to_json(accdec::parse_result(text, "fuzz.json"));
  } catch (const accdec::InputError&) {
    return 0;
  }
  // Outside the try block: a result that was read must come back, to the last bit.
  if (accdec::result_to_json(accdec::parse_result(written, "written.json")) != written) std::abort();
  return 0;
}
