// The table of CELL.toml's keys against the reader, the reader's source and the page that users read.
#include "imaging/cell/cell_keys.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "core/error.hpp"
#include "imaging/cell/cell.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell {
namespace {

const std::filesystem::path kSource = TWINCELL_SOURCE_DIR;

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream all;
  all << std::ifstream(file).rdbuf();
  return all.str();
}

/// A cell file with one key, and what its unit needs.
std::string cell_with(const std::string& key, const std::string& value) {
  const auto dot = key.find('.');
  const std::string table = key.substr(0, dot), name = key.substr(dot + 1);
  std::string text = "[" + table + "]\n" + name + " = " + value + "\n";
  const bool laboratory = std::regex_search(name, std::regex("_(mm|hz|rad_s|mm_s|m_s2)$"));
  if (laboratory && table != "scale" && table != "camera")
    text += "[scale]\nsigma_mm = 2.0\ngravity_m_s2 = 9.81\n";
  if (name == "first_phase") text += "frames_per_cycle = 20\n";
  return text;
}

std::set<std::string> table_keys() {
  std::set<std::string> keys;
  for (const CellKey& k : cell_keys()) EXPECT_TRUE(keys.insert(k.key).second) << k.key << " is listed twice";
  return keys;
}

TEST(CellKeys, EachExampleIsReadAndEachValueOutOfRangeIsRefused) {
  const TemporaryFolder folder;
  const auto file = folder / "CELL.toml";
  for (const CellKey& k : cell_keys()) {
    if (std::string(k.key) == "calibration.from") continue;  // needs a file: calibration_file_test.cpp
    put_file(file, cell_with(k.key, k.example));
    EXPECT_NO_THROW((void)read_cell(file)) << k.key << " = " << k.example;
    put_file(file, cell_with(k.key, k.out_of_range));
    // Bounds of the drive are checked where A and omega are solved for.
    EXPECT_THROW((void)read_cell(file).drive(), ConfigError) << k.key << " = " << k.out_of_range;
  }
}

TEST(CellKeys, AKeyThatIsNotInTheTableIsRefused) {
  const TemporaryFolder folder;
  const auto file = folder / "CELL.toml";
  for (const char* key :
       {"camera.exposure_s", "cell.depth_mm", "drive.phase", "scale.mass_kg", "beads.radius_sigma"}) {
    put_file(file, cell_with(key, "1.0"));
    EXPECT_THROW((void)read_cell(file), ConfigError) << key;
  }
}

// A key that is added to the reader must be added to the table.
TEST(CellKeys, TheTableHasEveryKeyThatTheReaderQueries) {
  const std::set<std::string> keys = table_keys();
  std::set<std::string> queried;
  const auto collect = [&](const char* file, const std::string& pattern, auto name_of) {
    const std::string text = text_of(kSource / file);
    const std::regex query(pattern);
    for (std::sregex_iterator it(text.begin(), text.end(), query), end; it != end; ++it)
      queried.insert(name_of(*it));
  };
  collect("imaging/cell/cell.cpp",
          R"((camera|box|scale)\.(?:number_in|numbers|number|integer_in|boolean|word)\(\s*"(\w+)\")",
          [](const std::smatch& m) { return (m[1] == "box" ? "cell" : m[1].str()) + "." + m[2].str(); });
  collect("trajectory/drive.cpp", R"(drive\.number\("(\w+)\"\))",
          [](const std::smatch& m) { return "drive." + m[1].str(); });
  EXPECT_EQ(queried.size(), 21U);  // 9 of the camera, 4 of the cell, 6 of the drive, 2 of the scale
  collect("trajectory/unit_keys.cpp", R"re(Spelling\{"(drive|cell|scale)", "(\w+)", "(\w+)")re",
          [](const std::smatch& m) { return m[1].str() + "." + m[3].str(); });
  for (const std::string& key : queried) {
    if (key.starts_with("cell.depth")) continue;  // of scenes; the reader of cells refuses it
    EXPECT_TRUE(keys.contains(key)) << key << " is missing in imaging/cell/cell_keys.cpp";
  }
  queried.insert("calibration.from");  // read by include_calibration()
  for (const std::string& key : keys) EXPECT_TRUE(queried.contains(key)) << key << " is not read";
}

TEST(CellKeys, ThePageShowsTheTable) {
  EXPECT_NE(text_of(kSource / "docs/cell.md").find(cell_keys_markdown()), std::string::npos)
      << "docs/cell.md needs the output of twincell new --keys:\n"
      << cell_keys_markdown();
}

}  // namespace
}  // namespace twincell
