#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include <accdec/files/packed_text.hpp>

namespace accdec {
namespace {

constexpr std::size_t plenty = 1 << 24;

std::string random_text(std::size_t length, unsigned seed) {
  std::mt19937 random(seed);
  std::string text;
  for (std::size_t i = 0; i < length; ++i) text += static_cast<char>(random() % 256);
  return text;
}

TEST(PackedText, RoundTrip) {
  for (const std::size_t length : {0, 1, 2, 3, 4, 5, 1000, 3'000'000}) {
    const std::string text = random_text(length, 1), same(length, 'x');
    EXPECT_EQ(unpack_text(pack_text(text), plenty), text) << length;
    EXPECT_EQ(unpack_text(pack_text(same), plenty), same) << length;
  }
}

// printf 'accdec\n' | gzip -n | base64
TEST(PackedText, ReadsWhatGzipWrites) {
  EXPECT_EQ(unpack_text("H4sIAAAAAAAAA0tMTk5JTeYCAKNQArQHAAAA", 7), "accdec\n");
  EXPECT_THROW(unpack_text("H4sIAAAAAAAAA0tMTk5JTeYCAKNQArQHAAAA", 6), std::runtime_error);
}

TEST(PackedText, AnyCutAndAnyChangedLetterIsRefused) {
  const std::string text = random_text(300, 2), packed = pack_text(text);
  for (std::size_t length = 0; length < packed.size(); ++length)
    EXPECT_THROW(unpack_text(packed.substr(0, length), plenty), std::runtime_error) << length;
  int other = 0;
  for (std::size_t at = 0; at < packed.size(); ++at) {
    std::string changed = packed;
    changed[at] = changed[at] == 'A' ? 'B' : 'A';
    try {
      // Letters of gzip's header that say nothing of the text (the time, the system) may change.
      if (unpack_text(changed, plenty) != text) ++other;
    } catch (const std::runtime_error&) {
    }
  }
  EXPECT_EQ(other, 0);
}

TEST(PackedText, ForeignLettersAndTextsBehindAreRefused) {
  const std::string packed = pack_text("text");
  for (const char* bad : {"", "AAAA", "a b=", "====", "\xc3\xa4\xc3\xa4", "H4sI"})
    EXPECT_THROW(unpack_text(bad, plenty), std::runtime_error) << bad;
  EXPECT_THROW(unpack_text(packed + "AAAA", plenty), std::runtime_error);
  EXPECT_THROW(unpack_text(packed + packed, plenty), std::runtime_error);
}

// A thousand times its own length.
TEST(PackedText, UnpacksNoFurtherThanAllowed) {
  const std::string bomb = pack_text(std::string(50'000'000, '['));
  ASSERT_LT(bomb.size(), 100'000u);
  EXPECT_THROW(unpack_text(bomb, 64 * bomb.size()), std::runtime_error);
}

}  // namespace
}  // namespace accdec
