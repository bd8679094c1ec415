// Extended XYZ: per frame the number of beads, a line of key=value pairs, and one line per bead whose columns
// the key Properties names. Sources: ASE, ase.io.extxyz; OVITO manual, "XYZ file reader".

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "core/error.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/foreign/text_file.hpp"

namespace twincell {

namespace {

/// Values of the pairs of the second line. A value may stand in quotes, a key without a value is "T".
std::map<std::string, std::string> pairs_of(std::string_view line) {
  std::map<std::string, std::string> pairs;
  for (std::size_t at = 0; at < line.size();) {
    at = line.find_first_not_of(" \t\r", at);
    if (at == std::string_view::npos) break;
    const std::size_t end = line.find_first_of("= \t\r", at);
    const std::string key(line.substr(at, end == std::string_view::npos ? end : end - at));
    if (end == std::string_view::npos || line[end] != '=') {
      pairs.insert_or_assign(key, std::string(1, 'T'));
      at = end;
      continue;
    }
    std::size_t from = end + 1;
    const bool quoted = from < line.size() && (line[from] == '"' || line[from] == '\'');
    const std::size_t to = quoted ? line.find(line[from], from + 1) : line.find_first_of(" \t\r", from);
    if (quoted) ++from;
    pairs[key] = std::string(line.substr(std::min(from, line.size()),
                                         to == std::string_view::npos ? to : to - std::min(from, to)));
    at = to == std::string_view::npos ? to : to + 1;
  }
  return pairs;
}

class XyzReader final : public ForeignReader {
 public:
  XyzReader(const std::filesystem::path& file, const ReadOptions& options)
      : ForeignReader(file), in_(file), dimension_(options.dimension) {}

  bool next(ForeignFrame& s) override {
    do {
      if (!in_.next()) return false;
    } while (in_.line().find_first_not_of(" \t\r") == std::string::npos);
    s = ForeignFrame{};
    s.line = in_.number();
    s.step = n_frames_++;
    split_words(in_.line(), words_);
    const std::int64_t n = words_.size() == 1 ? whole(words_[0]) : -1;
    if (n < 0) fail(fmt::format("the number of beads is needed, '{}' was found.", in_.line().substr(0, 60)));
    if (!in_.next()) fail("the file ends within a frame.");
    read_head(s);
    if (!id_ && n_frames_ > 1 && n != n_beads_)
      fail_at(s.line,
              fmt::format("the frame has {} beads, the first one has {}; without the property id:I:1 the "
                          "missing ones are unknown.",
                          n, n_beads_));
    n_beads_ = n;
    for (std::int64_t i = 0; i < n; ++i) read_bead(i, s);
    if (!has_box_) enclose(s, dimension_);
    return true;
  }
  [[nodiscard]] std::string length_unit() const override { return length_unit_; }
  [[nodiscard]] std::string time_unit() const override { return time_unit_; }
  [[nodiscard]] const ForeignColumns& columns() const override { return has_; }
  [[nodiscard]] std::string assumption() const override {
    return states_no_pbc_
               ? "the file states Lattice without pbc: by the rule of extended XYZ the box is periodic "
                 "along all axes; pbc=\"F F F\" states walls."
               : "";
  }
  [[nodiscard]] std::int64_t size() const override { return in_.size(); }
  [[nodiscard]] std::int64_t done() const override { return in_.done(); }

 private:
  struct Property {
    std::string name;
    char type;
    std::size_t first, count;
  };

  [[noreturn]] void fail(const std::string& complaint) const { fail_at(in_.number(), complaint); }
  [[nodiscard]] std::int64_t whole(std::string_view word) const { return whole_at(in_.number(), word); }
  [[nodiscard]] double number(std::string_view word) const { return number_at(in_.number(), word); }

  void read_head(ForeignFrame& s) {
    const auto pairs = pairs_of(in_.line());
    const auto value = [&](std::initializer_list<const char*> names) -> const std::string* {
      for (const char* name : names)
        if (const auto found = pairs.find(name); found != pairs.end()) return &found->second;
      return nullptr;
    };
    if (const std::string* time = value({"Time", "time"})) s.time = number(*time);
    if (const std::string* step = value({"Timestep", "timestep", "Step", "step"})) s.step = whole(*step);
    read_box(s, value({"Lattice"}), value({"Origin", "origin"}), value({"pbc"}));
    if (const std::string* unit = value({"length_unit"})) length_unit_ = *unit;
    if (const std::string* unit = value({"time_unit"})) {
      if (n_frames_ > 1 && *unit != time_unit_) fail("time_unit is not that of the first frame.");
      time_unit_ = *unit;
    }
    const std::string* creator = value({"creator"});
    for (std::size_t k = 0; k < 3; ++k)  // export writes how far beads have moved
      has_.wrapped[k] = s.periodic[k] && !(creator && *creator == "twincell");
    const std::string* properties = value({"Properties"});
    place_columns(properties ? *properties : "species:S:1:pos:R:3");
  }

  void read_box(ForeignFrame& s, const std::string* lattice, const std::string* origin,
                const std::string* pbc) {
    has_box_ = lattice != nullptr;
    if (!lattice) return;
    split_words(*lattice, words_);
    if (words_.size() != 9) fail("Lattice needs nine numbers.");
    for (int k = 0; k < 9; ++k) {
      const double entry = number(words_[static_cast<std::size_t>(k)]);
      if (k % 4 == 0)
        s.upper[k / 4] = entry;
      else if (entry != 0)
        fail("the box is not a cuboid along the axes.");
    }
    // A planar system may have no third vector.
    if (!(s.upper.head<2>().minCoeff() > 0 && s.upper.z() >= 0))
      fail("the box is empty: an edge of Lattice is not positive.");
    const bool planar = s.upper.z() == 0;
    if (origin) {
      split_words(*origin, words_);
      if (words_.size() != 3) fail("Origin needs three numbers.");
      for (int k = 0; k < 3; ++k) s.lower[k] = number(words_[static_cast<std::size_t>(k)]);
    }
    s.upper += s.lower;
    if (!pbc) {
      s.periodic = {true, true, !planar};
      states_no_pbc_ = true;
      return;
    }
    split_words(*pbc, words_);
    if (words_.size() != 3) fail("pbc needs three words, T or F.");
    for (std::size_t k = 0; k < 3; ++k) {
      if (words_[k] != "T" && words_[k] != "F")
        fail(fmt::format("pbc has '{}'; T or F is needed.", words_[k]));
      s.periodic[k] = words_[k] == "T" && !(k == 2 && planar);
    }
  }

  void place_columns(const std::string& text) {
    if (position_ && text == placed_) return;
    if (position_) fail("the columns are not those of the first frame.");
    placed_ = text;
    std::vector<std::string> parts(1);
    for (const char c : text)
      if (c == ':')
        parts.emplace_back();
      else
        parts.back() += c;
    if (parts.size() % 3 != 0) fail("Properties needs name:type:count for each property.");
    for (std::size_t i = 0; i < parts.size(); i += 3) {
      const std::int64_t count = whole(parts[i + 2]);
      if (parts[i + 1].size() != 1 || std::string("SRIL").find(parts[i + 1]) == std::string::npos ||
          count < 1 || count > 1000)
        fail(fmt::format("the property '{}' has no known type or count.", parts[i].substr(0, 60)));
      properties_.push_back({parts[i], parts[i + 1][0], n_words_, static_cast<std::size_t>(count)});
      n_words_ += static_cast<std::size_t>(count);
    }
    const auto place = [&](std::initializer_list<const char*> names, std::size_t count,
                           bool numbers = true) -> const Property* {
      for (const char* name : names)
        for (const Property& p : properties_)
          if (p.name == name && p.count == count && (!numbers || p.type == 'R' || p.type == 'I')) return &p;
      return nullptr;
    };
    position_ = place({"pos"}, 3);
    if (!position_) fail("there is no property pos:R:3.");
    id_ = place({"id", "particle"}, 1);
    radius_ = place({"radius"}, 1);
    mass_ = place({"mass", "masses"}, 1);
    type_ = place({"type"}, 1);
    velocity_ = place({"velo", "vel", "velocities"}, 3);
    spin_ = place({"omega", "angular_velocity"}, 3);
    has_.radius = radius_ != nullptr;
    has_.mass = mass_ != nullptr;
    has_.type = type_ != nullptr;
    has_.velocity.fill(velocity_ != nullptr);
    has_.spin.fill(spin_ != nullptr);
  }

  void read_bead(std::int64_t i, ForeignFrame& s) {
    if (!in_.next()) fail(fmt::format("the file ends within a frame, before bead {}.", i + 1));
    split_words(in_.line(), words_);
    if (words_.size() != n_words_)
      fail(fmt::format("{} columns are needed, {} were found.", n_words_, words_.size()));
    const auto one = [&](const Property* p) { return number(words_[p->first]); };
    const auto three = [&](const Property* p, bool may_be_nan = false) {
      Vec3 v;
      for (std::size_t k = 0; k < 3; ++k)
        v[static_cast<int>(k)] = number_at(in_.number(), words_[p->first + k], may_be_nan);
      return v;
    };
    ForeignBead bead;
    bead.line = in_.number();
    bead.id = id_ ? whole(words_[id_->first]) : i;
    if (type_) bead.type = static_cast<long>(whole(words_[type_->first]));
    if (radius_) bead.radius = one(radius_);
    if (radius_ && !(bead.radius > 0)) fail("a bead has no size.");
    if (mass_) bead.mass = one(mass_);
    if (mass_ && !(bead.mass > 0)) fail("a bead has no mass.");
    bead.position = three(position_);
    if (velocity_) bead.velocity = three(velocity_, true);
    if (spin_) bead.spin = three(spin_, true);
    s.beads.push_back(bead);
  }

  LineReader in_;
  int dimension_;
  std::vector<std::string_view> words_;
  std::string placed_;
  std::vector<Property> properties_;
  std::size_t n_words_ = 0;
  const Property *position_ = nullptr, *id_ = nullptr, *radius_ = nullptr, *mass_ = nullptr, *type_ = nullptr,
                 *velocity_ = nullptr, *spin_ = nullptr;
  ForeignColumns has_;
  std::string length_unit_, time_unit_;
  bool has_box_ = false, states_no_pbc_ = false;
  std::int64_t n_beads_ = 0;
  std::int64_t n_frames_ = 0;
};

constexpr const char* kCreator = "creator=twincell";

/// The species is X, ASE's symbol of no element; tracers have type 2.
class XyzWriter final : public ForeignWriter {
 public:
  XyzWriter(const std::filesystem::path& part, const WriteOptions& options)
      : out_(part), has_(options.columns), options_(options) {}

  void append(const ForeignFrame& s) override {
    auto text = std::back_inserter(out_.text());
    const Vec3 size = s.upper - s.lower;
    fmt::format_to(text, "{}\nLattice=\"{} 0 0 0 {} 0 0 0 {}\" Origin=\"{} {} {}\" pbc=\"{} {} {}\"",
                   s.beads.size(), size[0], size[1], size[2], s.lower[0], s.lower[1], s.lower[2],
                   s.periodic[0] ? 'T' : 'F', s.periodic[1] ? 'T' : 'F', s.periodic[2] ? 'T' : 'F');
    if (s.time) fmt::format_to(text, " Time={}", *s.time);
    fmt::format_to(text, " Timestep={}", s.step);
    if (s.phase) fmt::format_to(text, " phase={}", *s.phase);
    if (s.cycle) fmt::format_to(text, " cycle={}", *s.cycle);
    if (s.plate_height) fmt::format_to(text, " plate_height={}", *s.plate_height);
    fmt::format_to(text, " {} length_unit={} time_unit={} Properties=species:S:1:pos:R:3:id:I:1", kCreator,
                   options_.length_unit, options_.time_unit);
    if (has_.radius) out_.text() += ":radius:R:1";
    if (has_.mass) out_.text() += ":mass:R:1";
    if (has_.type) out_.text() += ":type:I:1";
    if (has_.velocity[0]) out_.text() += ":velo:R:3";
    if (has_.spin[2]) out_.text() += ":omega:R:3";
    for (const std::string& name : has_.numbers) fmt::format_to(text, ":{}:R:1", name);
    out_.text() += '\n';
    const auto add = [&](const Vec3& v) { fmt::format_to(text, " {} {} {}", v[0], v[1], v[2]); };
    for (std::size_t i = 0; i < s.beads.size(); ++i) {
      const ForeignBead& bead = s.beads[i];
      out_.text() += 'X';
      add(bead.position);  // first, where readers of plain XYZ expect it
      fmt::format_to(text, " {}", bead.id);
      if (has_.radius) fmt::format_to(text, " {}", bead.radius);
      if (has_.mass) fmt::format_to(text, " {}", bead.mass);
      if (has_.type) fmt::format_to(text, " {}", bead.type);
      if (has_.velocity[0]) add(bead.velocity);
      if (has_.spin[2]) add(bead.spin);
      for (const auto& column : s.numbers) fmt::format_to(text, " {}", column[i]);
      out_.text() += '\n';
    }
    out_.flush_if_large();
  }
  void finish() override { out_.close(); }

 private:
  TextOutput out_;
  ForeignColumns has_;
  WriteOptions options_;
};

}  // namespace

extern const ForeignFormat extended_xyz_format;
const ForeignFormat extended_xyz_format = {
    .word = "xyz",
    .extensions = ".xyz .extxyz",
    .help = "extended XYZ: OVITO, ASE, MDAnalysis",
    .open = [](const std::filesystem::path& file, const ReadOptions& options)
        -> std::unique_ptr<ForeignReader> { return std::make_unique<XyzReader>(file, options); },
    .create = [](const std::filesystem::path& part, const WriteOptions& options)
        -> std::unique_ptr<ForeignWriter> { return std::make_unique<XyzWriter>(part, options); },
    .numbers = true,
    .mark = kCreator};

}  // namespace twincell
