#include "sim/device/device_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
    if (s.beads.empty() || steps <= 0) {
      s.step += std::max<std::int64_t>(0, steps);
      return;
    }
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
    for (std::int64_t left = steps; left > 0; left -= kStepsPerLaunch) {
      const std::int64_t piece = std::min(left, kStepsPerLaunch), begin = s.step;
      launch(s, piece);
      s.step = begin + here_.report->steps;
      if (here_.report->failed >= 0 || here_.report->overfull >= 0) {
        beads_.store(s, order_);
        explain_overlap(s, limits_);
      }
    }
    counters_.steps += steps;
    beads_.store(s, order_);
    check_motion(s, limits_);
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
    const auto add = [&](std::int32_t i, std::int32_t j, const double* numbers) {
      if (std::any_of(numbers, numbers + remembered_, [](double v) { return v != 0; }))
        all[{i, j}].assign(numbers, numbers + remembered_);
    };
    const auto list = static_cast<Size>(here_.report->list);
    for (std::int32_t b = 0; b < here_.beads; ++b) {
      const std::int32_t begin = here_.first[b], end = begin + here_.neighbours[list][b];
      for (std::int32_t slot = begin; slot < end; ++slot)
        if (here_.partner[list][slot] > b)
          add(b, here_.partner[list][slot], here_.memory[list] + remembered_ * static_cast<Size>(slot));
      for (std::int32_t w = 0; w < here_.walls; ++w)
        add(b, -1 - w, here_.wall_memory + remembered_ * static_cast<Size>(b * here_.walls + w));
    }
    return all;
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
    std::vector<std::int32_t> first(n + 1, 0);
    double smallest = beads_.radius(0);
    for (Size b = 0; b < n; ++b) smallest = std::min(smallest, beads_.radius(b));
    for (Size b = 0; b < n; ++b)
      first[b + 1] = first[b] + static_cast<std::int32_t>(most_neighbours(
                                    beads_.radius(b), smallest, skin, limits_.overlap, plan_.dimension, n));
    BedSizes sizes{.dimension = plan_.dimension, .beads = n, .walls = s.walls.size(), .kinds = model.size()};
    sizes.slots = static_cast<Size>(first[n]);
    sizes.constants = pair_constants(model[0], model[0]).size();
    sizes.memory = remembered_;
    require_table(sizes);
    parts_ = place_bed(here_, sizes, nullptr);
    image_.assign(parts_.all / sizeof(double), 0.0);
    place_bed(here_, sizes, image());
    memory_ = batcher_.executor().allocate(parts_.all);
    place_bed(there_, sizes, memory_);
    there_.skin = skin;
    there_.fresh = true;

    std::copy(first.begin(), first.end(), here_.first);
    std::copy(kind.begin(), kind.end(), here_.kind);
    double* at = here_.pair_constants;
    for (const Size a : model)
      for (const Size b : model) at = append(at, pair_constants(a, b));
    at = here_.wall_constants;
    for (Size w = 0; w < s.walls.size(); ++w)
      for (const Size a : model) at = append(at, wall_constants(w, a));
    const IntegrateArgs of_beads = beads_.integrate_args(s);
    for (Size b = 0; b < n; ++b) {
      const Size k = of_beads.inertia_step == 0 ? 0 : b;
      std::copy_n(of_beads.inv_mass + 4 * k, 4, here_.inv_mass + 4 * b);
      here_.turn[b] = of_beads.turn[k];
    }
    transfer_beads(
        [](double* in_image, double* packed, Size count) { std::copy_n(packed, count, in_image); });
    here_.report->builds = builds_;
    list_kept(first);
    batcher_.executor().write(memory_, image(), parts_.constants);
  }
  static double* append(double* at, const std::vector<double>& values) {
    return std::copy(values.begin(), values.end(), at);
  }
  [[nodiscard]] std::vector<double> pair_constants(Size a, Size b) const {
    const double ra = beads_.radius(a), rb = beads_.radius(b);
    return contact_constants(plan_.bead, beads_.pair(a, b), ra + rb, 1 / ra, 1 / rb);
  }
  [[nodiscard]] std::vector<double> wall_constants(Size w, Size a) const {
    const double r = beads_.radius(a);
    return contact_constants(plan_.wall_laws[w], beads_.wall(a), r, 1 / r, 0);
  }
  /// Beads of many sizes take a table of the constants of each pair of sizes.
  static void require_table(const BedSizes& sizes) {
    constexpr double kMost = 256.0 * 1024 * 1024;
    const double bytes = static_cast<double>(sizes.kinds * sizes.kinds * sizes.constants * sizeof(double));
    if (bytes > kMost)
      throw ConfigError(
          {.file = {}, .key = "beads.spread"},
          fmt::format(
              "{} sizes of beads are too many for --device, the bound is {}; use fewer "
              "beads, or run without --device.",
              sizes.kinds,
              static_cast<int>(std::sqrt(kMost / static_cast<double>(sizes.constants * sizeof(double))))));
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
  void list_kept(const std::vector<std::int32_t>& first) {
    std::map<ContactMemories::key_type, const std::vector<double>*>
        of_beads;  // by bead and partner, so each pair twice
    for (const auto& [key, memory] : kept_) {
      const auto [i, j] = key;
      if (j < 0) {
        double* to = here_.wall_memory + remembered_ * static_cast<Size>(i * here_.walls + (-1 - j));
        std::copy_n(memory.begin(), std::min(memory.size(), remembered_), to);
      } else {
        of_beads[{i, j}] = of_beads[{j, i}] = &memory;
      }
    }
    for (const auto& [key, memory] : of_beads) {
      std::int32_t& used = here_.neighbours[0][key.first];
      const std::int32_t slot = first[static_cast<Size>(key.first)] + used;
      if (slot == first[static_cast<Size>(key.first) + 1])
        throw RunError(
            fmt::format("bead {} has more contacts with memory than beads that fit around it.", key.first));
      ++used;
      here_.partner[0][slot] = key.second;
      std::copy_n(memory->begin(), std::min(memory->size(), remembered_),
                  here_.memory[0] + remembered_ * static_cast<Size>(slot));
    }
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
    there_.quantum = grain_of_sums(plan_);
    there_.overlap_bound = limits_.overlap;
    there_.spin = plan_.rotation, there_.locate = plan_.locate;
    for (Size w = 0; w < s.walls.size(); ++w) {
      for (int c = 0; c < 3; ++c) here_.normals[3 * w + static_cast<Size>(c)] = component(s.walls[w].n, c);
      here_.moves[w] = s.walls[w].moves ? 1 : 0;
    }
    for (Size b = 0; b < beads_.size(); ++b) here_.drag[b] = s.plate_drag * beads_.mass(b);
    there_.has_drag = s.plate_drag > 0;
  }

  /// Does up to kStepsPerLaunch steps. Changes s.step.
  void launch(System& s, std::int64_t steps) {
    there_.step = s.step;
    there_.steps = steps;
    const Size bytes = set_plate_motion(s, steps);
    Executor& device = batcher_.executor();
    device.write(memory_ + parts_.constants, image() + parts_.constants, bytes);
    batcher_.advance(kernel_, there_);
    there_.fresh = false;
    there_.known = true;
    device.read(image(), memory_, parts_.state);
    transfer_beads(
        [](double* in_image, double* packed, Size count) { std::copy_n(in_image, count, packed); });
  }
  /// Tabulates the motion of the plate, from the present step on, with the functions and so the bits of the
  /// other solvers. \returns the bytes of the surroundings and the table
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
    return static_cast<Size>(reinterpret_cast<const std::byte*>(row) - (image() + parts_.constants));
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
  mutable std::vector<double> image_;  ///< copy of that memory
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
