// Well-formed tables as spreadsheets and cameras write them, and malformed ones. Each reader accepts the
// former with their intended meaning and refuses the latter with file, line and column.

#include <gtest/gtest.h>

#include <cmath>

#include "core/table.hpp"
#include "core/table_text.hpp"
#include "imaging/benchmark/score.hpp"
#include "imaging/phase/trigger_list.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"
#include "sim/start/start.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::calibration::tables_test {
namespace {

/// Reads a table of two columns with one of the readers and returns the numbers of the second row.
struct TableReader {
  const char *name, *first, *second;
  std::pair<double, double> (*read)(const std::filesystem::path&);
};

std::pair<double, double> of_calibration(const std::filesystem::path& file) {
  const Table table = read_table(file);
  return {table.column("a").at(1), table.column("b").at(1)};
}
std::pair<double, double> of_triggers(const std::filesystem::path& file) {
  const imaging::PhaseTable table = imaging::read_triggers(file, 1.0, 4);
  return {table.frames.at(1).cycle * 4.0, table.frames.at(1).phase};
}
std::pair<double, double> of_truth(const std::filesystem::path& file) {
  const auto truth = imaging::read_truth(file);
  return {truth.at(0).at(1).x, truth.at(0).at(1).y};
}
std::pair<double, double> of_beads(const std::filesystem::path& file) {
  const sim::Scene scene = sim::read_scene_text(
      "preset = \"fortini-huang-2015\"\ndrive.gamma = 1.5\nstart.kind = \"table\"\nstart.from = '" +
          file.string() + "'\n",
      "scene.toml");
  const sim::Start start = sim::from_table(scene, Progress::none());
  return {start.beads.at(1).x, start.beads.at(1).z};
}

const TableReader kReaders[] = {{"calibration", "a", "b", of_calibration},
                                {"triggers", "frame", "cycles", of_triggers},
                                {"truth", "x_px", "y_px", of_truth},
                                {"beads", "x", "z", of_beads}};

/// Replaces "A,B" and "R" in a text by the reader's column names and by the third column that truth requires.
std::string in_words_of(const TableReader& reader, std::string text) {
  const bool truth = std::string(reader.name) == "truth";
  const auto put = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  };
  put("<R>", truth ? ",r_px" : "");
  put("<r>", truth ? ",5" : "");
  put("<A>", reader.first);
  put("<B>", reader.second);
  return text;
}

TEST(Tables, MarksAndLineEndsOfOtherSystemsChangeNothing) {
  const TemporaryFolder folder;
  for (const TableReader& reader : kReaders)
    for (const std::string text : {"<A>,<B><R>\n0,2<r>\n1,3<r>\n", "\xEF\xBB\xBF<A>,<B><R>\n0,2<r>\n1,3<r>\n",
                                   "<A>,<B><R>\r\n0,2<r>\r\n1,3<r>\r\n", "<A>,<B><R>\r0,2<r>\r1,3<r>\r",
                                   "\xEF\xBB\xBF<A>,<B><R>\r\n0,2<r>\r\n1,3<r>"}) {
      put_file(folder / "t.csv", in_words_of(reader, text));
      const auto [a, b] = reader.read(folder / "t.csv");
      const bool triggers = std::string(reader.name) == "triggers";
      EXPECT_EQ(a, triggers ? 4 : 1) << reader.name << ": " << text;
      EXPECT_EQ(b, triggers ? 0 : 3) << reader.name << ": " << text;
    }
}

TEST(Tables, WhatIsNoTableIsRefusedByEveryReader) {
  const TemporaryFolder folder;
  struct Case {
    std::string text, words;
  };
  const Case cases[] = {
      {"<A>,<B>,<B><R>\n0,2,2<r>\n1,3,3<r>\n", "twice"},
      {"<A>;<B><R>\n0;2<r>\n1;3<r>\n", ""},  // with R there is a comma, and column names are missing
      {"0,2<r>\n1,3<r>\n", ""},
      {"<A>,<B><R>\n0,2<r>\n1,3,5<r>\n", ":3:"},
      {"<A>,<B><R>\n0,2<r>\n1\n", ":3:"},
      {"<A>,<B><R>\n0,2<r>\n1,three<r>\n", "three"},
      {"<A>,<B><R>\n0,2<r>\n1,inf<r>\n", "inf"},
      {std::string("\xFF\xFE<\0A\0", 6), "UTF-16"},
      {"", ""},
  };
  for (const TableReader& reader : kReaders)
    for (const Case& c : cases) {
      put_file(folder / "t.csv", in_words_of(reader, c.text));
      try {
        (void)reader.read(folder / "t.csv");
        ADD_FAILURE() << reader.name << " takes " << c.text;
      } catch (const InputError& e) {
        const std::string said = e.what();
        EXPECT_NE(said.find("t.csv"), std::string::npos) << reader.name << ": " << said;
        EXPECT_NE(said.find(c.words), std::string::npos) << reader.name << " of " << c.text << ": " << said;
      }
    }
}

TEST(Tables, ALineOfNumbersAndSemicolonsAreNamedAsWhatTheyAre) {
  const TemporaryFolder folder;
  put_file(folder / "t.csv", "1.5,2\n2,3\n");
  expect_refusal<InputError>([&] { (void)read_table(folder / "t.csv"); },
                             "t.csv:1:", "must name the columns");
  put_file(folder / "t.csv", "time;height\n0,5;1\n");
  expect_refusal<InputError>([&] { (void)read_table(folder / "t.csv"); }, "t.csv:1:", "semicolons");
  put_file(folder / "t.csv", "time\theight\n0.5\t1\n");
  expect_refusal<InputError>([&] { (void)read_table(folder / "t.csv"); }, "tabs");
}

// Tables of sweeps begin with the ids of their points.
TEST(Tables, ColumnsOfTextStandBesideThoseOfNumbers) {
  const TemporaryFolder folder;
  put_file(folder / "t.csv", "id,N_l,\"s_b, sigma\",note\n\"a,1\", 6 ,0.5,\n\"b \"\"2\"\"\",8,,x\n");
  const Table table = read_table(folder / "t.csv");
  EXPECT_EQ(table.names, (std::vector<std::string>{"id", "N_l", "s_b, sigma", "note"}));
  EXPECT_EQ(table.column("N_l"), (std::vector<double>{6, 8}));
  EXPECT_EQ(table.column("s_b, sigma").at(0), 0.5);
  EXPECT_TRUE(std::isnan(table.column("s_b, sigma").at(1)));
  expect_refusal<InputError>([&] { (void)table.column("id"); }, "t.csv:2: id: \"a,1\" is not a finite number",
                             "columns of numbers are N_l, s_b, sigma");
  expect_refusal<InputError>([&] { (void)table.column("note"); }, "t.csv:3: note: \"x\"");
  put_file(folder / "t.csv", "a,b\nx,y\n");
  expect_refusal<InputError>([&] { (void)read_table(folder / "t.csv").column("b"); },
                             "t.csv:2: b:", "no column holds numbers alone");
}

// As pandas writes marks. One that strays into a column of numbers is not the number 1.
TEST(Tables, MarksAreNoNumbers) {
  const TemporaryFolder folder;
  put_file(folder / "t.csv", "x,y,tracer\n1,2,True\n2,true,False\n");
  const Table table = read_table(folder / "t.csv");
  EXPECT_EQ(table.column_of_marks("tracer"), (std::vector<double>{1, 0}));
  EXPECT_EQ(table.column_of_marks("x"), (std::vector<double>{1, 2}));
  expect_refusal<InputError>([&] { (void)table.column("tracer"); },
                             "t.csv:2: tracer: \"True\" is not a finite");
  expect_refusal<InputError>([&] { (void)table.column("y"); }, "t.csv:3: y: \"true\" is not a finite number");
  expect_refusal<InputError>([&] { (void)table.column_of_marks("y"); }, "t.csv:3: y: \"true\"");
}

TEST(Tables, FieldsOfALine) {
  using Fields = std::vector<std::string_view>;
  EXPECT_EQ(fields_of("a, b ,\"c,d\" ,"), (Fields{"a", "b", "c,d", ""}));
  EXPECT_EQ(fields_of(""), Fields{""});
  EXPECT_EQ(fields_of("\"open,b"), (Fields{"\"open", "b"}));
  EXPECT_EQ(fields_of("\"a\"b,c"), (Fields{"\"a\"b", "c"}));
  EXPECT_EQ(fields_of("\"\",2"), (Fields{"", "2"}));
}

// A decimal comma splits a number into two fields: the first of them is not a time.
TEST(Tables, MalformedTriggerListIsRefused) {
  const TemporaryFolder folder;
  struct Case {
    const char *text, *words;
  };
  const Case cases[] = {
      {"frame,time_s\n0,0,0000\n1,0,0025\n", "t.csv:2: 3 fields"},
      {"frame,time_s,cycles\n0,0,0\n1,0.1,1\n", "time_s: and cycles are the same quantity"},
      {"frame,cycles\n0,1\n1,1\n2,1\n", "cycles: is 1 in all 3 frames"},
      {"frame,cycles\n0,1\n1,2\n1,3\n", "t.csv:4: frame: 1 where 2 was expected"},
      {"frame,cycles\n0,1\n1,x\n", "'x' is not a number"},
  };
  for (const Case& c : cases) {
    put_file(folder / "t.csv", c.text);
    expect_refusal<InputError>([&] { (void)imaging::read_triggers(folder / "t.csv", 1.0, 4); }, c.words);
  }
}

TEST(Tables, TruthHasWholeFramesAndRadii) {
  const TemporaryFolder folder;
  struct Case {
    const char *row, *words;
  };
  const Case cases[] = {{"0.5,1,2,3,5", "t.csv:2: frame: is 0.5"},
                        {"-1,1,2,3,5", "frame: is -1"},
                        {"1e300,1,2,3,5", "frame: is 1e300"},
                        {"0,1.5,2,3,5", "id: is 1.5"},
                        {"0,1e300,2,3,5", "id: is 1e300"},
                        {"0,1,nan,3,5", "x_px: is 'nan'"},
                        {"0,1,2,3,-5", "r_px: is -5"},
                        {"0,1,2,3,0", "r_px: is 0"}};
  for (const Case& c : cases) {
    put_file(folder / "t.csv", "frame,id,x_px,y_px,r_px\n" + std::string(c.row) + "\n");
    expect_refusal<InputError>([&] { (void)imaging::read_truth(folder / "t.csv"); }, c.words);
  }
}

}  // namespace
}  // namespace twincell::calibration::tables_test
