#include "analysis/motion/convection_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/motion/rolls.hpp"
#include "core/constants.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {
    {"displacement_field"}, {"field_x"},           {"field_z"},
    {"circulation_left"},   {"circulation_right"}, {.name = "rolls", .main = true},
    {"convection_sense"}};

constexpr std::size_t kMaxRows = 4096;  // bounds the table: a bead that is thrown far up must not enlarge it
constexpr std::size_t kMaxBlocks = 20;
constexpr std::size_t kMinBlocks = 4;
/// Minimum transport of a roll over the whole run across the side of a cell, sigma. Weaker transport is the
/// creep of a bed that yields elastically.
constexpr double kMinCarried = kHalfPixelOfPaper1;
const char* const kSource = "Fortini & Huang 2015, sec. V";
const std::string kNoFourCells = "no four adjoining cells have enough displacements";
const std::string kTooFewBlocks = fmt::format("fewer than {} blocks of cycles", kMinBlocks);

/// Sums of displacements per cell.
struct FieldSums {
  std::vector<double> ux, uz;
  std::vector<std::size_t> n;
  std::size_t cycles = 0;

  void grow(std::size_t size) {
    if (n.size() >= size) return;
    ux.resize(size, 0);
    uz.resize(size, 0);
    n.resize(size, 0);
  }
  void add(const FieldSums& other, int sign = 1) {
    grow(other.n.size());
    for (std::size_t c = 0; c < other.n.size(); ++c) {
      ux[c] += sign * other.ux[c];
      uz[c] += sign * other.uz[c];
      n[c] = sign > 0 ? n[c] + other.n[c] : n[c] - other.n[c];
    }
    cycles = sign > 0 ? cycles + other.cycles : cycles - other.cycles;
  }
};

class Convection : public Observable {
 public:
  explicit Convection(const AnalysisContext& context)
      : box_(context.info.box), has_cycles_(context.info.columns.phase) {
    const double width = box_.size().x();
    columns_ = static_cast<std::size_t>(std::max(1.0, std::round(width / context.options.field_cell)));
    cell_ = width / static_cast<double>(columns_);
    // Close packing: 2/sqrt(3) discs per sigma^2, sqrt(2) spheres per sigma^3.
    full_ = cell_ * cell_ * (box_.dimension == 2 ? 2 / std::sqrt(3.0) : std::sqrt(2.0) * box_.size().y());
    blocks_.emplace_back();
  }

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (!has_cycles_ || frame.phase != 0) return;
    if (frame.cycle == last_cycle_ + 1 && !last_.empty()) add_cycle(frame);
    last_cycle_ = frame.cycle;
    last_.assign(frame.position.size(), Vec3::Constant(kNaN));
    for (std::size_t i = 0; i < frame.position.size(); ++i)
      if (frame.present(i)) last_[i] = frame.position[i];
  }

  [[nodiscard]] std::vector<Result> results() const override {
    FieldSums total;
    for (const FieldSums& block : blocks_) total.add(block);
    const DisplacementField field = mean_field(total, cells_of(total));
    ResultList list{.rule = rule(), .cycles = total.cycles};
    const std::string why = why_no_field(total, field);
    add_field(list, field, why);
    if (field.rows < 2 || field.columns < 2) {
      add_no_circulation(list, why.empty() ? "the field is less than two cells wide or high" : why);
      return list.results;
    }
    const Circulation circulation = circulation_of(field);
    if (why.empty() && !std::isfinite(circulation.left) && !std::isfinite(circulation.right)) {
      add_no_circulation(list, kNoFourCells);
      return list.results;
    }
    const auto left = interval(total, circulation.left, [](const Circulation& c) { return c.left; });
    const auto right = interval(total, circulation.right, [](const Circulation& c) { return c.right; });
    add_circulation(list, "circulation_left", circulation.left, left, why);
    add_circulation(list, "circulation_right", circulation.right, right, why);
    add_rolls(list, total, why);
    add_sense(list, circulation, left, right, why);
    return list.results;
  }

 private:
  /// The results so far. Each gets the rule, the source and, where it states none, the number of cycles.
  struct ResultList {
    std::string rule;
    std::size_t cycles;
    std::vector<Result> results = {};

    /// \param absent why the result is absent; empty: it is present
    void add(Result r, const std::string& absent) {
      r.convention = r.convention.empty() ? rule : r.convention + "; " + rule;
      r.source = kSource;
      if (r.n_of.empty()) r.n_of = "cycles";
      if (r.n == 0) r.n = cycles;
      results.push_back(absent.empty() ? r : absent_result(r.name, absent, r.source));
    }
  };

  [[nodiscard]] std::string rule() const {
    return fmt::format(
        "displacements between beginnings of consecutive cycles, averaged in cells of {:.4g} sigma that are "
        "at least {:.2g} full on average and contain at least {} displacements",
        cell_, kFieldFilling, kFieldSamples);
  }

  [[nodiscard]] std::string why_no_field(const FieldSums& total, const DisplacementField& field) const {
    return !has_cycles_        ? "the frames have no cycle number"
           : total.cycles == 0 ? "no two consecutive beginnings of cycles"
           : field.rows == 0   ? "no cell has enough displacements"
                               : "";
  }

  /// Adds the field and its axes.
  void add_field(ResultList& list, const DisplacementField& field, const std::string& why) const {
    Result u{.name = "displacement_field", .unit = "sigma per cycle"};
    Result x{.name = "field_x", .unit = "sigma", .convention = "centres of the cells"};
    Result z{.name = "field_z", .unit = "sigma", .convention = "centres of the cells"};
    for (std::size_t c = 0; c < field.ux.size(); ++c)
      u.values.insert(u.values.end(), {field.ux[c], field.uz[c]});
    u.shape = {field.rows, field.columns, 2};
    for (std::size_t c = 0; c < field.columns; ++c)
      x.values.push_back(box_.lower.x() + (static_cast<double>(c) + 0.5) * cell_);
    for (std::size_t r = 0; r < field.rows; ++r)
      z.values.push_back(box_.lower.z() + (static_cast<double>(r) + 0.5) * cell_);
    x.shape = {x.values.size()};
    z.shape = {z.values.size()};
    for (const Result& r : {u, x, z}) list.add(r, why);
  }

  /// Adds the results of the circulation as absent.
  static void add_no_circulation(ResultList& list, const std::string& why) {
    for (const char* name : {"circulation_left", "circulation_right", "rolls", "convection_sense"})
      list.add({.name = name}, why);
  }

  /// Adds the circulation of one half.
  static void add_circulation(ResultList& list, const char* name, double value,
                              const std::optional<Interval>& bounds, const std::string& why) {
    list.add({.name = name,
              .values = {value},
              .unit = "sigma^2 per cycle",
              .interval = bounds,
              .no_interval = bounds ? "" : kTooFewBlocks,
              .convention = "counter-clockwise (x right, z up) is positive"},
             why.empty() && !std::isfinite(value) ? kNoFourCells + " in this half" : why);
  }

  /// Adds the number of rolls, if there are enough blocks of cycles to distinguish them from chance.
  void add_rolls(ResultList& list, const FieldSums& total, const std::string& why) const {
    const bool enough = blocks_.size() >= kMinRollBlocks;
    const double least = kMinCarried * cell_ / static_cast<double>(total.cycles);
    list.add(
        {.name = "rolls",
         .values = {why.empty() && enough ? static_cast<double>(count_rolls(shares(total), least)) : kNaN},
         .unit = "1",
         .no_interval = "a count of significant regions",
         .convention =
             fmt::format("regions of one sense of the stream function psi of the circulation, psi = 0 at "
                         "walls, floor and surface; |t| of psi over {} blocks of cycles exceeds the value "
                         "that the largest |t| exceeds in {:g} % of 999 draws with random signs of the "
                         "blocks, the probability of any roll in a bed without steady flow; |psi| is at "
                         "least {:g} of the largest and {:.3g} sigma^2 in the whole run",
                         blocks_.size(), 100 * kRollFalseAlarm, kSmallestRoll, kMinCarried * cell_)},
        why.empty() && !enough
            ? fmt::format("fewer than {} blocks of cycles: rolls cannot be distinguished from chance",
                          kMinRollBlocks)
            : why);
  }

  /// Adds the sense of rotation, if the intervals of both halves are known.
  static void add_sense(ResultList& list, const Circulation& circulation, const std::optional<Interval>& left,
                        const std::optional<Interval>& right, const std::string& why) {
    const bool knows_both = std::isfinite(circulation.left) && std::isfinite(circulation.right);
    const std::string untold = !why.empty()  ? why
                               : !knows_both ? kNoFourCells + " in one half"
                               : !left ? kTooFewBlocks + ": the sense cannot be distinguished from chance"
                                       : "";
    Result sense{.name = "convection_sense"};
    if (untold.empty()) sense.text = words(*left, *right);
    sense.convention = "from the signs of both circulations where their intervals exclude 0";
    list.add(sense, untold);
  }

  /// Adds the displacements of one cycle to the last block. When all blocks are used, pairs of blocks are
  /// merged and the block length doubles.
  void add_cycle(const Frame& frame) {
    if (blocks_.back().cycles == block_length_) {
      if (blocks_.size() == kMaxBlocks) {
        for (std::size_t b = 0; b < kMaxBlocks / 2; ++b) {
          FieldSums two = std::move(blocks_[2 * b]);
          two.add(blocks_[2 * b + 1]);
          blocks_[b] = std::move(two);
        }
        blocks_.resize(kMaxBlocks / 2);
        block_length_ *= 2;
      }
      blocks_.emplace_back();
    }
    FieldSums& block = blocks_.back();
    ++block.cycles;
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      if (!frame.present(i) || !frame.position[i].allFinite() || !last_[i].allFinite()) continue;
      const Vec3 step = frame.position[i] - last_[i];
      const Vec3 middle = box_.wrap(last_[i] + 0.5 * step);
      const double column = std::floor((middle.x() - box_.lower.x()) / cell_);
      const double row = std::floor((middle.z() - box_.lower.z()) / cell_);
      // Beads touch walls with their surface, so that a centre outside the box is an error; it has no cell.
      if (column < 0 || column >= static_cast<double>(columns_) || row < 0 || row >= kMaxRows) continue;
      const std::size_t c = static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column);
      block.grow((static_cast<std::size_t>(row) + 1) * columns_);
      block.ux[c] += step.x();
      block.uz[c] += step.z();
      ++block.n[c];
    }
  }

  /// Cells with enough displacements over all cycles. Fields of fewer cycles use the same cells, because a
  /// cell that appears and disappears would count as a change of the flow.
  [[nodiscard]] std::vector<bool> cells_of(const FieldSums& total) const {
    const double least = std::max(static_cast<double>(kFieldSamples),
                                  kFieldFilling * full_ * static_cast<double>(total.cycles));
    std::vector<bool> enough;
    for (const std::size_t n : total.n) enough.push_back(static_cast<double>(n) >= least);
    while (!enough.empty() && !enough.back()) enough.pop_back();
    return enough;
  }

  [[nodiscard]] DisplacementField mean_field(const FieldSums& sums, const std::vector<bool>& cells) const {
    DisplacementField field{
        .columns = columns_, .dx = cell_, .dz = cell_, .periodic = box_.periodic(Axis::x)};
    field.rows = (cells.size() + columns_ - 1) / columns_;
    field.ux.assign(field.rows * columns_, kNaN);
    field.uz.assign(field.rows * columns_, kNaN);
    for (std::size_t c = 0; c < cells.size() && c < sums.n.size(); ++c) {
      if (!cells[c] || sums.n[c] == 0) continue;
      field.ux[c] = sums.ux[c] / static_cast<double>(sums.n[c]);
      field.uz[c] = sums.uz[c] / static_cast<double>(sums.n[c]);
    }
    return field;
  }

  /// Jackknife values: `statistic` with one full block of cycles left out at a time. Empty for fewer than
  /// kMinBlocks full blocks.
  template <class Statistic>
  [[nodiscard]] std::vector<double> left_out(const FieldSums& total, const Statistic& statistic) const {
    std::vector<double> values;
    for (const FieldSums& block : blocks_) {
      if (block.cycles < block_length_) continue;
      FieldSums rest = total;
      rest.add(block, -1);
      values.push_back(statistic(mean_field(rest, cells_of(total))));
    }
    if (values.size() < kMinBlocks) values.clear();
    return values;
  }

  /// Jackknife standard error.
  static double spread(const std::vector<double>& values) {
    double mean = 0, sum = 0;
    const double n = static_cast<double>(values.size());
    for (const double v : values) mean += v / n;
    for (const double v : values) sum += (v - mean) * (v - mean);
    return std::sqrt((n - 1) / n * sum);
  }

  template <class Part>
  [[nodiscard]] std::optional<Interval> interval(const FieldSums& total, double value,
                                                 const Part& part) const {
    const auto values = left_out(total, [&](const DisplacementField& f) { return part(circulation_of(f)); });
    if (values.empty() || !std::ranges::all_of(values, [](double v) { return std::isfinite(v); }))
      return std::nullopt;
    // The strength of a roll persists for longer than a block, so that the blocks are correlated. Leaving out
    // a block reverses the sign of its deviation, which does not change the correlation time.
    const double tau = correlation_time(values), count = static_cast<double>(values.size());
    const double half =
        student_t_95(std::max(1.0, count / (2 * tau) - 1)) * spread(values) * std::sqrt(2 * tau);
    return Interval{
        value - half, value + half, 0.95,
        fmt::format("jackknife over {} blocks of cycles, correlation time {:.3g} blocks", count, tau)};
  }

  /// Contributions of the blocks to the mean circulation. Each is normalised by the counts of the whole run,
  /// so that a block with few displacements in a cell contributes little there.
  [[nodiscard]] CirculationBlocks shares(const FieldSums& total) const {
    const std::vector<bool> cells = cells_of(total);
    CirculationBlocks shares;
    for (const FieldSums& block : blocks_) {
      FieldSums share = total;
      for (std::size_t c = 0; c < share.n.size(); ++c) {
        const auto count = static_cast<double>(blocks_.size());
        share.ux[c] = c < block.n.size() ? count * block.ux[c] : 0;
        share.uz[c] = c < block.n.size() ? count * block.uz[c] : 0;
      }
      const Circulation circulation = circulation_of(mean_field(share, cells));
      shares.columns = circulation.columns;
      shares.blocks.push_back(circulation.plaquettes);
    }
    shares.periodic = box_.periodic(Axis::x);
    return shares;
  }

  /// The sense of rotation in words, from the intervals of both circulations.
  static std::string words(const Interval& left, const Interval& right) {
    const auto sign = [](const Interval& i) { return i.low > 0 ? 1 : i.high < 0 ? -1 : 0; };
    const int l = sign(left), r = sign(right);
    if (l > 0 && r < 0) return "down at the walls, up in the middle";
    if (l < 0 && r > 0) return "up at the walls, down in the middle";
    if (l > 0 && r > 0) return "one sense, counter-clockwise";
    if (l < 0 && r < 0) return "one sense, clockwise";
    if (l != 0)
      return l > 0 ? "left half counter-clockwise, right half none" : "left half clockwise, right half none";
    if (r != 0)
      return r > 0 ? "right half counter-clockwise, left half none" : "right half clockwise, left half none";
    return "none";
  }

  const Box& box_;
  bool has_cycles_;
  std::size_t columns_ = 1;
  double cell_ = 1, full_ = 1;
  std::vector<Vec3> last_;
  std::int64_t last_cycle_ = -2;
  std::vector<FieldSums> blocks_;
  std::size_t block_length_ =
      2;  // a bed may repeat after two cycles, of which a block of one cycle would contain half
};

}  // namespace

Circulation circulation_of(const DisplacementField& field) {
  Circulation c;
  if (field.rows < 2 || field.columns < 2) return c;
  c.columns = field.periodic ? field.columns : field.columns - 1;
  const std::size_t rows = field.rows - 1;
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t k = 0; k < c.columns; ++k) {
      const std::size_t a = r * field.columns + k, b = r * field.columns + (k + 1) % field.columns;
      const std::size_t a2 = a + field.columns, b2 = b + field.columns;
      const double loop = 0.5 * (field.dx * (field.ux[a] + field.ux[b] - field.ux[a2] - field.ux[b2]) +
                                 field.dz * (field.uz[b] + field.uz[b2] - field.uz[a] - field.uz[a2]));
      c.plaquettes.push_back(loop);
      if (!std::isfinite(loop)) continue;
      // Plaquette k is centred on the border between columns k and k + 1.
      const std::size_t twice = 2 * (k + 1);
      const double to_left = twice < field.columns ? 1 : twice == field.columns ? 0.5 : 0;
      if (to_left > 0) c.left = (std::isfinite(c.left) ? c.left : 0) + to_left * loop;
      if (to_left < 1) c.right = (std::isfinite(c.right) ? c.right : 0) + (1 - to_left) * loop;
    }
  return c;
}

constinit const ObservableEntry convection_observable = {
    kResults, &make_observable<Convection>, {"field_cell"}};

}  // namespace twincell::analysis
