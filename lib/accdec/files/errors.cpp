#include <utility>

#include <fmt/format.h>

#include <accdec/files.hpp>

namespace accdec {

InputError::InputError(std::string file, long line, long column, std::string message, std::string pointer)
    : std::runtime_error(line > 0 ? fmt::format("{}:{}:{}: {}", file, line, column, message)
                                  : fmt::format("{}: {}", file, message)),
      file_(std::move(file)),
      message_(std::move(message)),
      pointer_(std::move(pointer)),
      line_(line),
      column_(column) {}

}  // namespace accdec
