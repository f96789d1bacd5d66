#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <accdec/files/words.hpp>
#include <accdec/gcode/generate.hpp>
#include <accdec/gcode/line_writer.hpp>

namespace accdec {
namespace {

constexpr std::array<std::pair<GeneratedProgram, std::string_view>, 9> names{
    {{GeneratedProgram::pocket, "pocket"},
     {GeneratedProgram::zigzag, "zigzag"},
     {GeneratedProgram::trochoid, "trochoid"},
     {GeneratedProgram::engraving, "engraving"},
     {GeneratedProgram::raster, "raster"},
     {GeneratedProgram::star, "star"},
     {GeneratedProgram::hilbert, "hilbert"},
     {GeneratedProgram::relief, "relief"},
     {GeneratedProgram::spiral, "spiral"}}};
constexpr double degree = std::numbers::pi / 180.0;

/// Writes lines and counts the moves among them.
class Writer : public LineWriter {
 public:
  using LineWriter::LineWriter;
  template <class... Args>
  void move(fmt::format_string<Args...> format, Args&&... args) {
    line(format, std::forward<Args>(args)...);
    pass_on();
    ++moves_;
  }
  long moves() const { return moves_; }

 private:
  long moves_ = 0;
};

/// A low-discrepancy sequence in 0 .. 1: the multiples of the golden ratio.
double golden(long i) {
  const double x = static_cast<double>(i) * 0.6180339887498949;
  return x - std::floor(x);
}

void pocket(Writer& w, long blocks) {
  constexpr double width = 80.0, height = 50.0, step = 2.0, radius = 3.0;
  for (int level = 1; w.moves() < blocks; ++level) {
    w.move("G0 Z2");
    w.move("G0 X{:.3f} Y{:.3f}", 0.5 * width, 0.5 * height);
    w.move("G1 Z{:.3f}", -0.5 * level);
    for (double inset = 0.5 * height - step; inset > -1e-9 && w.moves() < blocks; inset -= step) {
      const double x0 = inset, x1 = width - inset, y0 = inset, y1 = height - inset;
      const double r = std::min(radius, 0.45 * (y1 - y0));
      w.move("G1 X{:.3f} Y{:.3f}", 0.5 * width, y0);
      w.move("X{:.3f}", x1 - r);
      w.move("G3 X{:.3f} Y{:.3f} R{:.3f}", x1, y0 + r, r);
      w.move("G1 Y{:.3f}", y1 - r);
      w.move("G3 X{:.3f} Y{:.3f} R{:.3f}", x1 - r, y1, r);
      w.move("G1 X{:.3f}", x0 + r);
      w.move("G3 X{:.3f} Y{:.3f} R{:.3f}", x0, y1 - r, r);
      w.move("G1 Y{:.3f}", y0 + r);
      w.move("G3 X{:.3f} Y{:.3f} R{:.3f}", x0 + r, y0, r);
      w.move("G1 X{:.3f}", 0.5 * width);
    }
  }
  w.move("G0 Z2");
}

void zigzag(Writer& w, long blocks) {
  double x = 0.0, y = 0.0, heading = 0.0;
  for (long i = 0; w.moves() < blocks; ++i) {
    x += 10.0 * std::cos(heading);
    y += 10.0 * std::sin(heading);
    w.move("G1 X{:.6f} Y{:.6f}", x, y);
    const double turn = (30.0 + 120.0 * golden(i + 1)) * degree;
    heading += i % 2 == 0 ? turn : -turn;
  }
}

void trochoid(Writer& w, long blocks) {
  constexpr double radius = 4.0, advance = 0.8;
  w.move("G1 X{:.3f} Y0", radius);
  for (long i = 0; w.moves() < blocks; ++i) {
    const double x = radius + advance * static_cast<double>(i);
    w.move("G3 X{:.3f} Y0 I{:.3f} J0", x - 2.0 * radius, -radius);
    w.move("G3 X{:.3f} Y0 I{:.3f} J0", x + advance, radius + 0.5 * advance);
  }
}

/// Strokes of a letter on a grid of 0..4 by 0..6: "x y" digit pairs, a blank lifts the tool.
std::string_view strokes(char letter) {
  switch (letter) {
    case 'A': return "002640 1333";
    case 'C': return "4536160501103041";
    case 'D': return "00063645413000";
    case 'E': return "40000646 0333";
    case 'F': return "000646 0333";
    case 'I': return "0040 2026 0646";
    case 'L': return "060040";
    case 'N': return "00064046";
    case 'R': return "0006364544330323 2340";
    case 'T': return "2026 0646";
    default: return "";
  }
}

void engraving(Writer& w, long blocks) {
  constexpr std::string_view text = "ACCDEC FIR FILTER DECELERATED ";
  for (long i = 0; w.moves() < blocks; ++i) {
    const double x0 = 6.0 * static_cast<double>(i % static_cast<long>(text.size()));
    const double y0 = -10.0 * static_cast<double>(i / static_cast<long>(text.size()));
    const std::string_view path = strokes(text[static_cast<std::size_t>(i) % text.size()]);
    bool down = false;
    for (std::size_t k = 0; k + 1 < path.size(); k += 2) {
      if (path[k] == ' ') {
        w.move("G0 Z1");
        down = false;
        ++k;
      }
      const double x = x0 + (path[k] - '0'), y = y0 + (path[k + 1] - '0');
      w.move("{} X{:.2f} Y{:.2f}", down ? "G1" : "G0", x, y);
      if (!down) w.move("G1 Z-0.2");
      down = true;
    }
    if (down) w.move("G0 Z1");
  }
}

void raster(Writer& w, long blocks) {
  constexpr double step = 0.1, row_step = 0.2;
  const long columns = std::max(10L, std::min(1000L, blocks / 4));
  for (long row = 0; w.moves() < blocks; ++row) {
    const double y = row_step * static_cast<double>(row);
    for (long i = 0; i <= columns && w.moves() < blocks; ++i) {
      const double x = step * static_cast<double>(row % 2 == 0 ? i : columns - i);
      const double z = 2.0 * std::sin(0.25 * x) * std::cos(0.2 * y) + 0.3 * std::sin(1.1 * x + 0.7 * y);
      w.move("G1 X{:.4f} Y{:.4f} Z{:.4f}", x, y, z);
    }
  }
}

void star(Writer& w, long blocks) {
  // Legs of 20 mm; the direction alternates so that corner i has the interior angle 1 + i mod 179 degrees.
  double x = 0.0, y = 0.0, heading = 0.0;
  for (long i = 0; w.moves() + 1 < blocks; ++i) {
    x += 20.0 * std::cos(heading);
    y += 20.0 * std::sin(heading);
    w.move("G1 X{:.6f} Y{:.6f}", x, y);
    const double turn = (179.0 - static_cast<double>(i % 179)) * degree;
    heading += i % 2 == 0 ? turn : -turn;
  }
  w.move("G1 X0 Y0");
}

/// Point i of Hilbert's curve through a square of 4^order points, 1 mm apart.
void hilbert(Writer& w, long blocks) {
  int order = 1;
  while ((1L << (2 * order)) <= blocks) ++order;
  for (long i = 1; w.moves() < blocks; ++i) {
    long x = 0, y = 0, rest = i;
    for (long side = 1; side < (1L << order); side *= 2, rest /= 4) {
      const long right = 1 & (rest / 2), up = 1 & (rest ^ right);
      if (up == 0) {
        if (right == 1) {
          x = side - 1 - x;
          y = side - 1 - y;
        }
        std::swap(x, y);
      }
      x += side * right;
      y += side * up;
    }
    w.move("G1 X{} Y{}", x, y);
  }
}

void relief(Writer& w, long blocks) {
  // Rows of 60 mm, 1 mm apart along x; ridges across and a round hill.
  constexpr long columns = 60;
  for (long row = 0; w.moves() < blocks; ++row) {
    const double y = 0.5 * static_cast<double>(row);
    for (long i = row == 0 ? 1 : 0; i <= columns && w.moves() < blocks; ++i) {
      const double x = static_cast<double>(row % 2 == 0 ? i : columns - i);
      const double hill = 6.0 * std::exp(-((x - 30.0) * (x - 30.0) + (y - 12.0) * (y - 12.0)) / 120.0);
      w.move("G1 X{:.4f} Y{:.4f} Z{:.4f}", x, y, hill + 0.8 * std::sin(0.9 * x + 0.4 * y) + 0.3 * std::sin(2.3 * x));
    }
  }
}

void spiral(Writer& w, long blocks) {
  // Archimedean spiral with 1.5 mm per turn; the angle increases by a chord of 1 mm at the present radius.
  constexpr double pitch = 1.5 / (2.0 * std::numbers::pi);
  for (double angle = 0.0; w.moves() < blocks;) {
    angle += 1.0 / std::max(1.0, pitch * angle);
    w.move("G1 X{:.5f} Y{:.5f}", pitch * angle * std::cos(angle), pitch * angle * std::sin(angle));
  }
}

}  // namespace

std::string_view to_string(GeneratedProgram kind) {
  return word_of(names, kind);
}

std::optional<GeneratedProgram> generated_program_from_string(std::string_view name) {
  return value_of<GeneratedProgram>(names, name);
}

void generate_program(GeneratedProgram kind, const GenerateOptions& options, std::ostream& out) {
  if (options.blocks < 10) throw std::invalid_argument("a generated program has at least 10 blocks");
  if (!(options.feed > 0.0 && options.feed < 1e9))
    throw std::invalid_argument("the feed of a generated program must be positive");
  if (!(options.tolerance > 0.0 && options.tolerance < 1e6)) {
    throw std::invalid_argument("the tolerance of a generated program must be positive");
  }
  Writer w(out);
  w.line("({}, about {} blocks)", to_string(kind), options.blocks);
  w.line("G21 G17 G90 G94");
  w.line("G64 P{:.6g}", options.tolerance);
  w.line("F{:.6g}", options.feed);
  switch (kind) {
    case GeneratedProgram::pocket: pocket(w, options.blocks); break;
    case GeneratedProgram::zigzag: zigzag(w, options.blocks); break;
    case GeneratedProgram::trochoid: trochoid(w, options.blocks); break;
    case GeneratedProgram::engraving: engraving(w, options.blocks); break;
    case GeneratedProgram::raster: raster(w, options.blocks); break;
    case GeneratedProgram::star: star(w, options.blocks); break;
    case GeneratedProgram::hilbert: hilbert(w, options.blocks); break;
    case GeneratedProgram::relief: relief(w, options.blocks); break;
    case GeneratedProgram::spiral: spiral(w, options.blocks); break;
  }
  w.line("M2");
  w.flush();
}

}  // namespace accdec
