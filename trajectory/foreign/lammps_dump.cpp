// Text dumps of LAMMPS: `dump custom`, `dump atom`. Source: LAMMPS manual, `dump` and `read_dump` commands.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/foreign/text_file.hpp"

namespace twincell {

namespace {

constexpr int kNoColumn = -1;

/// Column and convention of one coordinate.
struct Coordinate {
  int column = kNoColumn;
  bool scaled = false, wrapped = false;
  int image = kNoColumn;  ///< column of ix, iy or iz
};

struct ColumnPlaces {
  std::size_t count = 0;
  int id = kNoColumn, type = kNoColumn, radius = kNoColumn, mass = kNoColumn;
  bool is_diameter = false;
  std::array<Coordinate, 3> position;
  std::array<int, 3> velocity{kNoColumn, kNoColumn, kNoColumn}, spin{kNoColumn, kNoColumn, kNoColumn};
};

/// Unit of length of LAMMPS's `units` of that name; empty for lj, whose lengths are those of the scene, and
/// for a name that LAMMPS does not have.
std::string length_unit_of(const std::string& units) {
  constexpr std::array<std::pair<std::string_view, const char*>, 7> kUnits = {{{"si", "m"},
                                                                               {"cgs", "cm"},
                                                                               {"micro", "micrometres"},
                                                                               {"nano", "nm"},
                                                                               {"real", "Angstrom"},
                                                                               {"metal", "Angstrom"},
                                                                               {"electron", "Bohr radii"}}};
  for (const auto& [name, unit] : kUnits)
    if (units == name) return unit;
  return {};
}

/// Columns and ids may be in any order. Required are `id` and per axis one of xu, xsu, x, xs (s: scaled by
/// the box, u: unwrapped); optional are vx …, omegax …, radius or diameter, mass, type, ix ….
class DumpReader final : public ForeignReader {
 public:
  explicit DumpReader(const std::filesystem::path& path)
      : ForeignReader(path), in_(path), line_(in_.line()) {}

  bool next(ForeignFrame& s) override {
    bool begun = false;
    s.time.reset();
    s.beads.clear();
    std::optional<std::size_t> announced;
    bool step_known = false, box_known = false;
    while (in_.next()) {
      begun = true;
      line_.erase(line_.find_last_not_of(" \t\r") + 1);
      if (line_.rfind("ITEM: ", 0) != 0)
        fail(in_.number() == 1
                 ? fmt::format("'ITEM: TIMESTEP' is missing; this is not a text dump of LAMMPS. "
                               "Formats that are read: {}.",
                               read_formats())
                 : fmt::format("'ITEM:' is missing, '{}' was found.", excerpt()));
      const std::string section = line_.substr(6);
      if (section == "UNITS") {
        need_line("the units");
        length_unit_ = length_unit_of(line_.substr(0, line_.find_last_not_of(" \t\r") + 1));
      } else if (section == "TIMESTEP") {
        need_line("the step");
        s.line = in_.number();
        s.step = whole(only_word());
        step_known = true;
      } else if (section == "TIME") {
        need_line("the time");
        s.time = number(only_word());
      } else if (section == "NUMBER OF ATOMS") {
        need_line("the number of atoms");
        const std::int64_t n = whole(only_word());
        if (n < 0) fail(fmt::format("{} atoms are announced.", n));
        announced = static_cast<std::size_t>(n);
      } else if (section.rfind("BOX BOUNDS", 0) == 0) {
        read_box(section.substr(10), s);
        box_known = true;
      } else if (section.rfind("ATOMS", 0) == 0) {
        if (!step_known) fail("atoms come before 'ITEM: TIMESTEP'.");
        if (!announced) fail("atoms come before 'ITEM: NUMBER OF ATOMS'.");
        if (!box_known) fail("atoms come before 'ITEM: BOX BOUNDS'.");
        place_columns(section.substr(5));
        read_atoms(*announced, s);
        return true;
      } else {
        fail(fmt::format("the section '{}' is unknown.", excerpt()));
      }
    }
    if (begun) fail("the file ends within a frame.");
    return false;
  }

  [[nodiscard]] std::string length_unit() const override { return length_unit_; }
  [[nodiscard]] const ForeignColumns& columns() const override { return has_; }
  [[nodiscard]] std::int64_t size() const override { return in_.size(); }
  [[nodiscard]] std::int64_t done() const override { return in_.done(); }

 private:
  [[noreturn]] void fail(const std::string& complaint) const { fail_at(in_.number(), complaint); }

  void need_line(const char* what) {
    if (!in_.next()) fail(fmt::format("the file ends where {} should be.", what));
  }
  [[nodiscard]] std::string excerpt() const { return line_.substr(0, 60); }

  std::string_view only_word() {
    split_words(line_, words_);
    if (words_.size() != 1) fail(fmt::format("one number is needed, '{}' was found.", excerpt()));
    return words_[0];
  }
  [[nodiscard]] std::int64_t whole(std::string_view word) const { return whole_at(in_.number(), word); }
  [[nodiscard]] double number(std::string_view word) const { return number_at(in_.number(), word); }

  /// Bounds of the box: `lo hi`; `lo hi tilt` after the words xy xz yz; or, after abc origin, an edge vector
  /// and a component of the corner. The tilts must be 0, and the edges along the axes.
  void read_box(const std::string& flags, ForeignFrame& s) {
    split_words(flags, words_);
    std::size_t first_flag = 0, needed = 2;
    if (words_.size() >= 3 && words_[0] == "xy" && words_[1] == "xz" && words_[2] == "yz")
      first_flag = 3, needed = 3;
    else if (words_.size() >= 2 && words_[0] == "abc" && words_[1] == "origin")
      first_flag = 2, needed = 4;
    const std::size_t flagged = words_.size() - first_flag;
    if (flagged != 3 && flagged != 0)
      fail(fmt::format("the words '{}' do not describe a box of LAMMPS.", flags.substr(0, 60)));
    for (std::size_t k = 0; k < 3; ++k) s.periodic[k] = flagged == 3 && words_[first_flag + k] == "pp";
    for (int k = 0; k < 3; ++k) {
      need_line("the bounds of the box");
      split_words(line_, words_);
      if (words_.size() != needed)
        fail(fmt::format("{} numbers are needed, '{}' was found.", needed, excerpt()));
      const auto at = [&](std::size_t w) { return number(words_[w]); };
      bool tilted = needed == 3 && at(2) != 0;
      for (std::size_t w = 0; w < 3 && needed == 4; ++w)
        tilted = tilted || (w != static_cast<std::size_t>(k) && at(w) != 0);
      if (tilted) fail("the box is not a cuboid along the axes (tilted boxes are not read).");
      s.lower[k] = at(needed == 4 ? 3 : 0);
      s.upper[k] = needed == 4 ? s.lower[k] + at(static_cast<std::size_t>(k)) : at(1);
      if (!(s.lower[k] < s.upper[k]))
        fail(fmt::format("the box is empty: {:g} is not below {:g}.", s.lower[k], s.upper[k]));
    }
  }

  void place_columns(const std::string& header) {
    if (columns_.count > 0 && header == header_) return;
    if (!header_.empty()) fail("the columns are not those of the first frame.");
    header_ = header;
    split_words(header, words_);
    std::map<std::string_view, int> at;
    for (const std::string_view word : words_)
      if (!at.emplace(word, static_cast<int>(at.size())).second)
        fail(fmt::format("the column '{}' occurs twice.", word));
    const auto place = [&](const std::string& name) {
      const auto found = at.find(name);
      return found == at.end() ? kNoColumn : found->second;
    };
    columns_.count = words_.size();
    columns_.id = place("id");
    if (columns_.id == kNoColumn) fail("there is no column 'id', without which beads cannot be identified.");
    columns_.type = place("type");
    columns_.mass = place("mass");
    columns_.radius = place("radius");
    if (columns_.radius != kNoColumn && place("diameter") != kNoColumn)
      fail("the columns 'radius' and 'diameter' both state the size of a bead; dump one of them.");
    if (columns_.radius == kNoColumn) {
      columns_.radius = place("diameter");
      columns_.is_diameter = true;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      columns_.velocity[k] = place("v" + axis);
      columns_.spin[k] = place("omega" + axis);
      // Use the first column that is present: unwrapped coordinates are preferred.
      for (const Coordinate c :
           {Coordinate{place(axis + "u"), false, false}, Coordinate{place(axis + "su"), true, false},
            Coordinate{place(axis), false, true}, Coordinate{place(axis + "s"), true, true}})
        if (c.column != kNoColumn && columns_.position[k].column == kNoColumn) columns_.position[k] = c;
      if (columns_.position[k].wrapped) columns_.position[k].image = place("i" + axis);
      if (columns_.position[k].column == kNoColumn && k < 2)
        fail(fmt::format("there is no column for the positions along {0} ({0}, {0}u, {0}s or {0}su).", axis));
      has_.velocity[k] = columns_.velocity[k] != kNoColumn;
      has_.spin[k] = columns_.spin[k] != kNoColumn;
      has_.wrapped[k] = columns_.position[k].wrapped && columns_.position[k].image == kNoColumn;
    }
    has_.type = columns_.type != kNoColumn;
    has_.radius = columns_.radius != kNoColumn;
    has_.mass = columns_.mass != kNoColumn;
  }

  void read_atoms(std::size_t announced, ForeignFrame& s) {
    const auto at = [&](int column) { return words_[static_cast<std::size_t>(column)]; };
    for (std::size_t i = 0; i < announced; ++i) {
      need_line("an atom");
      split_words(line_, words_);
      if (words_.size() != columns_.count)
        fail(fmt::format("{} columns are needed, {} were found.", columns_.count, words_.size()));
      ForeignBead a;
      a.line = in_.number();
      a.id = whole(at(columns_.id));
      if (columns_.type != kNoColumn) a.type = static_cast<long>(whole(at(columns_.type)));
      if (columns_.radius != kNoColumn) {
        a.radius = number(at(columns_.radius)) / (columns_.is_diameter ? 2 : 1);
        if (!(a.radius > 0)) fail("a bead has no size.");
      }
      if (columns_.mass != kNoColumn) {
        a.mass = number(at(columns_.mass));
        if (!(a.mass > 0)) fail("a bead has no mass.");
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const int axis = static_cast<int>(k);
        const Coordinate& c = columns_.position[k];
        const double length = s.upper[axis] - s.lower[axis];
        a.position[axis] = c.column == kNoColumn ? 0 : number(at(c.column));
        if (c.scaled) a.position[axis] = s.lower[axis] + a.position[axis] * length;
        if (c.image != kNoColumn) a.position[axis] += static_cast<double>(whole(at(c.image))) * length;
        if (columns_.velocity[k] != kNoColumn)
          a.velocity[axis] = number_at(in_.number(), at(columns_.velocity[k]), true);
        if (columns_.spin[k] != kNoColumn) a.spin[axis] = number_at(in_.number(), at(columns_.spin[k]), true);
      }
      s.beads.push_back(a);
    }
  }

  LineReader in_;
  std::string& line_;
  std::string header_, length_unit_;
  std::vector<std::string_view> words_;
  ColumnPlaces columns_;
  ForeignColumns has_;
};

/// Per frame: step, number of beads, box, and one line per bead. ITEM: UNITS and ITEM: TIME are left out,
/// because MDAnalysis 2.4 rejects them; the time is step times the time step.
class DumpWriter final : public ForeignWriter {
 public:
  DumpWriter(const std::filesystem::path& part, const WriteOptions& options)
      : out_(part), has_(options.columns), is_2d_(options.dimension == 2) {}

  void append(const ForeignFrame& s) override {
    std::string& text = out_.text();
    fmt::format_to(std::back_inserter(text),
                   "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS", s.step, s.beads.size());
    const bool counts_periods = s.periodic[0] || s.periodic[1] || s.periodic[2];
    // LAMMPS requires that a two-dimensional system is periodic along z.
    for (std::size_t k = 0; k < 3; ++k) text += s.periodic[k] || (is_2d_ && k == 2) ? " pp" : " ff";
    for (int k = 0; k < 3; ++k) fmt::format_to(std::back_inserter(text), "\n{} {}", s.lower[k], s.upper[k]);
    text += "\nITEM: ATOMS id type";
    if (has_.radius) text += " radius";
    if (has_.mass) text += " mass";
    text += " x y z";
    if (counts_periods) text += " ix iy iz";
    if (has_.velocity[0]) text += " vx vy vz";
    if (has_.spin[2]) text += " omegax omegay omegaz";
    text += '\n';
    for (const ForeignBead& bead : s.beads) write(bead, s, counts_periods);
    out_.flush_if_large();
  }
  void finish() override { out_.close(); }

 private:
  void write(const ForeignBead& bead, const ForeignFrame& s, bool counts_periods) {
    std::string& text = out_.text();
    fmt::format_to(std::back_inserter(text), "{} {}", bead.id + 1, bead.type);  // LAMMPS counts from 1
    if (has_.radius) fmt::format_to(std::back_inserter(text), " {}", bead.radius);
    if (has_.mass) fmt::format_to(std::back_inserter(text), " {}", bead.mass);
    Vec3 r = bead.position;
    Eigen::Vector3i periods = Eigen::Vector3i::Zero();
    for (int k = 0; k < 3; ++k)
      if (s.periodic[static_cast<std::size_t>(k)]) {
        const double length = s.upper[k] - s.lower[k];
        periods[k] = static_cast<int>(std::floor((r[k] - s.lower[k]) / length));
        r[k] -= periods[k] * length;
      }
    add(r);
    if (counts_periods)
      fmt::format_to(std::back_inserter(text), " {} {} {}", periods[0], periods[1], periods[2]);
    if (has_.velocity[0]) add(bead.velocity);
    if (has_.spin[2]) add(bead.spin);
    text += '\n';
  }
  void add(const Vec3& v) { fmt::format_to(std::back_inserter(out_.text()), " {} {} {}", v[0], v[1], v[2]); }

  TextOutput out_;
  ForeignColumns has_;
  bool is_2d_;
};

}  // namespace

extern const ForeignFormat lammps_dump_format;
const ForeignFormat lammps_dump_format = {
    .word = "lammps-dump",
    .extensions = ".lammpstrj .dump",
    .help = "text dump of LAMMPS: LAMMPS (read_dump), OVITO, MDAnalysis, ASE, VMD",
    .open = [](const std::filesystem::path& file, const ReadOptions&) -> std::unique_ptr<ForeignReader> {
      return std::make_unique<DumpReader>(file);
    },
    .create = [](const std::filesystem::path& part, const WriteOptions& options)
        -> std::unique_ptr<ForeignWriter> { return std::make_unique<DumpWriter>(part, options); }};

}  // namespace twincell
