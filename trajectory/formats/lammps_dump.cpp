#include "trajectory/formats/lammps_dump.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace twincell {

namespace {

constexpr int kAbsent = -1;

/// Column and convention of one coordinate.
struct Coordinate {
  int column = kAbsent;
  bool scaled = false, wrapped = false;
  int image = kAbsent;  ///< column of ix, iy or iz
};

struct ColumnPlaces {
  std::size_t count = 0;
  int id = kAbsent, type = kAbsent, radius = kAbsent, mass = kAbsent;
  bool is_diameter = false;
  std::array<Coordinate, 3> position;
  std::array<int, 3> velocity{kAbsent, kAbsent, kAbsent}, spin{kAbsent, kAbsent, kAbsent};
};

struct Atom {
  std::int64_t id = 0;
  long line = 0, type = 0;
  double radius = 0, mass = 0;
  Vec3 position, velocity = Vec3::Zero(), spin = Vec3::Zero();
};

/// A frame in the dump's own units and axes.
struct Snapshot {
  std::int64_t step = 0;
  long line = 0;  ///< line of the step
  std::optional<double> time;
  std::array<bool, 3> periodic{};
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
  std::vector<Atom> atoms;  ///< sorted by id
};

/// Splits a line at white space.
void split(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  for (std::size_t at = 0; at < line.size();) {
    at = line.find_first_not_of(" \t\r", at);
    if (at == std::string_view::npos) return;
    const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
}

/// Reads snapshots one after another.
class DumpReader {
 public:
  explicit DumpReader(const std::filesystem::path& path) : name_(path.string()) {
    std::error_code ec;
    if (!std::filesystem::exists(path, ec)) throw InputError({name_, 0, 0, ""}, "the file does not exist.");
    if (std::filesystem::is_directory(path, ec))
      throw InputError({name_, 0, 0, ""}, "this is a folder; a file is needed.");
    size_ = static_cast<std::int64_t>(std::filesystem::file_size(path, ec));
    stream_.open(path, std::ios::binary);
    if (!stream_) throw InputError({name_, 0, 0, ""}, "the file cannot be read.");
  }

  /// Reads the next snapshot. Returns false at the end of the file.
  bool next(Snapshot& s) {
    bool begun = false;
    s.time.reset();
    s.atoms.clear();
    std::optional<std::size_t> announced;
    bool step_known = false, box_known = false;
    while (read_line()) {
      begun = true;
      line_.erase(line_.find_last_not_of(" \t\r") + 1);
      if (line_.rfind("ITEM: ", 0) != 0)
        fail(line_number_ == 1 ? "'ITEM: TIMESTEP' is missing; this is not a text dump of LAMMPS."
                               : fmt::format("'ITEM:' is missing, '{}' was found.", excerpt()));
      const std::string section = line_.substr(6);
      if (section == "UNITS") {
        need_line("the units");
      } else if (section == "TIMESTEP") {
        need_line("the step");
        s.line = line_number_;
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

  [[nodiscard]] const ColumnPlaces& columns() const { return columns_; }
  [[nodiscard]] std::int64_t size() const { return size_; }
  [[nodiscard]] std::int64_t done() const { return done_; }

  [[noreturn]] void fail(const std::string& complaint, long line = 0) const {
    throw InputError({name_, line > 0 ? line : line_number_, 0, ""}, complaint);
  }

 private:
  bool read_line() {
    if (!std::getline(stream_, line_)) return false;
    ++line_number_;
    done_ += static_cast<std::int64_t>(line_.size()) + 1;
    return true;
  }
  void need_line(const char* what) {
    if (!read_line()) fail(fmt::format("the file ends where {} should be.", what));
  }
  [[nodiscard]] std::string excerpt() const { return line_.substr(0, 60); }

  std::string_view only_word() {
    split(line_, words_);
    if (words_.size() != 1) fail(fmt::format("one number is needed, '{}' was found.", excerpt()));
    return words_[0];
  }
  [[nodiscard]] std::int64_t whole(std::string_view word) const {
    std::int64_t value = 0;
    const auto [end, ec] = std::from_chars(word.begin(), word.end(), value);
    if (ec != std::errc() || end != word.end()) fail(fmt::format("'{}' is not a whole number.", word));
    return value;
  }
  [[nodiscard]] double number(std::string_view word) const {
    double value = 0;
    const auto [end, ec] = std::from_chars(word.begin(), word.end(), value);
    if (ec != std::errc() || end != word.end() || !std::isfinite(value))
      fail(fmt::format("'{}' is not a finite number.", word));
    return value;
  }

  void read_box(const std::string& flags, Snapshot& s) {
    split(flags, words_);
    if (words_.size() != 3 && !words_.empty())
      fail("the box is not a cuboid along the axes (triclinic boxes are not read).");
    for (std::size_t k = 0; k < 3; ++k) s.periodic[k] = !words_.empty() && words_[k] == "pp";
    for (int k = 0; k < 3; ++k) {
      need_line("the bounds of the box");
      split(line_, words_);
      if (words_.size() != 2) fail(fmt::format("two bounds are needed, '{}' was found.", excerpt()));
      s.lower[k] = number(words_[0]);
      s.upper[k] = number(words_[1]);
      if (!(s.lower[k] < s.upper[k]))
        fail(fmt::format("the box is empty: {:g} is not below {:g}.", s.lower[k], s.upper[k]));
    }
  }

  void place_columns(const std::string& header) {
    if (columns_.count > 0 && header == header_) return;
    if (!header_.empty()) fail("the columns are not those of the first frame.");
    header_ = header;
    split(header, words_);
    std::map<std::string_view, int> at;
    for (const std::string_view word : words_)
      if (!at.emplace(word, static_cast<int>(at.size())).second)
        fail(fmt::format("the column '{}' occurs twice.", word));
    const auto place = [&](const std::string& name) {
      const auto found = at.find(name);
      return found == at.end() ? kAbsent : found->second;
    };
    columns_.count = words_.size();
    columns_.id = place("id");
    if (columns_.id == kAbsent) fail("there is no column 'id', without which beads cannot be identified.");
    columns_.type = place("type");
    columns_.mass = place("mass");
    columns_.radius = place("radius");
    if (columns_.radius == kAbsent) {
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
        if (c.column != kAbsent && columns_.position[k].column == kAbsent) columns_.position[k] = c;
      if (columns_.position[k].wrapped) columns_.position[k].image = place("i" + axis);
      if (columns_.position[k].column == kAbsent && k < 2)
        fail(fmt::format("there is no column for the positions along {0} ({0}, {0}u, {0}s or {0}su).", axis));
    }
  }

  void read_atoms(std::size_t announced, Snapshot& s) {
    const auto at = [&](int column) { return words_[static_cast<std::size_t>(column)]; };
    for (std::size_t i = 0; i < announced; ++i) {
      need_line("an atom");
      split(line_, words_);
      if (words_.size() != columns_.count)
        fail(fmt::format("{} columns are needed, {} were found.", columns_.count, words_.size()));
      Atom a;
      a.line = line_number_;
      a.id = whole(at(columns_.id));
      if (columns_.type != kAbsent) a.type = static_cast<long>(whole(at(columns_.type)));
      if (columns_.radius != kAbsent) {
        a.radius = number(at(columns_.radius)) / (columns_.is_diameter ? 2 : 1);
        if (!(a.radius > 0)) fail("a bead has no size.");
      }
      if (columns_.mass != kAbsent) {
        a.mass = number(at(columns_.mass));
        if (!(a.mass > 0)) fail("a bead has no mass.");
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const int axis = static_cast<int>(k);
        const Coordinate& c = columns_.position[k];
        const double length = s.upper[axis] - s.lower[axis];
        a.position[axis] = c.column == kAbsent ? 0 : number(at(c.column));
        if (c.scaled) a.position[axis] = s.lower[axis] + a.position[axis] * length;
        if (c.image != kAbsent) a.position[axis] += static_cast<double>(whole(at(c.image))) * length;
        if (columns_.velocity[k] != kAbsent) a.velocity[axis] = number(at(columns_.velocity[k]));
        if (columns_.spin[k] != kAbsent) a.spin[axis] = number(at(columns_.spin[k]));
      }
      s.atoms.push_back(a);
    }
    std::stable_sort(s.atoms.begin(), s.atoms.end(),
                     [](const Atom& a, const Atom& b) { return a.id < b.id; });
    const auto twice = std::adjacent_find(s.atoms.begin(), s.atoms.end(),
                                          [](const Atom& a, const Atom& b) { return a.id == b.id; });
    if (twice != s.atoms.end())
      fail(fmt::format("the bead with id {} occurs twice in a frame.", twice->id), std::next(twice)->line);
  }

  std::string name_, line_, header_;
  std::ifstream stream_;
  std::vector<std::string_view> words_;
  ColumnPlaces columns_;
  long line_number_ = 0;
  std::int64_t size_ = 0, done_ = 0;
};

[[noreturn]] void refuse(const std::string& option, const std::string& why) {
  throw ConfigError({"", 0, 0, option}, why);
}

}  // namespace

struct LammpsDump::Impl {
  std::filesystem::path path;
  LammpsDumpOptions o;
  TrajectoryInfo info;
  std::size_t n_frames = 0;
  std::vector<std::int64_t> ids;  ///< of the slots, ascending
  double t0 = 1;
  std::int64_t first_cycle = 0;

  /// Converts a vector from LAMMPS axes to those of Box. The plane of 2D LAMMPS systems is (x, y); their y is
  /// our z, their -z is our y.
  [[nodiscard]] Vec3 turned(const Vec3& v) const {
    return o.dimension == 2 ? Vec3(v.x(), -v.z() + 0.0, v.y()) : v;
  }

  void check_options() {
    const auto positive = [](const char* option, double value) {
      require_range({"", 0, 0, option}, value, 0.0, std::nullopt, true);
    };
    positive("--sigma", o.sigma);
    positive("--gravity", o.gravity);
    if (o.timestep) positive("--timestep", *o.timestep);
    if (o.width) positive("--cell-width", *o.width);
    if (o.bead_mass) positive("--bead-mass", *o.bead_mass);
    if (o.dimension == 2 && o.drive_axis == Axis::y) refuse("--drive-axis", "a 2D system has no y axis.");
    require_range({"", 0, 0, "--phase-of-step-zero"}, o.phase_of_step_zero, 0.0, 1.0);
    t0 = std::sqrt(o.sigma / o.gravity);
    const auto scaled = [](std::optional<double> value, double unit) {
      return value ? std::optional(*value / unit) : std::nullopt;
    };
    const DriveSpec spec = {.amplitude = scaled(o.drive.amplitude, o.sigma),
                            .omega = scaled(o.drive.omega, 1 / t0),
                            .frequency = scaled(o.drive.frequency, 1 / t0),
                            .gamma = o.drive.gamma,
                            .k_m = o.drive.k_m,
                            .peak_velocity = scaled(o.drive.peak_velocity, o.sigma / t0)};
    if (spec.amplitude || spec.omega || spec.frequency || spec.gamma || spec.k_m || spec.peak_velocity)
      info.drive = solve_drive(spec, 1, {"", 0, 0, "--drive"}, o.drive_axis);
    if (o.phases_per_cycle > 0 && !info.drive)
      refuse("--frames-per-cycle", "has no meaning without the drive, whose period is then unknown.");
  }

  /// First pass: checks a snapshot against the options and the first snapshot, and extends the box.
  void learn(const DumpReader& reader, const Snapshot& s, const Snapshot& first) {
    if (!o.timestep && !s.time)
      refuse("--timestep", fmt::format("{} does not state the length of a step.", path.string()));
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(k);
      if (s.periodic[a] != first.periodic[a] ||
          (s.periodic[a] && (s.lower[k] != first.lower[k] || s.upper[k] != first.upper[k])))
        reader.fail("the box is not periodic as it was in the first frame.", s.line);
    }
    for (const Atom& a : s.atoms) {
      constexpr double kFlat = 1e-9;
      if (o.dimension == 2 && std::abs(a.position.z()) > kFlat * o.sigma)
        reader.fail(fmt::format("bead {} is at z = {:g}, not in the plane z = 0; is this a three-dimensional "
                                "system (--dimension 3)?",
                                a.id, a.position.z()),
                    a.line);
    }
    const Vec3 upper = turned(s.upper - o.origin) / o.sigma;
    info.box.upper = n_frames == 0 ? upper : Vec3(info.box.upper.cwiseMax(upper));
  }

  /// Number of phases since the start of the cycle that contains step 0.
  /// \throws InputError if the snapshot is between two phases
  [[nodiscard]] std::int64_t phase_count(const DumpReader& reader, const Snapshot& s) const {
    constexpr double kBetween = 0.05;
    const double phases = cycles(s) * o.phases_per_cycle, nearest = std::round(phases);
    if (std::abs(phases - nearest) > kBetween || std::abs(phases) > 1e15)
      reader.fail(fmt::format("step {} is at {:.4f} cycles, not at one of {} phases of a cycle; check the "
                              "time step, the drive and the frames per cycle.",
                              s.step, cycles(s), o.phases_per_cycle),
                  s.line);
    return static_cast<std::int64_t>(nearest);
  }
  [[nodiscard]] double time(const Snapshot& s) const {
    return (o.timestep ? static_cast<double>(s.step) * *o.timestep : s.time.value_or(0)) / t0;
  }
  [[nodiscard]] double cycles(const Snapshot& s) const {
    return time(s) / info.drive->period() + o.phase_of_step_zero;
  }

  /// End of the first pass: sets columns, box and boundaries.
  void complete(const Snapshot& first, const ColumnPlaces& columns) {
    info.n_beads = ids.size();
    info.source = "simulation";
    const auto all = [&](const std::array<int, 3>& of) {
      return of[0] != kAbsent && of[1] != kAbsent && (o.dimension == 2 || of[2] != kAbsent);
    };
    info.columns.velocity = all(columns.velocity);
    info.columns.spin = o.dimension == 2 ? columns.spin[2] != kAbsent : all(columns.spin);
    info.columns.phase = o.phases_per_cycle > 0;
    info.columns.plate_height = info.drive.has_value();
    info.phases_per_cycle = o.phases_per_cycle;
    info.box.dimension = o.dimension;
    const auto edge = [&](std::size_t k) { return first.periodic[k] ? Boundary::periodic : Boundary::wall; };
    info.box.boundary = {edge(0), o.dimension == 2 ? Boundary::open : edge(1),
                         o.dimension == 2 ? edge(1) : edge(2)};
    if (o.width) info.box.upper.x() = *o.width / o.sigma;
    if (o.dimension == 2) info.box.upper.y() = (first.upper.z() - first.lower.z()) / o.sigma;
    if (columns.radius == kAbsent) info.radius.clear();
    if (columns.mass == kAbsent || !o.bead_mass) info.mass.clear();
    if (!o.tracer_type) info.tracer.clear();
    if (o.tracer_type && columns.type == kAbsent) refuse("--tracer-type", "the dump has no column 'type'.");
    if (!(info.box.upper.minCoeff() > 0))
      refuse("--cell-origin", "the origin is above or to the right of the dump's box.");
  }

  [[nodiscard]] std::size_t slot_of(const DumpReader& reader, const Atom& a) const {
    const auto at = std::lower_bound(ids.begin(), ids.end(), a.id);
    if (at == ids.end() || *at != a.id) reader.fail("the file changed while it was read.", a.line);
    return static_cast<std::size_t>(at - ids.begin());
  }

  /// Second pass: converts a snapshot to a frame with slots, unwrapped coordinates and reduced units.
  void fill(const DumpReader& reader, const Snapshot& s, std::vector<Vec3>& last, Frame& frame) const {
    frame.step = s.step;
    frame.time = time(s);
    if (info.drive) {
      double fraction = cycles(s) - std::floor(cycles(s));
      if (o.phases_per_cycle > 0) {
        const std::int64_t n = phase_count(reader, s), per_cycle = o.phases_per_cycle;
        frame.phase = static_cast<std::int32_t>((n % per_cycle + per_cycle) % per_cycle);
        frame.cycle = (n - frame.phase) / per_cycle - first_cycle;
        fraction = static_cast<double>(frame.phase) / o.phases_per_cycle;
      }
      frame.plate_height = info.drive->displacement(fraction);
    }
    const Vec3 nowhere = Vec3::Constant(std::nan(""));
    frame.position.assign(ids.size(), nowhere);
    frame.velocity.assign(info.columns.velocity ? ids.size() : 0, nowhere);
    frame.spin.assign(info.columns.spin ? ids.size() : 0, nowhere);
    frame.id.assign(info.columns.identity ? ids.size() : 0, -1);
    for (const Atom& a : s.atoms) {
      const std::size_t slot = slot_of(reader, a);
      Vec3 r = a.position;
      for (int k = 0; k < 3; ++k) {
        const Coordinate& c = reader.columns().position[static_cast<std::size_t>(k)];
        if (!s.periodic[static_cast<std::size_t>(k)] || !c.wrapped || c.image != kAbsent) continue;
        const double length = s.upper[k] - s.lower[k];
        if (std::isfinite(last[slot][k])) r[k] -= length * std::round((r[k] - last[slot][k]) / length);
      }
      last[slot] = r;
      frame.position[slot] = turned(r - o.origin) / o.sigma;
      if (o.dimension == 2) frame.position[slot].y() = 0;
      if (info.columns.velocity) frame.velocity[slot] = turned(a.velocity) * (t0 / o.sigma);
      if (info.columns.spin) frame.spin[slot] = turned(a.spin) * t0;
      if (info.columns.identity) frame.id[slot] = static_cast<std::int64_t>(slot);
    }
  }
};

LammpsDump::LammpsDump(const std::filesystem::path& path, const LammpsDumpOptions& options,
                       Progress& progress)
    : impl_(std::make_unique<Impl>()) {
  Impl& d = *impl_;
  d.path = path;
  d.o = options;
  d.check_options();
  DumpReader reader(path);
  struct Bead {
    double radius, mass;
    bool tracer;
  };
  std::map<std::int64_t, Bead> seen;
  std::size_t fewest = 0;
  Snapshot s, first;
  while (reader.next(s)) {
    if (d.n_frames == 0) {
      first = s;
      fewest = s.atoms.size();
      d.info.box.lower = Vec3::Zero();
    }
    d.learn(reader, s, first);
    if (d.n_frames > 0 && s.step <= first.step)
      reader.fail(fmt::format("step {} comes after step {}.", s.step, first.step), s.line);
    first.step = s.step;
    if (d.o.phases_per_cycle > 0) {
      const std::int64_t n = d.phase_count(reader, s), per_cycle = d.o.phases_per_cycle;
      if (d.n_frames == 0) d.first_cycle = (n - (n % per_cycle + per_cycle) % per_cycle) / per_cycle;
    }
    for (const Atom& a : s.atoms)
      seen.emplace(a.id, Bead{a.radius / d.o.sigma, a.mass / d.o.bead_mass.value_or(1),
                              d.o.tracer_type && a.type == *d.o.tracer_type});
    fewest = std::min(fewest, s.atoms.size());
    ++d.n_frames;
    progress.update(reader.done(), reader.size());
  }
  if (d.n_frames == 0) throw InputError({path.string(), 0, 0, ""}, "the file holds no frame.");
  for (const auto& [id, bead] : seen) {
    d.ids.push_back(id);
    d.info.radius.push_back(bead.radius);
    d.info.mass.push_back(bead.mass);
    d.info.tracer.push_back(bead.tracer ? 1 : 0);
  }
  d.info.columns.identity = fewest < d.ids.size();
  d.complete(first, reader.columns());
}

LammpsDump::~LammpsDump() = default;

const TrajectoryInfo& LammpsDump::info() const {
  return impl_->info;
}

std::size_t LammpsDump::n_frames() const {
  return impl_->n_frames;
}

void LammpsDump::copy_to(TrajectorySink& sink, Progress& progress) const {
  DumpReader reader(impl_->path);
  Snapshot s;
  Frame frame;
  std::vector<Vec3> last(impl_->ids.size(), Vec3::Constant(std::nan("")));
  while (reader.next(s)) {
    impl_->fill(reader, s, last, frame);
    sink.append(frame);
    progress.update(reader.done(), reader.size());
  }
}

}  // namespace twincell
