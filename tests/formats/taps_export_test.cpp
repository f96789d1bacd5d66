#include <cstring>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/filter.hpp>
#include <accdec/result.hpp>

namespace accdec {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

DesignResult result_of(const Filter& filter) {
  DesignResult result;
  result.filter = filter;
  result.task.sample_period = 2e-3;
  return result;
}

/// Convolution of moving averages, as a cascade of them computes it.
Filter averages(const std::vector<int>& lengths, int leading_zeros = 0) {
  std::vector<double> taps(static_cast<std::size_t>(leading_zeros) + 1, 0.0);
  taps.back() = 1.0;
  for (const int length : lengths) {
    std::vector<double> next(taps.size() + static_cast<std::size_t>(length) - 1, 0.0);
    for (std::size_t i = 0; i < taps.size(); ++i) {
      for (std::size_t j = 0; j < static_cast<std::size_t>(length); ++j) next[i + j] += taps[i] / length;
    }
    taps = next;
  }
  return Filter(taps);
}

TEST(TapsExport, NpyIsWhatTheFormatSays) {
  const Filter filter({1.0, 2.0, 5.0});
  const std::string bytes = export_taps(result_of(filter), "npy");
  // NumPy format 1.0: magic, version, little-endian header length, header, then the data aligned to 64 bytes.
  ASSERT_GE(bytes.size(), 10U);
  EXPECT_EQ(bytes.substr(0, 6), "\x93NUMPY");
  EXPECT_EQ(bytes[6], 1);
  EXPECT_EQ(bytes[7], 0);
  const std::size_t length = static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ((10 + length) % 64, 0U);
  const std::string header = bytes.substr(10, length);
  EXPECT_THAT(header, HasSubstr("'descr': '<f8'"));
  EXPECT_THAT(header, HasSubstr("'fortran_order': False"));
  EXPECT_THAT(header, HasSubstr("'shape': (3,)"));
  EXPECT_EQ(header.back(), '\n');
  ASSERT_GE(bytes.size(), 10 + length + 3 * 8);
  EXPECT_EQ(bytes.substr(10 + length + 3 * 8, 6), "\x93NUMPY");  // the next array: delays
  double taps[3];  // on a little-endian machine; the byte order itself is that of the format
  std::memcpy(taps, bytes.data() + 10 + length, sizeof taps);
  EXPECT_THAT(taps, ElementsAre(0.125, 0.25, 0.625));
}

TEST(TapsExport, NamesAreNoFormulas) {
  DesignResult result = result_of(hann(7));
  result.task.title = "=cmd|' /C calc'!A0";
  result.corners.resize(1);
  result.corners[0].name = "@SUM(A1:A9)";
  const std::string csv = export_taps(result, "csv");
  EXPECT_THAT(csv, HasSubstr("\n# title,'=cmd|' /C calc'!A0\n"));
  EXPECT_THAT(csv, HasSubstr(",'@SUM(A1:A9),"));
}

TEST(TapsExport, TextFormatsKeepEveryBit) {
  const Filter filter = hann(7);
  std::istringstream csv(export_taps(result_of(filter), "csv"));
  std::string line;
  std::getline(csv, line);
  for (int i = 0; i <= 7; ++i) {
    std::getline(csv, line);
    const std::size_t comma = line.find(',');
    EXPECT_EQ(line.substr(0, comma), std::to_string(i));
    EXPECT_EQ(std::stod(line.substr(comma + 1)), filter.tap(i));
  }
  const auto json = nlohmann::json::parse(export_taps(result_of(filter), "json"));
  EXPECT_EQ(json["order"], 7);
  EXPECT_EQ(json["sample_period_s"], 2e-3);
  for (int i = 0; i <= 7; ++i) EXPECT_EQ(json["taps"][static_cast<std::size_t>(i)].get<double>(), filter.tap(i));
  const std::string c = export_taps(result_of(filter), "c");
  EXPECT_THAT(c, HasSubstr("static const double accdec_taps[ACCDEC_ORDER + 1] = {"));
  EXPECT_THAT(c, HasSubstr("#define ACCDEC_ORDER 7"));
  EXPECT_THAT(c, HasSubstr("0.002"));
  EXPECT_THAT(c, HasSubstr("N + 1 = 8 taps"));
}

TEST(TapsExport, CascadesAreFound) {
  EXPECT_THAT(moving_average_cascade(boxcar(40)), ElementsAre(41));
  EXPECT_THAT(moving_average_cascade(trapezoid(20, 5)), ElementsAre(16, 6));  // 16 + 6 - 1 = 21 taps, ramps of 5
  EXPECT_THAT(moving_average_cascade(averages({30, 12, 7})), ElementsAre(30, 12, 7));
  EXPECT_THAT(moving_average_cascade(averages({9, 4}, 3)), ElementsAre(9, 4));
  EXPECT_TRUE(moving_average_cascade(hann(12)).empty());
  EXPECT_TRUE(moving_average_cascade(Filter({1.0, 0.0, 0.0, 1.0})).empty());  // a zero-vibration shaper
}

TEST(TapsExport, CascadeFileAndRefusal) {
  const auto json = nlohmann::json::parse(export_taps(result_of(averages({9, 4}, 3)), "cascade"));
  EXPECT_EQ(json["moving_average_lengths"], (std::vector<int>{9, 4}));
  EXPECT_EQ(json["leading_delay_samples"], 3);
  try {
    export_taps(result_of(hann(12)), "cascade");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("nearest one of two, lengths"));
    EXPECT_THAT(error.what(), HasSubstr("misses a tap by"));
  }
  EXPECT_THROW(export_taps(result_of(hann(12)), "xml"), std::invalid_argument);
  EXPECT_THROW(export_taps(DesignResult{}, "csv"), std::invalid_argument);
}

}  // namespace
}  // namespace accdec
