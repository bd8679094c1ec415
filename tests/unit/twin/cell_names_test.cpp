// Pairs of stacks and cell files as the arguments of match name them.
#include "twin/cell_names.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::twin::cell_names_test {
namespace {

namespace fs = std::filesystem;

/// Two stacks, gamma-1.5 and gamma-2.0, without cell files.
struct TwoStacks {
  TwoStacks() {
    for (const char* name : {"gamma-1.5", "gamma-2.0"}) fs::create_directory(folder / name);
  }
  TemporaryFolder folder;
  fs::path weak = folder / "gamma-1.5", strong = folder / "gamma-2.0";
};

TEST(CellNames, ADotInAFolderIsNoExtension) {
  const TwoStacks s;
  EXPECT_EQ(names_of_stacks({s.weak, s.strong}), (std::vector<std::string>{"gamma-1.5", "gamma-2.0"}));
  EXPECT_EQ(names_of_stacks({s.weak / "", "day/film.avi"}), (std::vector<std::string>{"gamma-1.5", "film"}));
}

TEST(CellNames, EqualNamesAreToldApart) {
  EXPECT_EQ(names_of_stacks({"a/frames", "b/frames"}), (std::vector<std::string>{"a-frames", "b-frames"}));
  EXPECT_EQ(names_of_stacks({"a/f.avi", "a/f.tif"}), (std::vector<std::string>{"f.avi", "f.tif"}));
  EXPECT_EQ(names_of_stacks({"f.h5:/day/1", "f.h5:/day/2"}),
            (std::vector<std::string>{"f.h5-day-1", "f.h5-day-2"}));
  EXPECT_EQ(names_of_stacks({"a/c/frames", "b/c/frames"}),
            (std::vector<std::string>{"a-c-frames", "b-c-frames"}));
}

// `match` pairs the stacks by name with the cell files that `new` wrote, and both may list them differently.
TEST(CellNames, NamesDoNotDependOnTheOrder) {
  const std::vector<fs::path> stacks = {"a/c/frames", "b/c/frames", "a/f.avi", "a/f.tif"};
  const std::vector<std::string> names = names_of_stacks(stacks);
  EXPECT_EQ(names_of_stacks({stacks.rbegin(), stacks.rend()}),
            (std::vector<std::string>{names.rbegin(), names.rend()}));
}

TEST(CellNames, TheReportKeepsItsFolder) {
  EXPECT_EQ(names_of_stacks({"day/report", "day/frames"}),
            (std::vector<std::string>{"day-report", "frames"}));
}

TEST(CellNames, AStackIsNamedOnce) {
  const TwoStacks s;
  const fs::path link = s.folder / "link";
  fs::create_directory_symlink(s.weak, link);
  for (const fs::path& again : {s.weak, s.weak / "", s.weak / ".." / "gamma-1.5", link})
    expect_refusal<ConfigError>([&] { (void)names_of_stacks({s.weak, again}); }, "same stack", "gamma-1.5");
}

TEST(CellNames, OneCellServesAllAndSeveralArePairedInOrder) {
  const TwoStacks s;
  const auto one = pair_stacks({s.weak, s.strong, "CELL.toml"});
  EXPECT_EQ(one.stacks, (std::vector<fs::path>{s.weak, s.strong}));
  EXPECT_EQ(one.cells, (std::vector<fs::path>{"CELL.toml", "CELL.toml"}));
  const auto two = pair_stacks({s.weak, "a.toml", s.strong, "b.toml"});
  EXPECT_EQ(two.cells, (std::vector<fs::path>{"a.toml", "b.toml"}));
}

TEST(CellNames, AFolderOfCellsGivesTheCellOfEachName) {
  const TwoStacks s;
  fs::create_directory(s.folder / "cells");
  for (const char* name : {"gamma-1.5.toml", "gamma-2.0.toml"}) put_file(s.folder / "cells" / name, "");
  const auto p = pair_stacks({s.strong, s.weak, s.folder / "cells"});
  EXPECT_EQ(p.cells,
            (std::vector<fs::path>{s.folder / "cells/gamma-2.0.toml", s.folder / "cells/gamma-1.5.toml"}));
  fs::remove(s.folder / "cells/gamma-2.0.toml");
  expect_refusal<ConfigError>(
      [&] {
        (void)pair_stacks({s.weak, s.strong, s.folder / "cells"});
      },
      "gamma-2.0.toml", "twincell new");
}

TEST(CellNames, WithoutCellsEachStackHasItsOwn) {
  const TwoStacks s;
  put_file(s.weak / "CELL.toml", "");
  expect_refusal<ConfigError>(
      [&] {
        (void)pair_stacks({s.weak, s.strong});
      },
      "gamma-2.0/CELL.toml", "twincell new");
  put_file(s.strong / "CELL.toml", "");
  EXPECT_EQ(pair_stacks({s.weak, s.strong}).cells,
            (std::vector<fs::path>{s.weak / "CELL.toml", s.strong / "CELL.toml"}));
}

TEST(CellNames, NumbersThatDoNotFitAreRefused) {
  const TwoStacks s;
  expect_refusal<ConfigError>(
      [&] {
        (void)pair_stacks({s.weak, s.strong, "gamma-3", "a.toml", "b.toml"});
      },
      "3 stacks", "2 cell files");
  expect_refusal<ConfigError>([&] { (void)pair_stacks({"a.toml"}); }, "no stack");
}

}  // namespace
}  // namespace twincell::twin::cell_names_test
