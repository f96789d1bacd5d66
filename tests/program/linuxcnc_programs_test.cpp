// Programs that nobody here wrote: those of LinuxCNC's package that rs274 turns into motion without probing and without
// following the spindle. If the package is not installed, they are skipped.

#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>

#include "program_command.hpp"

namespace accdec::test {
namespace {

using testing::HasSubstr;

const std::string folder = "/usr/share/linuxcnc/ncfiles/";

class LinuxcncPrograms : public ProgramCommand {
 protected:
  void SetUp() override {
    if (std::system("command -v rs274 > /dev/null") != 0 || !std::filesystem::is_directory(folder))
      GTEST_SKIP() << "LinuxCNC (linuxcnc-uspace) is not installed";
    std::string task = "sample_period_ms = 1.0\n[program]\nerror_max_um = 20\n";
    for (const char* axis : {"x", "y", "z", "a", "b", "c"})
      task.append("[[axis]]\nname = \"")
          .append(axis)
          .append("\"\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 3000\n");
    write("task.toml", task);
    // Inches. A mill's, and one of tools whose length and diameter stand in the program that uses them.
    write("mill.tbl", "T1 P1 Z.511 D.125\nT2 P2 Z.1 D.0625\nT3 P3 Z1.273 D.201\nT4 P4 Z0 D.005\n");
    write("mount.tbl",
          "T1 P1 Z-1.1901 D.25\nT2 P2 Z-.2875 D.209\nT3 P3 Z0 D.1406\nT4 P4 Z-1.663 D.25\nT5 P5 Z-1.5042 D.5\n"
          "T6 P6 Z-.1833 D.25\nT15 P15 Z-1.5042 D.55\n");
    write("lathe.tbl", "T2 P2 D.1 I85 J25 Q2\nT7 P7 D.1 I-30 J30 Q7\nT9 P9 D.1 Q9\nT10 P10 D0\n");
  }
  static std::string table_for(const std::string& program) {
    return program.starts_with("lathe") ? "lathe.tbl" : "mill.tbl";
  }
};

class EveryLinuxcncProgram : public LinuxcncPrograms, public testing::WithParamInterface<std::string> {};

TEST_P(EveryLinuxcncProgram, IsPlannedAndVerified) {
  const std::string options = " --task task.toml --json r.json --tool-table-inch --tool-table ";
  ASSERT_EQ(run("program " + folder + GetParam() + ".ngc" + options + table_for(GetParam())).code, 0) << read("err");
  EXPECT_EQ(run("verify r.json").code, 0) << read("out") << read("err");
}

INSTANTIATE_TEST_SUITE_P(All, EveryLinuxcncProgram,
                         testing::Values("3D_Chips", "3dtest", "arcspiral", "b-index", "cds", "comp", "comp-g1",
                                         "comp311", "comp311_2", "daisy", "flowsnake",
                                         "gmoccapy_2_tools_with_cutter_radius_compensation", "hole-circle",
                                         "lathe_g70_71_demo", "lathe_g7x_face_boring", "lathe_g7x_quadrants",
                                         "lathe_pawn", "lathecomp", "plasmatest", "polar", "skeleton", "spiral",
                                         "systems", "toplevel", "tort", "useful-subroutines"));

TEST_F(LinuxcncPrograms, SpindleMovesAreRefusedByLine) {
  const std::string table = " --task task.toml --tool-table mount.tbl --tool-table-inch";
  EXPECT_EQ(run("program " + folder + "mmount.ngc" + table).code, 2);
  EXPECT_THAT(read("err"), HasSubstr("mmount.ngc:314:1: G33, G76 or G95 moves with the spindle"));
}

}  // namespace
}  // namespace accdec::test
