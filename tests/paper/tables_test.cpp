#include <gtest/gtest.h>

#include <accdec/paper/paper_tables.hpp>

namespace accdec::paper {
namespace {

void expect_table(const Table& table) {
  ASSERT_EQ(table.entries.size(), 20u);
  for (const Entry& e : table.entries) {
    EXPECT_TRUE(e.agrees()) << table.name << " v1 = " << e.feed_in << "e5 BLU/s, dT = " << e.delay
                            << " T: " << e.formula << " and " << e.simulated << ", printed " << e.printed;
    // No entry depends on how halves are rounded.
    EXPECT_GT(e.tie_distance(), 1e-3);
  }
  EXPECT_EQ(table.disagreements(), 0);
  // Sums of some 200 terms of the size of the path, a thousand times the largest error.
  EXPECT_LT(formula_simulation_difference(table), 1e-11);
}

TEST(PaperTables, AllTwentyEntriesOfTable1) {
  expect_table(table1());
}
TEST(PaperTables, AllTwentyEntriesOfTable2) {
  expect_table(table2());
}

TEST(PaperTables, NoticesAWrongEntry) {
  Table table = table1();
  table.entries[3].printed += 1;
  EXPECT_EQ(table.disagreements(), 1);
}

}  // namespace
}  // namespace accdec::paper
