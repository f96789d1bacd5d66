#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace accdec::malformed {

/// A task file with one thing wrong, and what the message must begin with (after the file's name) and contain.
struct Case {
  const char* name;
  std::string text;
  std::string position;  ///< "line:column"
  std::vector<std::string> words;
};
inline void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

/// A correct task; cases put their fault in one place of it. Lines: 1 sample period, 2-5 filter, 6-12 axis, 13-18
/// corner.
struct Parts {
  std::string top = "sample_period_ms = 1.0\n";
  std::string filter = "[filter]\nkind = \"trapezoid\"\norder = 20\nramp = 5\n";
  std::string axis =
      "[[axis]]\nname = \"x\"\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 9000\nmass_kg = 50\ndamping_N_s_m = "
      "10\nforce_max_N = 600\n";
  std::string corner =
      "[[corner]]\nname = \"A\"\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 400\ndelay_samples = 3\n";
  std::string end = "";
  std::string str() const { return top + filter + axis + corner + end; }
};
inline std::string with_top(std::string s) {
  return Parts{.top = std::move(s)}.str();
}
inline std::string with_filter(std::string s) {
  return Parts{.filter = std::move(s)}.str();
}
inline std::string with_axis(std::string s) {
  return Parts{.axis = std::move(s)}.str();
}
inline std::string with_corner(std::string s) {
  return Parts{.corner = std::move(s)}.str();
}
inline std::string with_end(std::string s) {
  return Parts{.end = std::move(s)}.str();
}

inline const std::string corner_head =
    "[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = 0\n";  // lines 13-16

}  // namespace accdec::malformed
