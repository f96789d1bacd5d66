#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

enum class LineKind { empty, words, percent };

constexpr std::uint32_t letter_bit(char letter) {
  return 1U << (letter - 'A');
}

/// The words of one RS-274 block.
class Words {
 public:
  /// A G or M code, in tenths: G61.1 is 611.
  struct Item {
    int tenths;
    std::uint32_t column;
  };

  static constexpr std::uint32_t axes = letter_bit('X') | letter_bit('Y') | letter_bit('Z') | letter_bit('A') |
                                        letter_bit('B') | letter_bit('C') | letter_bit('U') | letter_bit('V') |
                                        letter_bit('W');
  static constexpr std::uint32_t arc_centers = letter_bit('I') | letter_bit('J') | letter_bit('K') | letter_bit('R');
  /// Numbers of lines, tools and spindle speeds.
  static constexpr std::uint32_t passed_over =
      letter_bit('N') | letter_bit('S') | letter_bit('T') | letter_bit('H') | letter_bit('D');
  static constexpr std::size_t codes_max = 16;

  bool has(char letter) const { return (present_ & letter_bit(letter)) != 0U; }
  std::uint32_t present() const { return present_; }
  bool any_axis() const { return (present_ & axes) != 0U; }
  double operator[](char letter) const { return value_[static_cast<std::size_t>(letter - 'A')]; }
  std::size_t column(char letter) const { return column_[static_cast<std::size_t>(letter - 'A')]; }
  /// Column of the first of the letters given, of which there must be one.
  std::size_t first_column(std::uint32_t letters) const;
  std::span<const Item> g_codes() const { return {g_.data(), g_count_}; }
  std::span<const Item> m_codes() const { return {m_.data(), m_count_}; }
  /// The program's number, O0001, as written, if its line has nothing else but comments; else empty.
  std::string_view label() const { return label_; }
  /// As written, with their brackets or semicolon; valid until the next line.
  const std::vector<std::string_view>& comments() const { return comments_; }

 private:
  friend LineKind scan_words(LineSource& source, std::string_view line, Words& words);
  /// @throws ReadError for a code of no tenths, or one too many
  void add_code(LineSource& source, char letter, double value, std::size_t column);
  /// @throws ReadError for a letter given twice
  void add_word(LineSource& source, char letter, double value, std::size_t column);
  void clear() {
    present_ = 0;
    g_count_ = m_count_ = 0;
    comments_.clear();
    label_ = {};
  }

  std::uint32_t present_ = 0;  ///< all letters but G and M
  std::array<double, 26> value_{};
  std::array<std::uint32_t, 26> column_{};
  std::array<Item, codes_max> g_{}, m_{};
  std::size_t g_count_ = 0, m_count_ = 0;
  std::vector<std::string_view> comments_;
  std::string_view label_;
};

/// @param what  is not read here  @throws NeedsInterpreter always
[[noreturn]] void needs_interpreter(const LineSource& source, std::size_t column, const std::string& what);

/// Splits a line into words and comments; a deleted block (/) counts as empty. Letters may have either case. Blanks
/// outside comments mean nothing, as in the language: X1 0.5 is X10.5.
/// @throws ReadError on anything that is no word, a letter given twice, or N that is not the first word;
///         NeedsInterpreter on parameters, expressions and O words but a program's number
LineKind scan_words(LineSource& source, std::string_view line, Words& words);

}  // namespace accdec
