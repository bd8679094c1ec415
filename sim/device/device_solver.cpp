#include "sim/device/device_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/error.hpp"
#include "sim/device/bed_memory.hpp"
#include "sim/stepping/contact_memories.hpp"
#include "sim/stepping/packed_beads.hpp"

namespace twincell::sim {

namespace {

using Size = std::size_t;

/// Skin of the neighbour list, in diameters of the median bead. Wider than that of the list solver: a build
/// tests all pairs.
constexpr double kSkin = 0.35;

/// Upper bound on the number of beads whose surfaces are within the skin of a bead: discs (spheres) of radius
/// rho around points in them are disjoint and lie around the bead, if no overlap exceeds `overlap`.
Size most_neighbours(double radius, double smallest, double skin, double overlap, int dimension, Size beads) {
  const double rho = smallest - overlap / 2;
  const Size others = beads - 1;
  if (rho < 0.25 * smallest) return others;
  const auto content = [&](double r) { return std::pow(std::max(0.0, r) / rho, dimension); };
  const double most = content(radius + skin + 2 * rho + overlap / 2) - content(radius - overlap / 2);
  return most < static_cast<double>(others) ? static_cast<Size>(most) : others;
}

DeviceKernel kernel_of(const Plan& plan) {
  if (plan.event_driven)
    throw ConfigError({.file = {}, .key = "time.stepping"},
                      "beads move from contact to contact, which --device does not do; set it to \"steps\".");
  const auto kernel = find_device_kernel(plan.key);
  if (!kernel)
    throw ConfigError({.file = {}, .key = "contact"},
                      fmt::format("--device has no kernel for {}; it has {}, all without rolling resistance.",
                                  plan.law_names(), device_law_words()));
  return *kernel;
}

class DeviceSolver : public Solver {
 public:
  DeviceSolver(const Plan& plan, const GuardLimits& limits, Batcher& batcher)
      : plan_(plan),
        limits_(limits),
        kernel_(kernel_of(plan)),
        batcher_(batcher),
        remembered_(remembered_numbers(plan)),
        beads_(plan_) {}
  ~DeviceSolver() override { release(); }
  DeviceSolver(const DeviceSolver&) = delete;
  DeviceSolver& operator=(const DeviceSolver&) = delete;

  void advance(System& s, std::int64_t steps) override {
    if (steps > 0) advance_in_pieces(s, {steps}, [] {});
  }
  void advance_in_pieces(System& s, const std::vector<std::int64_t>& pieces,
                         const std::function<void()>& after) override {
    if (s.beads.empty()) {
      for (const std::int64_t steps : pieces) s.step += steps, after();
      return;
    }
    prepare(s);
    const std::vector<Stop> stops = stops_of(pieces, s.step);
    for (Size next = 0; next < stops.size();) {
      const std::int64_t begin = s.step;
      Size count = 0;
      for (; count < kMaxStops && next + count < stops.size(); ++count) {
        if (stops[next + count].step - begin > kStepsPerLaunch) break;
        there_.stops[count] = stops[next + count].step - begin;
      }
      there_.last_stop = static_cast<std::int64_t>(count) - 1;
      launch(s);
      const BedReport last = report_at(count - 1);
      const bool failed = last.failed != 0;
      for (Size k = 0; k < count && !(failed && there_.stops[k] >= last.steps); ++k, ++next) {
        s.step = begin + there_.stops[k];
        if (!stops[next].ends_piece) continue;
        fetch(k);
        beads_.store(s, order_);
        check_motion(s, limits_);
        after();
      }
      if (failed) {
        fetch(count - 1);
        s.step = begin + last.steps;
        beads_.store(s, order_);
        explain_overlap(s, limits_);
      }
    }
    counters_.steps += std::accumulate(pieces.begin(), pieces.end(), std::int64_t{0});
  }
  [[nodiscard]] std::int64_t list_builds() const override {
    return memory_ == nullptr ? builds_ : here_.report->builds;
  }
  void rebuild_every(std::int64_t n) override { there_.rebuild_every = n; }
  [[nodiscard]] std::vector<ContactMemory> contacts() const override { return sorted_list(memories()); }
  void restore(std::vector<ContactMemory> contacts) override {
    keep_memories();
    add_list(kept_, std::move(contacts));
  }
  [[nodiscard]] std::string description() const override { return batcher_.executor().description(); }
  [[nodiscard]] Counters counters() const override { return counters_; }

 private:
  [[nodiscard]] std::byte* image() const { return reinterpret_cast<std::byte*>(image_.data()); }

  void release() {
    if (memory_ != nullptr) batcher_.executor().release(memory_);
    memory_ = nullptr;
  }

  // --- contact memory ---

  /// Remembered numbers of all contacts with nonzero memory.
  [[nodiscard]] ContactMemories memories() const {
    ContactMemories all = kept_;
    if (memory_ == nullptr || remembered_ == 0) return all;
    batcher_.executor().read(image() + parts_.state, memory_ + parts_.state, parts_.contacts - parts_.state);
    std::vector<double> numbers(remembered_);
    const auto add = [&](std::int32_t i, std::int32_t j) {
      if (std::any_of(numbers.begin(), numbers.end(), [](double v) { return v != 0; })) all[{i, j}] = numbers;
    };
    const auto list = static_cast<Size>(here_.report->list);
    for (std::int32_t pair = 0; pair < here_.report->pairs; ++pair) {
      for (Size m = 0; m < remembered_; ++m) numbers[m] = here_.memory[list][memory_place(m, pair)];
      add(here_.pair_beads[2 * pair], here_.pair_beads[2 * pair + 1]);
    }
    for (std::int32_t b = 0; b < here_.beads; ++b)
      for (std::int32_t w = 0; w < here_.walls; ++w) {
        for (Size m = 0; m < remembered_; ++m) numbers[m] = here_.wall_memory[wall_memory_place(b, w, m)];
        add(b, -1 - w);
      }
    return all;
  }
  [[nodiscard]] Size memory_place(Size m, std::int32_t pair) const {
    return static_cast<Size>(pair_place(here_.most_pairs, pair, static_cast<std::int32_t>(m)));
  }
  [[nodiscard]] Size wall_memory_place(std::int32_t b, std::int32_t w, Size m) const {
    return static_cast<Size>(
        wall_place(here_.beads, static_cast<std::int32_t>(remembered_), b, w, static_cast<std::int32_t>(m)));
  }
  void keep_memories() {
    kept_ = memories();
    builds_ = list_builds();
    release();
  }

  // --- memory of the device ---

  /// Places the bed in memory of the device: beads, constants, and the contacts with memory as a list.
  void arrange(const System& s) {
    const Size n = beads_.size();
    std::map<std::tuple<double, double, double>, std::int32_t> kinds;
    std::vector<std::int32_t> kind(n);
    std::vector<Size> model;  // a bead of each kind
    for (Size b = 0; b < n; ++b) {
      const auto [known, is_new] = kinds.try_emplace({beads_.radius(b), beads_.mass(b), beads_.inertia(b)},
                                                     static_cast<std::int32_t>(model.size()));
      if (is_new) model.push_back(b);
      kind[b] = known->second;
    }
    const double skin = kSkin * 2 * plan_.usual_radius;
    double smallest = beads_.radius(0);
    for (Size b = 0; b < n; ++b) smallest = std::min(smallest, beads_.radius(b));
    Size slots = 0;
    for (Size b = 0; b < n; ++b)
      slots = std::max(
          slots, most_neighbours(beads_.radius(b), smallest, skin, limits_.overlap, plan_.dimension, n));
    BedSizes sizes{.dimension = plan_.dimension, .beads = n, .walls = s.walls.size(), .kinds = model.size()};
    sizes.slots = slots;
    sizes.constants = pair_constants(plan_, beads_, model[0], model[0]).size();
    sizes.memory = remembered_;
    require_table(sizes);
    parts_ = place_bed(here_, sizes, nullptr);
    image_.assign(parts_.all / sizeof(double), 0.0);
    states_.resize(kMaxStops * parts_.state);
    place_bed(here_, sizes, image());
    memory_ = batcher_.executor().allocate(parts_.constants);
    place_bed(there_, sizes, memory_);
    place_inputs(there_, here_.inputs);
    there_.states = states_.data();
    there_.skin = skin;
    there_.fresh = true;

    std::copy(kind.begin(), kind.end(), here_.kind);
    double* at = here_.pair_constants;
    for (const Size a : model)
      for (const Size b : model) at = append(at, pair_constants(plan_, beads_, a, b));
    at = here_.wall_constants;
    for (Size w = 0; w < s.walls.size(); ++w)
      for (const Size a : model) at = append(at, wall_constants(plan_, beads_, w, a));
    const IntegrateArgs of_beads = beads_.integrate_args(s);
    for (Size b = 0; b < n; ++b) {
      const Size k = of_beads.inertia_step == 0 ? 0 : b;
      std::copy_n(of_beads.inv_mass + 4 * k, 4, here_.inv_mass + 4 * b);
      here_.turn[b] = of_beads.turn[k];
    }
    transfer_beads(
        [](double* in_image, double* packed, Size count) { std::copy_n(packed, count, in_image); });
    here_.report->builds = builds_;
    list_kept();
    batcher_.executor().write(memory_, image(), parts_.constants);
  }
  static double* append(double* at, const std::vector<double>& values) {
    return std::copy(values.begin(), values.end(), at);
  }
  /// Beads of many sizes take a table of the constants of each pair of sizes.
  static void require_table(const BedSizes& sizes) {
    constexpr double kMaxTable_bytes = 256.0 * 1024 * 1024;
    const double bytes = static_cast<double>(sizes.kinds * sizes.kinds * sizes.constants * sizeof(double));
    if (bytes > kMaxTable_bytes)
      throw ConfigError(
          {.file = {}, .key = "beads.spread"},
          fmt::format("{} sizes of beads are too many for --device, the bound is {}; use fewer "
                      "beads, or run without --device.",
                      sizes.kinds,
                      static_cast<int>(std::sqrt(kMaxTable_bytes /
                                                 static_cast<double>(sizes.constants * sizeof(double))))));
  }
  /// Calls copy(numbers in the image, packed numbers, count) for each array of the beads.
  template <class Copy>
  void transfer_beads(Copy copy) {
    const Size n = beads_.size();
    const bool flat = plan_.dimension == 2;
    copy(here_.records, beads_.records(), n * (flat ? kRecord<2> : kRecord<3>));
    copy(here_.spins, beads_.spins(), n * (flat ? kSpinRecord<2> : kSpinRecord<3>));
    copy(here_.forces, beads_.forces(), n * (flat ? kForceRecord<2> : kForceRecord<3>));
  }
  /// Lists the contacts in `kept_`, from which the first build of the device takes their memory.
  void list_kept() {
    std::map<ContactMemories::key_type, std::int32_t> of_beads;  // pairs by bead and partner, so each twice
    std::vector<const std::vector<double>*> pairs;
    for (const auto& [key, memory] : kept_) {
      const auto [i, j] = key;
      if (j < 0) {
        for (Size m = 0; m < std::min(memory.size(), remembered_); ++m)
          here_.wall_memory[wall_memory_place(i, -1 - j, m)] = memory[m];
      } else {
        of_beads[{i, j}] = of_beads[{j, i}] = static_cast<std::int32_t>(pairs.size());
        pairs.push_back(&memory);
      }
    }
    for (const auto& [key, pair] : of_beads) {
      std::int32_t& used = here_.neighbours[0][key.first];
      if (used == here_.slots)
        throw RunError(
            fmt::format("bead {} has more contacts with memory than beads that fit around it.", key.first));
      const std::int32_t slot = slot_place(here_.beads, key.first, used++);
      here_.partner[0][slot] = key.second;
      here_.pair[0][slot] = pair;
    }
    for (Size pair = 0; pair < pairs.size(); ++pair)  // two slots each, so they fit
      for (Size m = 0; m < std::min(pairs[pair]->size(), remembered_); ++m)
        here_.memory[0][memory_place(m, static_cast<std::int32_t>(pair))] = (*pairs[pair])[m];
    kept_.clear();
  }

  // --- launches ---

  /// Component c, in the order of a record.
  [[nodiscard]] double component(const Vec3& v, int c) const {
    return plan_.dimension == 2 ? (c == 0 ? v.x() : c == 1 ? v.z() : 0) : v[c];
  }
  void set_surroundings(const System& s) {
    for (int c = 0; c < 3; ++c) {
      there_.period[c] = component({s.period[0], s.period[1], s.period[2]}, c);
      there_.gravity[c] = component(s.gravity, c);
    }
    there_.periodic = s.period[0] > 0 || s.period[1] > 0 || s.period[2] > 0;
    there_.dt = s.dt;
    there_.quantum = rounding_constant(plan_);
    there_.overlap_bound = limits_.overlap;
    there_.spin = plan_.rotation, there_.locate = plan_.locate;
    for (Size w = 0; w < s.walls.size(); ++w) {
      for (int c = 0; c < 3; ++c) here_.normals[3 * w + static_cast<Size>(c)] = component(s.walls[w].n, c);
      here_.moves[w] = s.walls[w].moves ? 1 : 0;
    }
    for (Size b = 0; b < beads_.size(); ++b) here_.drag[b] = s.plate_drag * beads_.mass(b);
    there_.has_drag = s.plate_drag > 0;
  }

  /// Where the state of the device is fetched.
  struct Stop {
    std::int64_t step;
    bool ends_piece;  ///< or only a launch
  };
  /// The ends of the pieces, and of the launches into which long ones are divided.
  static std::vector<Stop> stops_of(const std::vector<std::int64_t>& pieces, std::int64_t step) {
    std::vector<Stop> stops;
    for (const std::int64_t piece : pieces) {
      const std::int64_t last = step + piece;
      for (; last - step > kStepsPerLaunch; stops.push_back({step, false})) step += kStepsPerLaunch;
      stops.push_back({step = last, true});
    }
    return stops;
  }
  /// Brings the bed to the device if it is not there as it is.
  void prepare(System& s) {
    if (order_.size() != s.beads.size()) {
      order_.resize(s.beads.size());
      std::iota(order_.begin(), order_.end(), 0);
    }
    s.forces_known = s.forces_known && s.forces.size() == s.beads.size();
    there_.known = s.forces_known;
    if (memory_ == nullptr || here_.walls != static_cast<std::int32_t>(s.walls.size()) ||
        !beads_.agrees(s, order_)) {
      keep_memories();
      beads_.load(s, order_, 0);
      arrange(s);
    }
    set_surroundings(s);
  }
  /// Advances the bed to its last stop. s.step is changed and restored.
  void launch(System& s) {
    there_.step = s.step;
    there_.input_words =
        static_cast<std::int64_t>(set_plate_motion(s, there_.stops[there_.last_stop])) / kWord;
    batcher_.advance(kernel_, there_);
    there_.fresh = false;
    there_.known = true;
  }
  [[nodiscard]] BedReport report_at(Size stop) const {
    BedReport report;
    const auto place = reinterpret_cast<const std::byte*>(here_.report) - image();
    std::memcpy(&report, states_.data() + parts_.state * stop + place, sizeof report);
    return report;
  }
  /// Fetches the state at a stop.
  void fetch(Size stop) {
    std::memcpy(image(), states_.data() + parts_.state * stop, parts_.state);
    transfer_beads(
        [](double* in_image, double* packed, Size count) { std::copy_n(in_image, count, packed); });
  }
  /// Tabulates the motion of the plate, from the present step on, with the functions and so the bits of the
  /// other solvers. \returns the bytes of the inputs
  Size set_plate_motion(System& s, std::int64_t steps) {
    const bool full = plan_.key.velocity == Velocity::full_step;
    const std::int64_t begin = s.step;
    double* row = here_.plate;
    Vec3 before = full ? s.plate_displacement_before() : Vec3::Zero();
    for (std::int64_t k = 0; k <= steps; ++k, row += plate_row(here_.walls)) {
      s.step = begin + k;
      const Vec3 now = s.plate_displacement();
      const Vec3 velocity = !full || s.plate_drag > 0 ? s.plate_velocity_in_space() : Vec3::Zero();
      const Vec3 of_walls = full ? Vec3((now - before) / s.dt) : velocity;
      for (int c = 0; c < 3; ++c) row[c] = component(of_walls, c), row[3 + c] = component(velocity, c);
      for (Size w = 0; w < s.walls.size(); ++w)
        row[6 + w] = s.walls[w].moves ? s.walls[w].offset + s.walls[w].n.dot(now) : s.walls[w].offset;
      before = now;
    }
    s.step = begin;
    return static_cast<Size>(reinterpret_cast<const std::byte*>(row) - here_.inputs);
  }

  Plan plan_;
  GuardLimits limits_;
  DeviceKernel kernel_;
  Batcher& batcher_;
  Size remembered_;
  PackedBeads beads_;
  std::vector<std::int32_t> order_;
  std::byte* memory_ = nullptr;  ///< of the device; null: the bed is not there
  BedParts parts_{};
  mutable std::vector<double> image_;  ///< copy of that memory, followed by the inputs
  std::vector<std::byte> states_;      ///< at the stops of the last launch
  DeviceBed here_{}, there_{};         ///< the bed in the image, and in memory of the device
  ContactMemories kept_;               ///< contact memory while the bed is not on the device
  std::int64_t builds_ = 0;            ///< before the last arrange()
  Counters counters_;
};

}  // namespace

std::unique_ptr<Solver> make_device_solver(const Plan& plan, const GuardLimits& limits, Batcher& batcher) {
  return std::make_unique<DeviceSolver>(plan, limits, batcher);
}

}  // namespace twincell::sim
