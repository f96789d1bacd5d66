// Any bytes are a task that is read, or refused with a position; and what was read is read again from how it is
// written.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <accdec/formats/task_writer.hpp>
#include <accdec/task.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const bool whole_program : {false, true}) {
    accdec::TaskOptions options;
    options.require_corners = !whole_program;
    options.axes = whole_program ? 9 : 2;
    std::string written;
    try {
      written = accdec::task_to_toml(accdec::parse_task(text, "fuzz.toml", options));
    } catch (const accdec::InputError&) {
      continue;
    }
    // Outside the try block: a task that was read must come back, to the last bit.
    if (accdec::task_to_toml(accdec::parse_task(written, "written.toml", options)) != written) std::abort();
  }
  return 0;
}
