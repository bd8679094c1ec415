// A table with one row per bead and frame, in trackpy's columns: x, y, frame, particle. y increases
// downwards, as in a picture. Source: trackpy manual, "Walkthrough", and trackpy.linking.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.hpp"
#include "core/table_text.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/foreign/picture_beads.hpp"
#include "trajectory/foreign/text_file.hpp"

namespace twincell {

namespace {

/// Quantities that are read, by the names of their columns.
constexpr std::array<const char*, 16> kQuantities = {
    "frame",  "particle",  "x",  "y",  "z",  "time",    "radius",  "diameter",
    "tracer", "bead_mass", "vx", "vy", "vz", "sigma_x", "sigma_y", "sigma_z"};

class TableReader final : public PictureBeadsReader {
 public:
  TableReader(const std::filesystem::path& file, const ReadOptions& options)
      : PictureBeadsReader(file, options), text_(read_table_text(file)) {
    std::size_t at = 0;
    place_columns(line_from(at));
    long line = 1;
    while (at < text_.size()) {
      ++line;
      const std::string_view row = line_from(at);
      if (row.find_first_not_of(" ,") != std::string_view::npos) read_row(row, line);
    }
    if (beads_.empty()) fail_at(0, "the table has no row.");
    sort_by_frame();
    check_times();
  }

  [[nodiscard]] std::string assumption() const override { return ignored_; }

 private:
  /// Says which columns are not read, and which of these look like a quantity with a unit in its name.
  /// Columns of trackpy, of `locate` and of `export` that no trajectory holds are ignored without a word.
  void note_ignored(const std::vector<std::string>& names) {
    constexpr std::array<std::string_view, 18> kKnown = {
        "mass",      "size",  "ecc",  "signal",  "raw_mass",     "ep",    "step",    "phase", "cycle",
        "ambiguous", "score", "edge", "overlap", "sigma_radius", "index", "level_0", "id",    ""};
    std::vector<std::string> ignored, with_unit;
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (twin_ == k || std::find(at_.begin(), at_.end(), std::optional(k)) != at_.end()) continue;
      const std::string& name = names[k];
      if (std::find(kKnown.begin(), kKnown.end(), name) != kKnown.end() || name.starts_with("Unnamed: "))
        continue;
      ignored.push_back("'" + name + "'");
      for (const char* quantity : kQuantities)
        if (!column(quantity) && name.starts_with(quantity) &&
            name.size() > std::string_view(quantity).size() &&
            std::string_view("_ ([").find(name[std::string_view(quantity).size()]) != std::string_view::npos)
          with_unit.push_back(fmt::format("{}={}", quantity, name));
    }
    if (ignored.empty()) return;
    ignored_ = fmt::format("{} of the table {} not read: {}.",
                           ignored.size() == 1 ? "a column" : fmt::format("{} columns", ignored.size()),
                           ignored.size() == 1 ? "is" : "are", fmt::join(ignored, ", "));
    if (!with_unit.empty())
      ignored_ += fmt::format(
          " --columns {} reads {} without a conversion of units; lengths and times of a table have one unit "
          "each.",
          fmt::join(with_unit, " "), with_unit.size() == 1 ? "it" : "them");
  }

  /// \throws InputError if beads of a frame have different times
  void check_times() const {
    std::size_t first = 0;
    for (std::size_t k = 0; k < beads_.size(); ++k) {
      if (beads_[k].frame != beads_[first].frame) first = k;
      if (beads_[k].time != beads_[first].time)
        fail_at(beads_[k].bead.line,
                fmt::format("the time differs from that of line {}, which has the same frame.",
                            beads_[first].bead.line));
    }
  }

  std::string_view line_from(std::size_t& at) const {
    const std::size_t end = std::min(text_.find('\n', at), text_.size());
    const std::string_view line(text_.data() + at, end - at);
    at = end + 1;
    return line;
  }

  void place_columns(std::string_view header) {
    const auto fields = fields_of(header);
    const std::vector<std::string> names(fields.begin(), fields.end());
    twin_ = twin_of_index(names);
    index_name_ = names.front();
    check_column_names({names.begin() + (twin_ ? 1 : 0), names.end()},
                       {.file = file().string(), .line = 1, .key = {}});
    n_columns_ = names.size();
    const auto find = [&](const std::string& name) -> std::optional<std::size_t> {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end()) return {};
      return static_cast<std::size_t>(found - names.begin());
    };
    for (const auto& [quantity, name] : options_.columns) {
      if (std::find(kQuantities.begin(), kQuantities.end(), quantity) == kQuantities.end())
        throw ConfigError({"", 0, 0, "--columns"}, fmt::format("there is no quantity '{}'; there are: {}.",
                                                               quantity, fmt::join(kQuantities, ", ")));
      if (!find(name))
        throw InputError({.file = file().string(), .line = 1, .key = name},
                         fmt::format("this column is missing; there are: {}.", fmt::join(names, ", ")));
    }
    for (std::size_t q = 0; q < kQuantities.size(); ++q) {
      const auto renamed = options_.columns.find(kQuantities[q]);
      at_[q] = find(renamed == options_.columns.end() ? kQuantities[q] : renamed->second);
      const auto twin = std::find(at_.begin(), at_.begin() + static_cast<std::ptrdiff_t>(q), at_[q]);
      if (at_[q] && *twin == at_[q] && twin != at_.begin() + static_cast<std::ptrdiff_t>(q))
        throw ConfigError(
            {"", 0, 0, "--columns"},
            fmt::format("the column '{}' is both {} and {}.", names[*at_[q]],
                        kQuantities[static_cast<std::size_t>(twin - at_.begin())], kQuantities[q]));
    }
    for (const char* needed : {"frame", "particle", "x", "y"})
      if (!column(needed))
        fail_at(
            1, fmt::format("there is no column '{}'; --columns {}=NAME states another name. The columns are: "
                           "{}.{}",
                           needed, needed, fmt::join(names, ", "),
                           std::string_view(needed) == "particle"
                               ? " Beads that are not linked, such as those of locate, have no particle; "
                                 "track links them."
                               : ""));
    if (options_.dimension == 3 && !column("z")) fail_at(1, "there is no column 'z' (--dimension 3).");
    note_ignored(names);
    has_.radius = column("radius") || column("diameter");
    has_.mass = column("bead_mass").has_value();
    has_.type = has_.tracer = column("tracer").has_value();
    has_.uncertainty = column("sigma_x") && column("sigma_y");
    has_.velocity = {column("vx").has_value(), column("vy").has_value(), column("vz").has_value()};
  }

  [[nodiscard]] std::optional<std::size_t> column(std::string_view quantity) const {
    const auto q = std::find(kQuantities.begin(), kQuantities.end(), quantity);
    return at_[static_cast<std::size_t>(q - kQuantities.begin())];
  }

  void read_row(std::string_view line, long number) {
    const auto fields = fields_of(line);
    if (fields.size() != n_columns_)
      fail_at(number, fmt::format("{} fields are needed, {} were found.", n_columns_, fields.size()));
    require_same_index(fields, twin_, index_name_, {.file = file().string(), .line = number, .key = {}});
    const auto real = [&](const char* quantity, double absent, bool may_be_nan = false) {
      const auto at = column(quantity);
      if (!at) return absent;
      const std::string_view field = fields[*at];
      if (may_be_nan && field.empty()) return std::numeric_limits<double>::quiet_NaN();
      double value = 0;
      const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
      if (error != std::errc() || end != field.data() + field.size() || std::isinf(value) ||
          (std::isnan(value) && !may_be_nan))
        throw InputError({.file = file().string(), .line = number, .key = quantity},
                         fmt::format("'{}' is not a finite number.", field.substr(0, 60)));
      return value;
    };
    const auto whole = [&](const char* quantity) {
      const double value = real(quantity, 0);
      const auto integer = integer_of(value);
      if (!integer)
        throw InputError({.file = file().string(), .line = number, .key = quantity},
                         fmt::format("{:g} is not a whole number.", value));
      return *integer;
    };
    BeadOfFrame row;
    row.frame = whole("frame");
    if (column("time")) row.time = real("time", 0);
    row.bead.line = number;
    row.bead.id = whole("particle");
    // A plane needs no z; the reader of the trajectory refuses one that differs between beads.
    const double z = real("z", 0, options_.dimension == 2);
    row.bead.position = upright(Vec3(real("x", 0), real("y", 0), std::isfinite(z) ? z : 0));
    row.bead.velocity = upright(Vec3(real("vx", 0, true), real("vy", 0, true), real("vz", 0, true)));
    const Vec3 u(real("sigma_x", 0, true), real("sigma_y", 0, true), real("sigma_z", 0, true));
    if (u.minCoeff() < 0) fail_at(number, "a standard error is negative.");
    row.bead.uncertainty = upright(u).cwiseAbs();  // has no direction
    row.bead.radius = real("radius", 0.5 * real("diameter", 0));
    if (has_.radius && !(row.bead.radius > 0)) {
      const bool by_radius = column("radius").has_value();
      fail_at(number, fmt::format("the {} is {:g}; it must be above 0.", by_radius ? "radius" : "diameter",
                                  by_radius ? row.bead.radius : 2 * row.bead.radius));
    }
    constexpr double kSameSize = 0.05;  // of numbers with few digits
    if (const double diameter = real("diameter", 2 * row.bead.radius);
        std::abs(2 * row.bead.radius - diameter) > kSameSize * diameter)
      fail_at(number, fmt::format("the radius is {:g} and the diameter {:g}, which is not twice the radius.",
                                  row.bead.radius, diameter));
    row.bead.mass = real("bead_mass", 0);
    if (has_.mass && !(row.bead.mass > 0)) fail_at(number, "a bead has no mass.");
    row.bead.type = 1;
    if (const auto at = column("tracer")) {
      const std::string_view word = fields[*at];
      const bool yes = word == "True" || word == "true" || word == "1";
      if (!yes && word != "False" && word != "false" && word != "0")
        throw InputError({.file = file().string(), .line = number, .key = "tracer"},
                         fmt::format("'{}' is neither 0 nor 1.", word.substr(0, 60)));
      row.bead.type = yes ? 2 : 1;
    }
    beads_.push_back(row);
  }

  std::string text_;
  std::array<std::optional<std::size_t>, kQuantities.size()> at_{};
  std::size_t n_columns_ = 0;
  std::optional<std::size_t> twin_;  ///< of a column that pandas wrote twice
  std::string index_name_, ignored_;
};

/// The first line of a table with these columns.
std::string heading_of(const ForeignColumns& has, bool is_3d) {
  std::string text = "frame,particle";
  const auto add = [&](const char* name) {
    for (const char* axis : {"x", "y", "z"})
      if (is_3d || *axis != 'z') text += fmt::format(",{}{}", name, axis);
  };
  add("");
  text += ",step,time";
  if (has.phase) text += ",phase,cycle";
  if (has.radius) text += ",radius";
  if (has.mass) text += ",bead_mass";
  if (has.type) text += ",tracer";
  if (has.velocity[0]) add("v");
  if (has.uncertainty) add("sigma_");
  return text;
}

/// All first lines that TableWriter writes.
const std::string& all_headings() {
  static const std::string all = [] {
    std::string lines;
    for (unsigned bits = 0; bits < 1U << 7; ++bits) {
      const auto bit = [&](unsigned k) { return (bits >> k & 1U) != 0; };
      ForeignColumns has;
      has.phase = bit(0), has.radius = bit(1), has.mass = bit(2), has.type = bit(3), has.uncertainty = bit(4);
      has.velocity.fill(bit(5));
      lines += heading_of(has, bit(6)) + '\n';
    }
    return lines;
  }();
  return all;
}

class TableWriter final : public ForeignWriter {
 public:
  TableWriter(const std::filesystem::path& part, const WriteOptions& options)
      : out_(part), has_(options.columns), is_3d_(options.dimension == 3) {}

  void append(const ForeignFrame& s) override {
    if (n_frames_ == 0) out_.text() += heading_of(has_, is_3d_) + '\n';
    auto text = std::back_inserter(out_.text());
    const auto add = [&](const Vec3& v, double sign) {  // y vertical, z depth
      fmt::format_to(text, ",{},{}", v.x(), sign * (is_3d_ ? v.z() : v.y()) + 0.0);
      if (is_3d_) fmt::format_to(text, ",{}", v.y());
    };
    for (const ForeignBead& bead : s.beads) {
      fmt::format_to(text, "{},{}", n_frames_, bead.id);
      add(bead.position, -1);
      fmt::format_to(text, ",{},{}", s.step, s.time.value_or(0));
      if (has_.phase) fmt::format_to(text, ",{},{}", s.phase.value_or(-1), s.cycle.value_or(-1));
      if (has_.radius) fmt::format_to(text, ",{}", bead.radius);
      if (has_.mass) fmt::format_to(text, ",{}", bead.mass);
      if (has_.type) fmt::format_to(text, ",{}", bead.type == 2 ? 1 : 0);
      if (has_.velocity[0]) add(bead.velocity, -1);
      if (has_.uncertainty) add(bead.uncertainty, 1);
      out_.text() += '\n';
    }
    ++n_frames_;
    out_.flush_if_large();
  }
  void finish() override { out_.close(); }

 private:
  TextOutput out_;
  ForeignColumns has_;
  bool is_3d_;
  std::int64_t n_frames_ = 0;
};

}  // namespace

extern const ForeignFormat bead_table_format;
const ForeignFormat bead_table_format = {
    .word = "csv",
    .extensions = ".csv",
    .help = "table with trackpy's columns frame, particle, x, y (y downwards): trackpy, pandas, spreadsheets",
    .open = [](const std::filesystem::path& file, const ReadOptions& options)
        -> std::unique_ptr<ForeignReader> { return std::make_unique<TableReader>(file, options); },
    .create = [](const std::filesystem::path& part, const WriteOptions& options)
        -> std::unique_ptr<ForeignWriter> { return std::make_unique<TableWriter>(part, options); },
    .mark = all_headings(),
    .mark_is_first_line = true,
    .source = Origin::unknown};

}  // namespace twincell
