// What the user reads names the output that was asked for, never the temporary file or folder.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/atomic_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::final_names_test {
namespace {

namespace fs = std::filesystem;

TEST(FinalNames, StandForTheTemporaryOnesAlsoAfterAFailure) {
  const TemporaryFolder folder;
  std::string said;
  {
    const AtomicPath table(folder / "t.csv", Product::part());
    const AtomicPath figures(folder / "figures", Product::whole_folder("a folder of figures"));
    said = table.part().string() + ": no space; " + (figures.part() / "f.svg").string() + ": no space, " +
           table.part().string();
    EXPECT_NE(said.find(".part"), std::string::npos);
  }
  EXPECT_EQ(in_final_names(said), (folder / "t.csv").string() + ": no space; " +
                                      (folder / "figures/f.svg").string() + ": no space, " +
                                      (folder / "t.csv").string());
  EXPECT_EQ(in_final_names("no path"), "no path");
}

TEST(FinalNames, OfFinishedOutputsAreForgotten) {
  const TemporaryFolder folder;
  std::string part;
  {
    AtomicPath table(folder / "t.csv", Product::part());
    part = table.part().string();
    std::ofstream(table.part()) << "1\n";
    table.commit();
  }
  EXPECT_EQ(in_final_names(part), part);
}

}  // namespace
}  // namespace twincell::final_names_test
