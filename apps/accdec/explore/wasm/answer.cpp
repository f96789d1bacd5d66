// The library inside a page: the questions that the program answers over HTTP are function calls here.
#include <algorithm>
#include <string>

#include <accdec/task.hpp>

#include "machines.hpp"
#include "requests.hpp"

namespace {
accdec::explore::Answer last;
}

// Called from worker.js. Texts are UTF-8 and end with a zero; the answer's length counts, as files may hold zeros.
extern "C" {

/// The page begins with this answer.
const char* accdec_start() {
  using namespace accdec;
  const auto files = cli::machine_files();
  const auto first =
      std::find_if(files.begin(), files.end(), [](const auto& f) { return f.name == cli::first_machine; });
  last = {200, "application/json", explore::start_json(parse_task(first->text, std::string(first->name)), "")};
  return last.text.data();
}

const char* accdec_answer(const char* name, const char* body, const char* format, int corner, double seconds,
                          bool whole) {
  accdec::explore::Question question{.name = name, .body = body, .format = format};
  question.corner = static_cast<std::size_t>(std::max(0, corner));
  question.seconds = seconds > 0.0 && seconds <= accdec::explore::most_seconds ? seconds : 1.0;
  question.whole = whole;
  last = accdec::explore::answer(question);
  return last.text.data();
}

/// The length of the last answer, in bytes.
std::size_t accdec_length() {
  return last.text.size();
}
int accdec_status() {
  return last.status;
}
const char* accdec_type() {
  return last.type.c_str();
}

}  // extern "C"
